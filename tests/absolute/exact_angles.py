"""Angles of the wheel to 50 digits, from exact points; axes x rearward, y right, z up."""

from collections.abc import Callable
from typing import Any

from jets import DIGITS, Moving
from kinds import Car, Kind
from mpmath import atan2, mp, mpf

Coordinates = list[Any]

# From the spin axis, the steering axis, and y outboard: 1 or -1.
ANGLES: dict[str, Callable[[Coordinates, Coordinates, int], Any]] = {
    "camber": lambda spin, steer, out: atan2(-spin[2], out * spin[1]),
    "kingpin": lambda spin, steer, out: atan2(-out * steer[1], steer[2]),
    "toe": lambda spin, steer, out: atan2(-spin[0], out * spin[1]),
    "caster": lambda spin, steer, out: atan2(steer[0], steer[2]),
}


def exact_angles(kind: Kind, car: Car, exact: Moving, out: int) -> dict[str, Any]:
    """All angles at one instant."""
    with mp.workdps(DIGITS):

        def place(name: str) -> Coordinates:
            if name in exact.points:
                return [jet.x for jet in exact.points[name]]
            return [mpf(float(x)) for x in car[name]]

        def line(start: str, end: str) -> Coordinates:
            return [b - a for a, b in zip(place(start), place(end), strict=True)]

        spin = line(next(name for name in kind.inner if name in car), "wheel_centre")
        steer = line(*kind.kingpin)
        return {name: angle(spin, steer, out) for name, angle in ANGLES.items()}
