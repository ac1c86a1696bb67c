"""What an effect is, and what it is read from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from validate.reference.dual import Dual, slope_of, value_of
from validate.reference.vectors import Scalar, Vector, cross, minus, times

if TYPE_CHECKING:
    from validate.reference.design import Design


WHEEL, STEERING = AXES = ("wheel_axis", "steering_axis")


@dataclass(frozen=True)
class Axes:
    """The directions of a pose; scalars are balls, or duals of balls where a derivative is wanted.

    Attributes:
        lines: those of `AXES` that the mechanism says, each as long as its two points are apart: the wheel's
            spin axis, from its inner point to the wheel centre, and the steering axis, from its lower to its
            upper point.
        up: unit vector.
        forward: unit vector, up x right.
        outboard: unit vector, away from the car's middle.
    """

    lines: Mapping[str, Vector]
    up: Vector
    forward: Vector
    outboard: Vector

    @classmethod
    def of(cls, points: Mapping[str, Vector], design: Design, number: Callable[[Vector], Vector]) -> Axes:
        """The axes that the mechanism's roles name.

        Args:
            points: of the pose.
            number: three fractions in the kind of number of the points.
        """

        ends = {role: design.role(role) for role in AXES}
        return cls(
            lines={n: minus(points[two[1]], points[two[0]]) for n, two in ends.items() if two is not None},
            up=number(design.up),
            forward=number(cross(design.up, design.right)),
            outboard=number(times(design.right, design.outboard)),
        )

    @property
    def wheel(self) -> Vector:
        """The wheel's spin axis."""
        return self.lines[WHEEL]

    @property
    def steering(self) -> Vector:
        """The steering axis."""
        return self.lines[STEERING]


@dataclass(frozen=True)
class Effect:
    """A number of a pose.

    Attributes:
        name: what results call it.
        unit: of the number.
        positive: when it is positive, in words.
        axis: which one of `AXES` it is read from.
        evaluate: the number, in the kind of scalar that the axes have; not a finite ball where it is
            undefined.
    """

    name: str
    unit: str
    positive: str
    axis: str
    evaluate: Callable[[Axes], Scalar]

    def value(self, axes: Axes) -> arb:
        """The number."""
        return arb(value_of(self.evaluate(axes)))


def angle(y: Scalar, x: Scalar) -> Scalar:
    """atan2(y, x), rad, of balls, of arrays or of duals of these."""
    across, along = value_of(y), value_of(x)
    turned = arb.atan2(across, along) if isinstance(across, arb) else np.arctan2(across, along)
    if not (isinstance(y, Dual) or isinstance(x, Dual)):
        return turned
    turning = along * slope_of(y) - across * slope_of(x)
    return Dual(turned, turning / (along * along + across * across))
