r"""The damper: how long it is, how far it goes as the wheel does, and a spring between its two ends.

With the damper's length l, the travel z of the wheel centre, r = -dl/dz, damper per wheel travel, the
spring's rate k and its free length l_0,

    F = k (l_0 - l),      F_wheel = F r,      k_wheel = k r^2.

The last is the part that a constant motion ratio has; F dr/dz comes to it where the ratio changes.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from pointcoord.effects.arithmetic import Dual, S, dot, ratio, root
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Quantity
from pointcoord.effects.gradients import QUANTITIES
from pointcoord.effects.knuckle import rising, told_from_none

FORCE = Quantity("spring_force", "force of the spring", "N", "car")
RATE = Quantity("wheel_rate", "wheel rate", "N/mm", "car")


def damper_length(corner: Corner[S]) -> S:
    """The distance of the damper's two ends."""
    line = corner.seen.role("damper")
    return root(dot(line, line))


def damper_per_wheel(corner: Corner[Dual[Any]]) -> Any:
    """By how much the damper is shortened per travel of the wheel centre (Simscape)."""
    return -ratio(damper_length(corner).slope, rising(corner))


def wheel_per_damper(corner: Corner[Dual[Any]]) -> Any:
    """Its inverse (Lotus, OptimumK)."""
    slope = damper_length(corner).slope
    return -ratio(corner.risen().slope, told_from_none(slope, corner.seen.role("damper").slope))


def spring_force(corner: Corner[Dual[Any]]) -> Any:
    """k (l_0 - l)."""
    free, rate = (corner.car[name].value for name in ("spring_free_length", "spring_rate"))
    return rate * (free - damper_length(corner).value)


def wheel_force(corner: Corner[Dual[Any]]) -> Any:
    """By virtual work, at the wheel centre."""
    return spring_force(corner) * damper_per_wheel(corner)


def wheel_rate(corner: Corner[Dual[Any]]) -> Any:
    """K r^2."""
    per_wheel = damper_per_wheel(corner)
    return corner.car["spring_rate"].value * per_wheel * per_wheel


_number = partial(Number, roles=("damper", "wheel_axis"), needs_radius=False, way=BY_TRAVEL)


DAMPER = CarNumbers.of(
    "damper",
    "length of the damper, mm",
    Number(
        "damper_length",
        "length of the damper",
        "",
        "the distance of the two points of the role `damper`",
        damper_length,
        ("damper",),
        needs_radius=False,
    ),
)
_SHORTENED = "where the damper is shortened as the wheel centre goes up"
MOTION_RATIO = CarNumbers.of(
    "motion_ratio",
    "motion ratio, damper per wheel and wheel per damper, mm/mm",
    _number(
        "damper_per_wheel",
        "damper per wheel travel",
        _SHORTENED,
        "what the damper is shortened by per mm of `travel`",
        damper_per_wheel,
        quantity=QUANTITIES["mm"],
        power=0,
        source="Simscape",
    ),
    _number(
        "wheel_per_damper",
        "wheel per damper travel",
        _SHORTENED,
        "1 / `damper_per_wheel`",
        wheel_per_damper,
        quantity=QUANTITIES["mm"],
        power=0,
        source="Lotus, OptimumK",
    ),
    nowhere="the damper's length does not change",
)
_DATA = ("spring_rate", "spring_free_length")
SPRING = CarNumbers.of(
    "spring",
    "force of the spring, and force and rate at the wheel, N and N/mm",
    _number(
        "spring_force",
        "force of the spring",
        "where it pushes",
        "`spring_rate` (`spring_free_length` - `damper_length`)",
        spring_force,
        quantity=FORCE,
        data=_DATA,
    ),
    _number(
        "wheel_force",
        "the spring's force at the wheel",
        "downward",
        "`spring_force` `damper_per_wheel`",
        wheel_force,
        quantity=FORCE,
        data=_DATA,
        source="virtual work",
    ),
    _number(
        "wheel_rate",
        "wheel rate",
        "",
        "`spring_rate` `damper_per_wheel`^2: the part of a constant ratio",
        wheel_rate,
        quantity=RATE,
        power=0,
        data=_DATA,
    ),
)
