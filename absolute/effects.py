"""Effects: numbers that a solved motion has at each instant, by name.

Each is the angle of a line of the corner as seen along a direction of the car, from its projection on two
others:  angle = atan2(a . rise, a . run).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from absolute.description import Corner
from absolute.errors import InputError
from absolute.mapping import ReadOnly
from absolute.solution import Array


class Lines(Protocol):
    """A solved motion, as effects see it: lines between points, in the axes of the frame of the points.

    Attributes:
        corner: what of the linkage is the wheel, and which way the car points.
    """

    @property
    def corner(self) -> Corner: ...

    def line(self, ends: tuple[str, str]) -> Array:
        """(N, 3) from one point to another, mm."""
        ...


@dataclass(frozen=True)
class Effect:
    """A number at each instant.

    Attributes:
        name: what a caller asks for.
        unit: of the value.
        gives: what it is, in words.
        sign: what a positive value means, in words.
        role: what the corner must have for it.
        value: (N,) at the instants of a solved motion.
    """

    name: str
    unit: str
    gives: str
    sign: str
    role: str
    value: Callable[[Lines], Array]


def projected_angle(name: str, gives: str, sign: str, role: str, rise: str, run: str) -> Effect:
    """The effect that is the angle of a line of the corner, rad, between -pi and pi.

    Args:
        role: the two points of the line, see `Corner`.
        rise, run: directions of `Corner`; the angle is 0 along run, and grows toward rise.
    """

    def value(lines: Lines) -> Array:
        along = lines.line(lines.corner.ends(role))
        # A product of zeros may be -0, which would turn pi into -pi.
        return np.asarray(
            np.arctan2(along @ getattr(lines.corner, rise) + 0.0, along @ getattr(lines.corner, run))
        )

    return Effect(name, "rad", gives, sign, role, value)


# Camber and kingpin inclination are eqs. 17 and 16 of the paper.
EFFECTS: Mapping[str, Effect] = ReadOnly(
    {
        name: projected_angle(name, f"angle of the {gives}", f"+ where the {sign}", role, rise, run)
        for name, gives, sign, role, rise, run in (
            (
                "camber",
                "wheel's spin axis against the car's right, seen from the front",
                "wheel leans out at its top",
                "wheel_axis",
                "down",
                "outboard",
            ),
            (
                "kingpin",
                "steering axis against the car's up, seen from the front",
                "axis leans in at its top",
                "steering_axis",
                "inboard",
                "up",
            ),
            (
                "toe",
                "wheel's spin axis against the car's right, seen from above",
                "wheel's front edge is nearer the car's middle: toe in",
                "wheel_axis",
                "forward",
                "outboard",
            ),
            (
                "caster",
                "steering axis against the car's up, seen from the side",
                "axis leans rearward at its top",
                "steering_axis",
                "rearward",
                "up",
            ),
        )
    }
)


def effects_of(names: Sequence[str]) -> tuple[Effect, ...]:
    """The effects of some names.

    Raises:
        InputError: there is no such effect; it names those there are.
    """
    for name in names:
        if name not in EFFECTS:
            raise InputError(
                f"there is no effect {name!r}; it must be one of {list(EFFECTS)}", name, None, name
            )
    return tuple(EFFECTS[name] for name in names)
