"""How far the damper goes as the wheel does, and the other way round."""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.damper import damper_length
from pointcoord.effects.gradients import QUANTITIES
from pointcoord.effects.knuckle import rising, told_from_none


def damper_per_wheel(corner: Corner[Dual[Any]]) -> Any:
    """By how much the damper is shortened per travel of the wheel centre (Simscape)."""
    return -ratio(damper_length(corner).slope, rising(corner))


def wheel_per_damper(corner: Corner[Dual[Any]]) -> Any:
    """Its inverse (Lotus, OptimumK)."""
    slope = damper_length(corner).slope
    return -ratio(corner.risen().slope, told_from_none(slope, corner.seen.role("damper").slope))


def _number(name: str, words: str, formula: Any) -> Number:
    sign = "where the damper is shortened as the wheel centre goes up"
    roles, quantity = ("damper", "wheel_axis"), QUANTITIES["mm"]
    return Number(name, words, sign, formula, roles, False, quantity, way=BY_TRAVEL, power=0)


MOTION_RATIO = CarNumbers.of(
    "motion_ratio",
    "motion ratio, damper per wheel and wheel per damper, mm/mm",
    _number("damper_per_wheel", "damper per wheel travel", damper_per_wheel),
    _number("wheel_per_damper", "wheel per damper travel", wheel_per_damper),
    nowhere="the damper's length does not change",
)
