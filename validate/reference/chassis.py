"""Motion of the car as a whole: turns about fixed lines, one after the other, then a displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from validate.reference.car_data import directions
from validate.reference.jet import Jet, value_of
from validate.reference.vectors import (
    AXES,
    Exact,
    Placement,
    Vector,
    cross,
    dot,
    each,
    minus,
    plus,
    root,
    times,
)


@dataclass(frozen=True)
class ChassisMotion:
    """Where the turns place the car, and the displacement; local."""

    turns: Placement
    rise: Vector

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
        car, rise = Placement(AXES, (0, 0, 0)), (0, 0, 0)
        for name, spec in plain["inputs"].items():
            if "moves" in spec:
                way = each(exact, directions(plain)[spec["along"]])
                rise = plus(rise, times(way, driven[name] * exact(1 / unit)))
            elif "turns" in spec:
                about, along = each(exact, table[spec["about"]]), directions(plain)[spec["along"]]
                # A turn keeps lengths only about a vector whose length is exactly 1.
                a = times(each(exact, along), 1 / root(exact(dot(along, along))))
                sine, cosine = driven[name].sin_cos()

                def turned(v: Vector, a: Vector = a, sine: Jet = sine, cosine: Jet = cosine) -> Vector:
                    """Rodrigues' formula."""
                    ahead = times(a, dot(v, a))
                    return plus(ahead, plus(times(minus(v, ahead), cosine), times(cross(a, v), sine)))

                x, y, z = map(turned, car.columns)
                car = Placement((x, y, z), plus(turned(minus(car.origin, about)), about))
        return cls(car, rise)

    def still(self) -> ChassisMotion:
        """Without derivatives."""
        x, y, z, origin, rise = (
            each(value_of, v) for v in (*self.turns.columns, self.turns.origin, self.rise)
        )
        return ChassisMotion(Placement((x, y, z), origin), rise)

    def taken_back(self, point: Vector) -> Vector:
        """The point of the drawn car that moves to this place."""
        return self.turns.turned_back(minus(minus(point, self.rise), self.turns.origin))

    def turned(self, vector: Vector) -> Vector:
        """A vector fixed in the car, after the motion."""
        return self.turns.turned(vector)

    def moved(self, point: Vector) -> Vector:
        """A point fixed in the car, after the motion."""
        return plus(self.turns.place(point), self.rise)
