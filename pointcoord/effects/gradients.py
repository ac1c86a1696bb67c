r"""What every number of the car changes by as the wheel travels, or as the rack does: exact, at each pose.

With points P, their derivatives P_q by one input q, and a number N(P),

    by_rack:    N_P P_s                               s the input that steers, mm
    by_travel:  (N_P P_b) / (T_P P_b)                 b the other one, T the travel of the wheel centre, mm

The formula of N gives its derivative with it where points are duals (see `arithmetic`).
"""

from __future__ import annotations

from functools import partial
from typing import Any

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_RACK, BY_TRAVEL, CarNumber, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Quantity
from pointcoord.effects.wheel_travel import TRAVEL

WAYS = {BY_TRAVEL: "as the wheel centre goes up", BY_RACK: "as the rack travels"}
QUANTITIES = {
    "rad": Quantity("angle_gradient", "wheel angle per mm", "rad/mm", "car"),
    "mm": Quantity("dimension_gradient", "dimension per mm", "mm/mm", "car"),
}


def gradients(base: CarNumbers, way: str) -> CarNumbers:
    """What the numbers of an effect change by along a way."""
    gives = f"what these change by per mm {WAYS[way]}: {base.gives}"
    numbers = [_gradient(number, way) for number in base.numbers]
    return CarNumbers.of(f"{base.name}_{way}", gives, *numbers, base=base.name)


def _gradient(number: CarNumber, way: str) -> Number:
    length, travels = number.quantity.unit == "mm", way == BY_TRAVEL
    return Number(
        name=f"{number.name}_{way}",
        words=f"{number.words} per mm {way.replace('_', ' ')}",
        sign=f"where it grows {WAYS[way]}",
        formula=partial(_by_travel if travels else _by_rack, number),
        roles=tuple(dict.fromkeys((*number.roles, *(TRAVEL.roles if travels else ())))),
        needs_radius=number.needs_radius,
        quantity=QUANTITIES[number.quantity.unit],
        way=way,
        power=length - travels,
    )


def _by_rack(number: CarNumber, corner: Corner[Dual[Any]]) -> Any:
    return number.formula(corner).slope


def _by_travel(number: CarNumber, corner: Corner[Dual[Any]]) -> Any:
    return ratio(number.formula(corner).slope, TRAVEL.formula(corner).slope)
