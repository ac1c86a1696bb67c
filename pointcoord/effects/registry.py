"""The effects that there are: a line for each."""

from __future__ import annotations

from collections.abc import Mapping

from pointcoord.effects.ackermann import ACKERMANN
from pointcoord.effects.angle import Angle
from pointcoord.effects.anti_features import ANTI_FEATURES
from pointcoord.effects.car_number import CarNumber, CarNumbers
from pointcoord.effects.centres import ARM_ROLL_CENTRE, AXLE, INSTANT_CENTRES, ROLL_CENTRE
from pointcoord.effects.damper import DAMPER, MOTION_RATIO, SPRING
from pointcoord.effects.effect import Effect, Quantity
from pointcoord.effects.gradients import WAYS, gradients
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES
from pointcoord.effects.loads import LOADS
from pointcoord.effects.point_states import POSITION, RATES
from pointcoord.effects.steering_axis import SCREW_AXIS, STEERING_AXIS
from pointcoord.effects.wheel_angles import (
    ANGLES_BY_ARCSINE,
    CAMBER,
    CASTER,
    STEER_ANGLE,
    TOE,
    TOE_CHANGE_BY_ARCSINE,
    WHEEL_ANGLES,
)
from pointcoord.effects.wheel_travel import WHEEL_TRAVEL

ALWAYS: tuple[Effect, ...] = (POSITION,)
"""What every motion reports."""

_ANGLES_AND_DIMENSIONS = (
    CAMBER,
    WHEEL_ANGLES,
    TOE,
    ANGLES_BY_ARCSINE,
    TOE_CHANGE_BY_ARCSINE,
    STEER_ANGLE,
    CASTER,
    WHEEL_TRAVEL,
    STEERING_AXIS,
    DAMPER,
)

EFFECTS: Mapping[str, Effect] = {
    effect.name: effect
    for effect in (
        *RATES,
        KNUCKLE_RATES,
        *_ANGLES_AND_DIMENSIONS,
        *(gradients(effect, way) for way in WAYS for effect in _ANGLES_AND_DIMENSIONS),
        SCREW_AXIS,
        MOTION_RATIO,
        SPRING,
        ROLL_CENTRE,
        ARM_ROLL_CENTRE,
        INSTANT_CENTRES,
        ANTI_FEATURES,
        AXLE,
        ACKERMANN,
        LOADS,
    )
}
"""What a scene may list, by name."""

NUMBERS_OF_THE_CAR: Mapping[str, CarNumber] = {
    number.name: number
    for effect in EFFECTS.values()
    if isinstance(effect, CarNumbers)
    for number in effect.numbers
}
"""Numbers of a car, by their names; of a part's wheel these have its name and a dot before them."""


def number_called(name: str) -> CarNumber | None:
    """The number of the car that has a name, which may be a part's; None if there is none."""
    return NUMBERS_OF_THE_CAR.get(name.rpartition(".")[2])


def words_of(name: str) -> str:
    """A number of the car for people, with the part that it is of; its name if there is none."""
    number, part = number_called(name), name.rpartition(".")[0]
    return f"{part} {number.words}".strip() if number else name


READ_FIRST = (
    "travel",
    "camber",
    "camber_by_travel",
    "toe",
    "toe_by_travel",
    "toe_by_rack",
    "steer_angle",
    "ackermann",
    "ackermann_error",
    "turning_radius",
    "caster",
    "kingpin",
    "half_track_change",
    "recession",
    "roll_centre_height",
    "arm_roll_centre_height",
    "track",
    "axle_roll_centre_height",
    "axle_roll_centre_offset",
    "front_view_swing_arm",
    "side_view_swing_arm",
    "anti_brake",
    "anti_drive",
    "scrub_radius",
    "kingpin_offset",
    "mechanical_trail",
    "damper_length",
    "damper_per_wheel",
    "spring_force",
    "wheel_rate",
)
"""The numbers that a table shows unless others are asked for, as far as a car has them."""

RANKED_FIRST = ("camber", "toe", "toe_by_travel", "caster", "half_track_change", "kingpin_offset")
"""The numbers whose hardpoints are ranked unless others are asked for, as far as a car has them."""

ANGLES: Mapping[str, Angle] = {
    name: number for name, number in NUMBERS_OF_THE_CAR.items() if isinstance(number, Angle)
}
"""Those that are angles of a line."""


def angle_called(name: str) -> Angle | None:
    """The angle of a line by its name, which may have that of a part before it; None if there is none."""
    return ANGLES.get(name.rpartition(".")[2])


QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity for effect in (*ALWAYS, *EFFECTS.values()) for quantity in effect.quantities
}
"""The kinds of numbers that a motion can report, in their order."""
