r"""The damper: its length, its motion ratio to the wheel, and a spring between its two ends.

With the damper's length l, the travel z of the wheel centre, r = -dl/dz, damper per wheel travel, the
spring's rate k and its free length l_0,

    F = k (l_0 - l),      F_wheel = F r,      k_wheel = k r^2.

The wheel rate is the part for a constant motion ratio; a changing ratio adds F dr/dz.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, S, dot, ratio, root
from pointcoord.effects.corner import Corner, above_rounding, rising


def damper_length(corner: Corner[S]) -> S:
    """The distance between the damper's two ends."""
    line = corner.seen.role("damper")
    return root(dot(line, line))


def damper_per_wheel(corner: Corner[Dual[Any]]) -> Any:
    """Shortening of the damper per travel of the wheel centre (Simscape)."""
    return -ratio(damper_length(corner).slope, rising(corner))


def wheel_per_damper(corner: Corner[Dual[Any]]) -> Any:
    """Travel of the wheel centre per shortening of the damper (Lotus, OptimumK)."""
    slope = damper_length(corner).slope
    return -ratio(corner.risen().slope, above_rounding(slope, corner.seen.role("damper").slope))


def spring_force(corner: Corner[Dual[Any]]) -> Any:
    """The spring's force, k (l_0 - l)."""
    free, rate = (corner.car[name].value for name in ("spring_free_length", "spring_rate"))
    return rate * (free - damper_length(corner).value)


def wheel_force(corner: Corner[Dual[Any]]) -> Any:
    """The spring's force at the wheel centre, by virtual work, F r."""
    return spring_force(corner) * damper_per_wheel(corner)


def wheel_rate(corner: Corner[Dual[Any]]) -> Any:
    """The wheel rate for a constant motion ratio, k r^2."""
    per_wheel = damper_per_wheel(corner)
    return corner.car["spring_rate"].value * per_wheel * per_wheel
