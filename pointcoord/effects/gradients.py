r"""What every number of the car changes by as wheel or rack travels, the chassis rolls, or in time: exact.

With points P, their derivatives P_q by one input q or by time, and a number N(P),

    by_rack:    N_P P_s                               s the input that steers, mm
    by_travel:  (N_P P_b) / (T_P P_b)                 b the other one, T the travel of the wheel centre, mm
    by_roll:    N_P P_r                               r the input that turns the chassis lengthwise, rad
    by_time:    N_P P'                                as all inputs and the chassis move

The formula of N gives its derivative with it where points are duals (see `arithmetic`).
"""

from __future__ import annotations

from functools import partial
from typing import Any

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_RACK, BY_ROLL, BY_TRAVEL, CarNumber, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Quantity
from pointcoord.effects.knuckle import rising
from pointcoord.effects.wheel_travel import TRAVEL

BY_TIME = "by_time"
WAYS = {
    BY_TRAVEL: "as the wheel centre goes up",
    BY_RACK: "as the rack travels",
    BY_ROLL: "as the chassis rolls",
    BY_TIME: "with time",
}
PER = {BY_TRAVEL: "mm", BY_RACK: "mm", BY_ROLL: "rad", BY_TIME: "second"}
QUANTITIES = {
    "rad": Quantity("angle_gradient", "wheel angle per mm", "rad/mm", "car"),
    "mm": Quantity("dimension_gradient", "dimension per mm", "mm/mm", "car"),
}
PER_ROLL = {
    "rad": Quantity("angle_by_roll", "wheel angle per rad of roll", "rad/rad", "car"),
    "mm": Quantity("dimension_by_roll", "dimension per rad of roll", "mm/rad", "car"),
}
RATES = {
    "rad": Quantity("angle_rate", "rate of a wheel angle", "rad/s", "car"),
    "mm": Quantity("dimension_rate", "rate of a dimension", "mm/s", "car"),
}
_GIVES = {BY_TRAVEL: QUANTITIES, BY_RACK: QUANTITIES, BY_ROLL: PER_ROLL, BY_TIME: RATES}


def gradients(base: CarNumbers, way: str) -> CarNumbers:
    """What the numbers of an effect change by along a way."""
    timed = way == BY_TIME
    gives = f"what these change by per {PER[way]}{'' if timed else f' {WAYS[way]}'}: {base.gives}"
    numbers = [_gradient(number, way) for number in base.numbers]
    return CarNumbers.of(f"{base.name}_{way}", gives, *numbers, base=base.name, derivative=int(timed))


def _gradient(number: CarNumber, way: str) -> Number:
    length, timed, travels = number.quantity.unit == "mm", way == BY_TIME, way == BY_TRAVEL
    per = f"{PER[way]}{'' if timed else f' {way}'.replace('_', ' ')}"
    return Number(
        name=f"{number.name}_{way}",
        words=f"{number.words} per {per}",
        sign=f"where it grows {WAYS[way]}",
        definition=f"the derivative of `{number.name}` {WAYS[way]}",
        formula=partial(_by_travel if travels else _slope, number),
        roles=tuple(dict.fromkeys((*number.roles, *(TRAVEL.roles if travels else ())))),
        needs_radius=number.needs_radius,
        quantity=_GIVES[way][number.quantity.unit],
        way="" if timed else way,
        power=length - travels,
    )


def _slope(number: CarNumber, corner: Corner[Dual[Any]]) -> Any:
    return number.formula(corner).slope


def _by_travel(number: CarNumber, corner: Corner[Dual[Any]]) -> Any:
    return ratio(number.formula(corner).slope, rising(corner))
