"""Numbers to 50 digits with two derivatives over time, and vectors of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import cos, mp, mpf, sign, sin, sqrt
from numpy.typing import NDArray

DIGITS = 50
Drawing = Mapping[str, Any]


@dataclass(frozen=True)
class Jet:
    """A number and its first and second derivative over time."""

    x: Any
    v: Any
    a: Any

    def __add__(self, other: "Jet") -> "Jet":
        return Jet(self.x + other.x, self.v + other.v, self.a + other.a)

    def __sub__(self, other: "Jet") -> "Jet":
        return Jet(self.x - other.x, self.v - other.v, self.a - other.a)

    def __mul__(self, o: "Jet") -> "Jet":
        return Jet(self.x * o.x, self.v * o.x + self.x * o.v, self.a * o.x + 2 * self.v * o.v + self.x * o.a)

    def root(self) -> "Jet":
        r = sqrt(self.x)
        r1 = self.v / (2 * r)
        return Jet(r, r1, (self.a / 2 - r1 * r1) / r)

    def inverse(self) -> "Jet":
        i = 1 / self.x
        return Jet(i, -self.v * i * i, (2 * self.v * self.v * i - self.a) * i * i)

    def cosine(self) -> "Jet":
        c, s = cos(self.x), sin(self.x)
        return Jet(c, -s * self.v, -c * self.v**2 - s * self.a)


Vector = tuple[Jet, Jet, Jet]


@dataclass(frozen=True)
class Moving:
    """Exact motion at one instant.

    Attributes:
        points: the moving points. spins: (w, w') by body, each three numbers.
        margins: how far from its dead point each link is, 0 to 1.
    """

    points: dict[str, Vector]
    spins: dict[str, tuple[list[Any], list[Any]]]
    margins: tuple[Any, ...]


def errors_of(exact: Sequence[Any], found: Sequence[float]) -> NDArray[np.float64]:
    """|exact - found| for each of three numbers."""
    with mp.workdps(DIGITS):
        return np.array([float(abs(a - mpf(float(b)))) for a, b in zip(exact, found, strict=True)])


def number(value: Any) -> Jet:
    return Jet(mpf(value), mpf(0), mpf(0))


def side(value: Jet) -> Jet:
    return number(sign(value.x))


def fixed(values: Sequence[float]) -> Vector:
    x, y, z = (number(float(value)) for value in values)
    return x, y, z


NOTHING = fixed((0, 0, 0))


def less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def plus(start: Vector, *parts: tuple[Jet, Vector]) -> Vector:
    x, y, z = start
    for share, (u, v, w) in parts:
        x, y, z = x + share * u, y + share * v, z + share * w
    return x, y, z


def dot(a: Vector, b: Vector) -> Jet:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def length(a: Vector) -> Jet:
    return dot(a, a).root()


def unit(a: Vector) -> Vector:
    shrink = length(a).inverse()
    return a[0] * shrink, a[1] * shrink, a[2] * shrink


def axes(line: Vector, other: Vector) -> tuple[Vector, Vector, Vector]:
    x = unit(plus(other, (number(-1) * dot(other, line), line)))
    return x, cross(line, x), line


def spin(frame: tuple[Vector, Vector, Vector]) -> tuple[list[Any], list[Any]]:
    """w and w' of a frame: half the sum of its axes times their first and second derivatives."""

    def half(part: str) -> list[Any]:
        total = [mpf(0)] * 3
        for a in frame:
            x, d = [c.x for c in a], [getattr(c, part) for c in a]
            for k in range(3):
                total[k] += (x[k - 2] * d[k - 1] - x[k - 1] * d[k - 2]) / 2
        return total

    return half("v"), half("a")
