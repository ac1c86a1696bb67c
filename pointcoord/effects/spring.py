r"""A spring between the damper's two ends: its force, and what the wheel feels of it.

With the rate k, the free length l_0, the damper's length l and r = -dl/dz, damper per wheel travel,

    F = k (l_0 - l),      F_wheel = F r,      k_wheel = k r^2.

The last is the part that a constant motion ratio has; F dr/dz comes to it where the ratio changes.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.damper import damper_length
from pointcoord.effects.effect import Quantity
from pointcoord.effects.motion_ratio import damper_per_wheel

FORCE = Quantity("spring_force", "force of the spring", "N", "car")
RATE = Quantity("wheel_rate", "wheel rate", "N/mm", "car")


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


def _number(name: str, words: str, sign: str, formula: Any, quantity: Quantity, power: int) -> Number:
    roles, data = ("damper", "wheel_axis"), ("spring_rate", "spring_free_length")
    return Number(name, words, sign, formula, roles, False, quantity, data, BY_TRAVEL, power)


SPRING = CarNumbers.of(
    "spring",
    "force of the spring, and force and rate at the wheel, N and N/mm",
    _number("spring_force", "force of the spring", "where it pushes", spring_force, FORCE, 1),
    _number("wheel_force", "the spring's force at the wheel", "downward", wheel_force, FORCE, 1),
    _number("wheel_rate", "wheel rate", "", wheel_rate, RATE, 0),
)
