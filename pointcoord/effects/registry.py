"""The registry of all effects, one line for each group."""

from __future__ import annotations

from collections.abc import Mapping

from pointcoord.effects.angle import Angle
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.effect import Effect, Quantity
from pointcoord.effects.gradients import gradients
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES
from pointcoord.effects.loads import LOADS
from pointcoord.effects.numbers import CAR_NUMBERS, WAYS, WITH_GRADIENTS
from pointcoord.effects.point_states import POSITION, RATES

ALWAYS: tuple[Effect, ...] = (POSITION,)
"""The effects that every motion reports."""

EFFECTS: Mapping[str, Effect] = {
    effect.name: effect
    for effect in (
        *RATES,
        KNUCKLE_RATES,
        *WITH_GRADIENTS,
        *(gradients(effect, way) for way in WAYS for effect in WITH_GRADIENTS),
        *(effect for effect in CAR_NUMBERS.values() if effect not in WITH_GRADIENTS),
        LOADS,
    )
}
"""The effects that a scene may list, by name."""

NUMBERS_OF_THE_CAR: Mapping[str, Number] = {
    number.name: number
    for effect in EFFECTS.values()
    if isinstance(effect, CarNumbers)
    for number in effect.numbers
}
"""Numbers of the car by name; for a part's wheel, the part and a dot come before these names."""


def number_called(name: str) -> Number | None:
    """The number of the car with a name, which may be a part's; None if there is no such number."""
    return NUMBERS_OF_THE_CAR.get(name.rpartition(".")[2])


def words_of(name: str) -> str:
    """A number of the car in words, with its part; the name itself if there is no such number."""
    number, part = number_called(name), name.rpartition(".")[0]
    return f"{part} {number.words}".strip() if number else name


ANGLES: Mapping[str, Angle] = {
    name: number for name, number in NUMBERS_OF_THE_CAR.items() if isinstance(number, Angle)
}
"""The numbers that are angles of a line."""


def angle_called(name: str) -> Angle | None:
    """The angle of a line by name, which may be a part's; None if there is no such angle."""
    return ANGLES.get(name.rpartition(".")[2])


QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity for effect in (*ALWAYS, *EFFECTS.values()) for quantity in effect.quantities
}
"""The quantities that a motion can report, in order."""
