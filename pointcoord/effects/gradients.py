r"""Gradients: exact derivatives of every number of the car by wheel travel, rack travel, roll or time.

With points P, their derivatives P_q by one input q or by time, and a number N(P),

    by_rack:    N_P P_s                               s the input that steers, mm
    by_travel:  (N_P P_b) / (T_P P_b)                 b the other input, T the wheel centre's travel, mm
    by_roll:    N_P P_r                               r the input that turns the chassis lengthwise, rad
    by_time:    N_P P'                                with all inputs and the chassis moving

The formula of N gives N's derivative too, if its points are duals (see `arithmetic`).
"""

from __future__ import annotations

from functools import partial
from typing import Any

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner, rising
from pointcoord.effects.numbers import QUANTITIES, WAYS

BY_TIME = "by_time"


def gradients(base: CarNumbers, way: str) -> CarNumbers:
    """The effect that gives the derivatives of an effect's numbers along a way."""
    timed, entry = way == BY_TIME, WAYS[way]
    as_it_goes = "" if timed else f" {entry['words']}"
    gives = f"change per {entry['per']}{as_it_goes} of: {base.gives}"
    numbers = [_gradient(number, way) for number in base.numbers]
    return CarNumbers.of(f"{base.name}_{way}", gives, *numbers, base=base.name, derivative=int(timed))


def _gradient(number: Number, way: str) -> Number:
    timed, travels, entry = way == BY_TIME, way == BY_TRAVEL, WAYS[way]
    per = f"{entry['per']}{'' if timed else f' {way}'.replace('_', ' ')}"
    return Number(
        name=f"{number.name}_{way}",
        words=f"{number.words} per {per}",
        sign=f"where it grows {entry['words']}",
        definition=f"the derivative of `{number.name}` {entry['words']}",
        formula=partial(_by_travel if travels else _slope, number),
        roles=tuple(dict.fromkeys((*number.roles, *(("wheel_axis",) if travels else ())))),
        needs_radius=number.needs_radius,
        quantity=QUANTITIES[entry[number.quantity.unit]],
        way="" if timed else way,
        power=(number.quantity.unit == "mm") - travels,
    )


def _slope(number: Number, corner: Corner[Dual[Any]]) -> Any:
    return number.formula(corner).slope


def _by_travel(number: Number, corner: Corner[Dual[Any]]) -> Any:
    return ratio(number.formula(corner).slope, rising(corner))
