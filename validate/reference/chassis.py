"""Motion of the car as a whole: turns about fixed lines, one after the other, then a displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from validate.reference.car_data import directions
from validate.reference.jet import Jet, value_of
from validate.reference.vectors import Exact, Scalar, Vector, cross, dot, each, minus, plus, root, times


@dataclass(frozen=True)
class Turn:
    """A turn about the line through `about` along a unit vector."""

    about: Vector
    along: Vector
    sine: Scalar
    cosine: Scalar

    def turned(self, v: Vector) -> Vector:
        """A vector after the turn (Rodrigues)."""
        along = times(self.along, dot(v, self.along))
        across = minus(v, along)
        return plus(along, plus(times(across, self.cosine), times(cross(self.along, across), self.sine)))


@dataclass(frozen=True)
class ChassisMotion:
    """The turns in order, and the displacement; local."""

    turns: tuple[Turn, ...]
    rise: Vector | None

    @classmethod
    def of(
        cls,
        plain: Mapping[str, Any],
        table: Mapping[str, Vector],
        unit: Fraction,
        driven: Mapping[str, Jet],
        exact: Exact,
    ) -> ChassisMotion:
        """From a design's data and jets of any kind of number, rad and mm; `exact` converts a fraction."""
        turns, rise = [], None
        for name, spec in plain["inputs"].items():
            if "moves" in spec:
                part = times(each(exact, directions(plain)[spec["along"]]), driven[name] * exact(1 / unit))
                rise = part if rise is None else plus(rise, part)
            elif "turns" in spec:
                about, along = each(exact, table[spec["about"]]), directions(plain)[spec["along"]]
                # A turn keeps lengths only about a vector whose length is exactly 1.
                unit_vector = times(each(exact, along), 1 / root(exact(dot(along, along))))
                turns.append(Turn(about, unit_vector, *driven[name].sin_cos()))
        return cls(tuple(turns), rise)

    def still(self) -> ChassisMotion:
        """Without derivatives."""
        turns = (replace(t, sine=value_of(t.sine), cosine=value_of(t.cosine)) for t in self.turns)
        return ChassisMotion(tuple(turns), None if self.rise is None else each(value_of, self.rise))

    def taken_back(self, point: Vector) -> Vector:
        """The point of the drawn car that moves to this place."""
        point = point if self.rise is None else minus(point, self.rise)
        for turn in reversed(self.turns):
            point = plus(replace(turn, sine=-turn.sine).turned(minus(point, turn.about)), turn.about)
        return point

    def turned(self, vector: Vector) -> Vector:
        """A vector fixed in the car, after the motion."""
        for turn in self.turns:
            vector = turn.turned(vector)
        return vector

    def moved(self, point: Vector) -> Vector:
        """A point fixed in the car, after the motion."""
        for turn in self.turns:
            point = plus(turn.turned(minus(point, turn.about)), turn.about)
        return point if self.rise is None else plus(point, self.rise)
