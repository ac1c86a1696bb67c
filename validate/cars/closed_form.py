r"""Suspensions in closed form: arm angle and rack travel give every point, one circle after the other.

What all of them share is here. The arm angle gives the ball joint b of the lower arm on its circle about the
arm's axis. What holds the knuckle's upper end, which is each suspension's own, gives the line about which the
knuckle is steered, the kingpin. Left is the turn phi about the kingpin by which the tie rod closes. This is
the question of a point on a circle that is to be at a given distance from another point, here of the tie
rod's outer end o from its inner one i:

    |o(phi) - i|^2 = rod^2    <=>    rho q cos(phi) = (|o - b|^2 + |i - b|^2 - rod^2) / 2 - o_u i_u,

with u along the circle's axis through b, o_u and i_u the components along it from b, rho and q the distances
from it, phi the angle between o and i about it. phi is positive or negative, as it is drawn.

Arrays of inputs at once; floating point, or as many digits as mpmath has been told to work with, which needs
arrays of at least one axis.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from validate.cars.arithmetic import Array, across, cosine, dot, length, root, sign, unit
from validate.cars.car import Car

FRONT, REAR, BALL = "lower_arm_front", "lower_arm_rear", "lower_ball_joint"
OUTER, INNER, RACK = "tie_rod_outer", "tie_rod_inner", "rack_centre"


@dataclass(frozen=True)
class Kingpin:
    """The line about which the knuckle is steered, at arrays of inputs.

    Attributes:
        ball: the lower ball joint, on it, (..., 3).
        along: unit vector upward, (..., 3).
        in_knuckle: the same line in the knuckle as drawn, unit vector, (..., 3).
        spare: how far what holds the knuckle's upper end is from locking; negative where it has no place.
    """

    ball: Array
    along: Array
    in_knuckle: Array
    spare: Array


@dataclass(frozen=True)
class Swing:
    """A point on a circle that is to be at a given distance from a target.

    Attributes:
        towards: unit vector across the circle's axis to the target.
        radius: of the circle.
        cosine: of the angle about the axis from there to the point; beyond 1 the circle is out of reach.
    """

    towards: Array
    radius: Array
    cosine: Array

    @property
    def spare(self) -> Array:
        """Square of the point's height over the plane of axis and target; negative if out of reach."""
        return np.asarray(self.radius**2 * (1 - self.cosine * self.cosine))

    def outwards(self, along: Array, side: int) -> Array:
        """Unit vector from the axis to the point, on one side (1 or -1) of that plane."""
        sine = side * root(1 - self.cosine * self.cosine)
        return np.asarray(
            self.cosine[..., None] * self.towards + sine[..., None] * np.cross(along, self.towards)
        )


def swing(arm: Array, in_body: Array, along: Array, reach: Array, rod: Array) -> Swing:
    """How a point turns about an axis until it is as far from a target as the rod is long.

    Args:
        arm: from a point of the axis to the point, as drawn, (3,).
        in_body: the axis as drawn, unit vector, (..., 3).
        along: the axis now, unit vector, (..., 3).
        reach: from that point of the axis to the target, (..., 3).
        rod: from the point to the target as drawn, (3,).
    """
    drawn = np.broadcast_to(arm, in_body.shape)
    climb, radius = dot(drawn, in_body), length(across(drawn, in_body))
    beside = across(reach, along)
    q = length(beside)
    wanted = (dot(arm, arm) + dot(reach, reach) - dot(rod, rod)) / 2 - climb * dot(reach, along)
    return Swing(beside / q[..., None], radius, wanted / (radius * q))


@dataclass(frozen=True)
class ClosedForm(ABC):
    """A suspension with what its drawing fixes; lengths in the unit of its points, mm.

    Attributes:
        p: drawn points from the lower arm's front pivot.
        origin: where that is.
        up, right: axes of the car.
        arm_side, tie_side: signs of the drawing: the ball joint beside the arm's axis, the tie rod's outer
            end beside the plane of kingpin and rack.
    """

    p: Mapping[str, Array]
    origin: Array
    up: Array
    right: Array
    arm_side: int
    tie_side: int

    chassis: ClassVar[tuple[str, ...]]  # points that stand still
    knuckle: ClassVar[tuple[str, ...]]  # points that the knuckle carries

    @classmethod
    def of(cls, car: Car, number: Callable[[float], Any] = float) -> Self:
        """Taken from a car; without a rack_centre the drawn tie_rod_inner is on the rack's line.

        Args:
            number: what to calculate with; `mpmath.mpf` for as many digits as mpmath has.
        """
        places = {name: np.array([number(x) for x in place]) for name, place in car.points.items()}
        origin = places[FRONT]
        p = {name: place - origin for name, place in places.items()}
        p.setdefault(RACK, p[INNER])
        up, right = (np.array([number(x) for x in v]) for v in (car.up, car.right))
        own, leaning = cls.own_of(p, car)
        turn = dot(np.cross(leaning, p[INNER] - p[BALL]), p[OUTER] - p[BALL])
        return cls(
            p=p,
            origin=origin,
            up=up,
            right=right,
            arm_side=sign(dot(np.cross(p[REAR], up), p[BALL])),
            tie_side=sign(turn),
            **own,
        )

    @classmethod
    @abstractmethod
    def own_of(cls, p: Mapping[str, Array], car: Car) -> tuple[dict[str, Any], Array]:
        """What the drawing fixes besides, and a vector along the kingpin as drawn.

        Args:
            p: drawn points from the arm's front pivot.
        """

    @abstractmethod
    def kingpin(self, angle: ArrayLike) -> Kingpin:
        """The kingpin at arm angles, rad."""

    def of_upper_end(self, turned: Callable[[Array], Array]) -> dict[str, Array]:
        """Places of points that neither knuckle nor rack carries.

        Args:
            turned: turns a vector of the drawn knuckle as the knuckle is turned, (..., 3).
        """
        return {}

    def ball_joint(self, angle: ArrayLike) -> Array:
        """The ball joint from the arm's front pivot, (..., 3); not a number beyond the arm's dead points."""
        ball, along = self.p[BALL], unit(self.p[REAR])
        middle = dot(ball, along) * along
        radius = length(ball - middle)
        upward = unit(self.up - dot(self.up, along) * along)
        rise = cosine(np.asarray(angle)) * length(ball)
        share = (rise - dot(middle, self.up)) / (radius * dot(upward, self.up))
        aside = self.arm_side * root(1 - share * share)
        beside = np.cross(along, upward)
        return np.asarray(middle + radius * (share[..., None] * upward + aside[..., None] * beside))

    def upper_spare(self, angle: ArrayLike) -> Array:
        """How far what holds the knuckle's upper end is from locking; negative where it has no place."""
        return self.kingpin(angle).spare

    def tie_spare(self, angle: ArrayLike, rack: ArrayLike) -> Array:
        """How far tie rod and steering arm are from lying in line; negative where they cannot meet.

        The square of the height of the tie rod's outer end over the plane of kingpin and rack, in parts of
        the steering arm's square.
        """
        arm = self.p[OUTER] - self.p[BALL]
        return np.asarray(self._tie_rod(self.kingpin(angle), rack)[1].spare / dot(arm, arm))

    def pose(self, angle: ArrayLike, rack: ArrayLike = 0.0, heave: ArrayLike = 0.0) -> dict[str, Array]:
        """Every point at arm angles (rad), rack travels and heaves (mm), each of shape (...): (..., 3), mm.

        Not a number where there is no pose.
        """
        kingpin = self.kingpin(angle)
        inner, tie_rod = self._tie_rod(kingpin, rack)
        drawn, ball = self.p[BALL], kingpin.ball
        outwards = tie_rod.outwards(kingpin.along, self.tie_side)
        there = (kingpin.along, outwards, np.cross(kingpin.along, outwards))
        first = kingpin.in_knuckle
        second = unit(across(np.broadcast_to(self.p[OUTER] - drawn, first.shape), first))
        body = (first, second, np.cross(first, second))

        def turned(vector: Array) -> Array:
            parts = (dot(np.broadcast_to(vector, first.shape), side) for side in body)
            return sum(
                (part[..., None] * side for part, side in zip(parts, there, strict=True)),
                np.zeros_like(ball),
            )

        found = {name: ball + turned(self.p[name] - drawn) for name in self.knuckle if name in self.p}
        found |= self.of_upper_end(turned)
        found[INNER] = inner
        for name in self.chassis:
            found[name] = np.broadcast_to(self.p[name], ball.shape)
        lifted = np.asarray(heave)[..., None] * self.up + self.origin
        return {name: place + lifted for name, place in found.items()}

    def _tie_rod(self, kingpin: Kingpin, rack: ArrayLike) -> tuple[Array, Swing]:
        """The tie rod's inner end, and how its outer end turns about the kingpin to meet it."""
        travel = np.asarray(rack)[..., None]
        inner = np.broadcast_to(self.p[RACK] - travel * self.right, kingpin.ball.shape)
        outer = self.p[OUTER]
        reach, rod = inner - kingpin.ball, outer - self.p[INNER]
        return inner, swing(outer - self.p[BALL], kingpin.in_knuckle, kingpin.along, reach, rod)
