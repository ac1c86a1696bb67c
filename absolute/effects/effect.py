"""What an effect is: a number that a solved motion has at each instant."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from absolute.description import Corner
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
        derivative: the derivative over time of the poses that it needs; 0 where poses are enough.
        value: (N,) at the instants of a solved motion.
    """

    name: str
    unit: str
    gives: str
    sign: str
    role: str
    derivative: int
    value: Callable[[Lines], Array]
