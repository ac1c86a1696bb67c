"""How the car as a whole is moved: turned about fixed lines, one after the other, then displaced."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Protocol

from validate.reference.directions import directed
from validate.reference.exact import as_ball
from validate.reference.jet import Jet
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, times


class Drawn(Protocol):
    """A car as drawn (see `design`): its description, its points in local lengths, and their unit, mm."""

    @property
    def plain(self) -> Mapping[str, Any]: ...

    @property
    def table(self) -> Mapping[str, Vector]: ...

    @property
    def unit(self) -> Fraction: ...


@dataclass(frozen=True)
class Turn:
    """A turn about the line through `about` along a unit vector."""

    about: Vector
    along: Vector
    sine: Scalar
    cosine: Scalar

    def turned(self, v: Vector) -> Vector:
        """A vector after it (Rodrigues)."""
        along = times(self.along, dot(v, self.along))
        across = minus(v, along)
        return plus(along, plus(_scaled(across, self.cosine), _scaled(cross(self.along, across), self.sine)))


@dataclass(frozen=True)
class ChassisMotion:
    """The turns in order, and the displacement; local."""

    turns: tuple[Turn, ...]
    rise: Vector | None

    @classmethod
    def of(
        cls, design: Drawn, driven: Mapping[str, Jet], exact: Callable[[Fraction], Scalar] = as_ball
    ) -> ChassisMotion:
        """From jets of balls or of duals of balls, or of arrays, rad and mm.

        Args:
            exact: a fraction in that kind of number.
        """
        turns, rise = [], None
        for name, spec in design.plain["inputs"].items():
            if "moves" not in spec and "turns" not in spec:
                continue
            x, y, z = (exact(part) for part in directed(design.plain, spec["along"]))
            if "moves" in spec:
                local = driven[name] * exact(1 / design.unit)
                part = (local * x, local * y, local * z)
                rise = part if rise is None else plus(rise, part)
            else:
                a, b, c = (exact(part) for part in design.table[spec["about"]])
                turns.append(Turn((a, b, c), (x, y, z), *driven[name].sin_cos()))
        return cls(tuple(turns), rise)

    def still(self) -> ChassisMotion:
        """With the values of the jets."""
        turns = tuple(Turn(t.about, t.along, t.sine.value, t.cosine.value) for t in self.turns)
        rise = self.rise
        return ChassisMotion(turns, None if rise is None else (rise[0].value, rise[1].value, rise[2].value))

    def without_displacement(self) -> ChassisMotion:
        """The turns alone."""
        return replace(self, rise=None)

    def taken_back(self, point: Vector) -> Vector:
        """The point of the car that is there when the car is moved."""
        point = point if self.rise is None else minus(point, self.rise)
        for turn in reversed(self.turns):
            point = plus(replace(turn, sine=-turn.sine).turned(minus(point, turn.about)), turn.about)
        return point

    def turned(self, vector: Vector) -> Vector:
        """A vector fixed in the car."""
        for turn in self.turns:
            vector = turn.turned(vector)
        return vector

    def moved(self, point: Vector) -> Vector:
        """A point fixed in the car."""
        for turn in self.turns:
            point = plus(turn.turned(minus(point, turn.about)), turn.about)
        return point if self.rise is None else plus(point, self.rise)


def _scaled(vector: Vector, factor: Scalar) -> Vector:
    # The factor may be a jet where the vector holds none: jets come first in a product.
    return factor * vector[0], factor * vector[1], factor * vector[2]
