"""What an effect is, and what it is read from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from flint import arb

from validate.reference.dual import Dual, slope_of, value_of
from validate.reference.linkage import Known
from validate.reference.vectors import Scalar, Vector, cross, minus, times


@dataclass(frozen=True)
class Axes:
    """The directions of a pose; scalars are balls, or duals of balls where a derivative is wanted.

    Attributes:
        wheel: the wheel's spin axis, from its inner point to the wheel centre, as long as they are apart.
        steering: the steering axis, from its lower to its upper point, as long as they are apart.
        up: unit vector.
        forward: unit vector, up x right.
        outboard: unit vector, away from the car's middle.
    """

    wheel: Vector
    steering: Vector
    up: Vector
    forward: Vector
    outboard: Vector

    @classmethod
    def of(cls, points: Mapping[str, Vector], known: Known, outboard: int) -> Axes:
        """The axes that the linkage names; outboard is +1 along `right`, -1 against it."""
        foot, head = known.linkage.steering_axis
        inner, centre = known.linkage.wheel_axis
        return cls(
            wheel=minus(points[centre], next(points[name] for name in inner if name in points)),
            steering=minus(points[head], points[foot]),
            up=known.up,
            forward=cross(known.up, known.right),
            outboard=times(known.right, outboard),
        )


@dataclass(frozen=True)
class Effect:
    """A number of a pose.

    Attributes:
        name: what results call it.
        unit: of the number.
        positive: when it is positive, in words.
        evaluate: the number, in the kind of scalar that the axes have; not a finite ball where it is
            undefined.
    """

    name: str
    unit: str
    positive: str
    evaluate: Callable[[Axes], Scalar]

    def value(self, axes: Axes) -> arb:
        """The number."""
        return arb(value_of(self.evaluate(axes)))

    def slope(self, axes: Axes) -> arb:
        """Its derivative by the parameter of the duals; not finite where it has none."""
        return arb(slope_of(self.evaluate(axes)))


def angle(y: Scalar, x: Scalar) -> Scalar:
    """atan2(y, x), rad, of balls, of arrays or of duals of these."""
    across, along = value_of(y), value_of(x)
    turned = arb.atan2(across, along) if isinstance(across, arb) else np.arctan2(across, along)
    if not (isinstance(y, Dual) or isinstance(x, Dual)):
        return turned
    turning = along * slope_of(y) - across * slope_of(x)
    return Dual(turned, turning / (along * along + across * across))
