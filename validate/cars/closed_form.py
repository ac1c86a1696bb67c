r"""The general strut in closed form: arm angle and rack travel give every point, by two circles and a slide.

The arm angle gives the ball joint b on its circle about the arm's axis. In the knuckle the strut's axis is
fixed: l + s d, with d a unit vector. The strut's top t is on it, as far from the ball joint as it is now:

    |l - b + s d| = |t - b|,    s = h +- sqrt(|t - b|^2 - a^2),

with h the foot of the ball joint on the axis and a its distance from it; the sign is that of the drawing.
Left is the turn phi about the line from b to t, by which the tie rod closes:

    |o(phi) - i|^2 = rod^2    <=>    rho q cos(phi) = (|o - b|^2 + |i - b|^2 - rod^2) / 2 - o_u i_u,

with o and i the rod's ends, u along that line, o_u and i_u their components along it from b, rho and q their
distances from it, phi the angle between them about it. The collinear strut is the one whose axis passes
through the ball joint: a = 0.

Arrays of inputs at once; floating point, or as many digits as mpmath has been told to work with, which needs
arrays of at least one axis.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validate.extras import MissingPackage

try:
    import mpmath
except ModuleNotFoundError as error:
    raise MissingPackage("validate.cars.closed_form", error) from None

Array = NDArray[Any]  # of floats, or of mpmath's numbers
Closure = Literal["drawn", "collinear"]
KNUCKLE = ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner")


@dataclass(frozen=True)
class ClosedForm:
    """A strut with what its drawing fixes; lengths in the unit of its points, mm.

    Attributes:
        p: drawn points from the arm's front pivot.
        origin: where that is.
        up, right: axes of the car.
        axis: direction of the strut's axis as drawn, towards its top.
        foot: of the ball joint on the axis, drawn from the ball joint.
        rod_end: how far the rod's end lies beyond the top, along the axis.
        arm_side, slide_side, tie_side: signs of the drawing.
    """

    p: Mapping[str, Array]
    origin: Array
    up: Array
    right: Array
    axis: Array
    foot: Array
    rod_end: Any
    arm_side: int
    slide_side: int
    tie_side: int

    @classmethod
    def of(
        cls,
        points: Mapping[str, Sequence[float]],
        up: Sequence[float],
        right: Sequence[float],
        closure: Closure,
        number: Callable[[float], Any] = float,
    ) -> ClosedForm:
        """Taken from hardpoints, mm; without a rack_centre the drawn tie_rod_inner is on the rack's line.

        Args:
            number: what to calculate with; `mpmath.mpf` for as many digits as mpmath has.
        """
        places = {name: np.array([number(x) for x in place]) for name, place in points.items()}
        origin = places["lower_arm_front"]
        p = {name: place - origin for name, place in places.items()}
        p.setdefault("rack_centre", p["tie_rod_inner"])
        above, aside = (np.array([number(x) for x in v]) for v in (up, right))
        ball, top, lower = (p[n] for n in ("lower_ball_joint", "strut_top", "strut_lower"))
        if closure == "drawn":
            axis = _unit(top - lower)
            foot = lower - ball + _dot(ball - lower, axis)[..., None] * axis
        else:
            axis = _sign(_dot(lower - ball, top - ball)) * _unit(lower - ball)
            foot = np.zeros_like(ball)
        leaning = top - ball if closure == "drawn" else axis
        beyond = p["strut_rod_end"] - top
        turn = _dot(np.cross(leaning, p["tie_rod_inner"] - ball), p["tie_rod_outer"] - ball)
        return cls(
            p=p,
            origin=origin,
            up=above,
            right=aside,
            axis=axis,
            foot=foot,
            rod_end=_sign(_dot(beyond, axis if closure == "drawn" else top - ball)) * _length(beyond),
            arm_side=_sign(_dot(np.cross(p["lower_arm_rear"], above), ball)),
            slide_side=_sign(_dot(top - ball, axis)) if closure == "drawn" else 1,
            tie_side=_sign(turn),
        )

    def ball_joint(self, angle: ArrayLike) -> Array:
        """The ball joint from the arm's front pivot, (..., 3); not a number beyond the arm's dead points."""
        ball, along = self.p["lower_ball_joint"], _unit(self.p["lower_arm_rear"])
        middle = _dot(ball, along) * along
        radius = _length(ball - middle)
        upward = _unit(self.up - _dot(self.up, along) * along)
        rise = _cosine(np.asarray(angle)) * _length(ball)
        share = (rise - _dot(middle, self.up)) / (radius * _dot(upward, self.up))
        aside = self.arm_side * _root(1 - share * share)
        across = np.cross(along, upward)
        return np.asarray(middle + radius * (share[..., None] * upward + aside[..., None] * across))

    def slide_spare(self, angle: ArrayLike) -> Array:
        """How far the slide is from running out, (r^2 - a^2) / r^2; negative where the top has no place."""
        strut = self.p["strut_top"] - self.ball_joint(angle)
        squared = _dot(strut, strut)
        return np.asarray((squared - _dot(self.foot, self.foot)) / squared)

    def tie_spare(self, angle: ArrayLike, rack: ArrayLike) -> Array:
        """How far tie rod and steering arm are from lying in line; negative where they cannot meet.

        The square of the height of the tie rod's outer end over the plane of ball joint, strut top and rack,
        in parts of the steering arm's square.
        """
        arm = self.p["tie_rod_outer"] - self.p["lower_ball_joint"]
        frame = self._frame(angle, rack)
        share = frame.cosine
        return np.asarray(frame.radius**2 * (1 - share * share) / _dot(arm, arm))

    def pose(self, angle: ArrayLike, rack: ArrayLike = 0.0, heave: ArrayLike = 0.0) -> dict[str, Array]:
        """Every point at arm angles (rad), rack travels and heaves (mm), each of shape (...): (..., 3), mm.

        Not a number where there is no pose.
        """
        frame = self._frame(angle, rack)
        drawn, ball = self.p["lower_ball_joint"], frame.ball
        sine = self.tie_side * _root(1 - frame.cosine * frame.cosine)
        outwards = frame.cosine[..., None] * frame.towards + sine[..., None] * np.cross(
            frame.along, frame.towards
        )
        there = (frame.along, outwards, np.cross(frame.along, outwards))
        first = frame.body_along
        second = _unit(_across(np.broadcast_to(self.p["tie_rod_outer"] - drawn, first.shape), first))
        body = (first, second, np.cross(first, second))

        def turned(vector: Array) -> Array:
            parts = (_dot(np.broadcast_to(vector, first.shape), side) for side in body)
            return sum(
                (part[..., None] * side for part, side in zip(parts, there, strict=True)),
                np.zeros_like(ball),
            )

        found = {n: ball + turned(self.p[n] - drawn) for n in KNUCKLE if n in self.p}
        found["strut_rod_end"] = self.p["strut_top"] + self.rod_end * turned(self.axis)
        found["tie_rod_inner"] = frame.inner
        for name in ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"):
            found[name] = np.broadcast_to(self.p[name], ball.shape)
        lifted = np.asarray(heave)[..., None] * self.up + self.origin
        return {name: place + lifted for name, place in found.items()}

    def _frame(self, angle: ArrayLike, rack: ArrayLike) -> _Frame:
        """What is known before the tie rod's side is chosen."""
        drawn, ball = self.p["lower_ball_joint"], self.ball_joint(angle)
        strut = self.p["strut_top"] - ball
        squared = _dot(strut, strut)
        slid = self.slide_side * _root(squared - _dot(self.foot, self.foot))
        body_along = _unit(self.foot + slid[..., None] * self.axis)
        along = _unit(strut)
        travel = np.asarray(rack)[..., None]
        inner = np.broadcast_to(self.p["rack_centre"] - travel * self.right, ball.shape)
        reach = inner - ball
        arm, rod = self.p["tie_rod_outer"] - drawn, self.p["tie_rod_outer"] - self.p["tie_rod_inner"]
        climb = _dot(np.broadcast_to(arm, body_along.shape), body_along)
        radius = _length(_across(np.broadcast_to(arm, body_along.shape), body_along))
        beside = _across(reach, along)
        q = _length(beside)
        wanted = (_dot(arm, arm) + _dot(reach, reach) - _dot(rod, rod)) / 2 - climb * _dot(reach, along)
        return _Frame(ball, inner, along, beside / q[..., None], body_along, radius, wanted / (radius * q))


@dataclass(frozen=True)
class _Frame:
    """Ball joint and rack; the line from ball joint to top, there and as drawn; the closing angle.

    `towards` is the unit vector across that line to the rack, `radius` the tie rod's outer end's distance
    from the line, `cosine` that of its angle from there.
    """

    ball: Array
    inner: Array
    along: Array
    towards: Array
    body_along: Array
    radius: Array
    cosine: Array


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=-1))


def _length(vector: Array) -> Array:
    return _root(_dot(vector, vector))


def _unit(vector: Array) -> Array:
    return np.asarray(vector / _length(vector)[..., None])


def _across(vector: Array, along: Array) -> Array:
    """The part of a vector at right angles to a unit vector; twice, for the rounding of the first."""
    for _ in range(2):
        vector = vector - _dot(vector, along)[..., None] * along
    return vector


def _sign(value: Any) -> int:
    return -1 if value < 0 else 1


def _root(value: Array) -> Array:
    """Square root; not a number below zero, in either arithmetic."""
    if np.asarray(value).dtype != object:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(value))
    return np.asarray(_each(lambda x: mpmath.sqrt(x) if x >= 0 else mpmath.nan, value))


def _cosine(angle: Array) -> Array:
    return np.asarray(np.cos(angle) if angle.dtype != object else _each(mpmath.cos, angle))


def _each(function: Callable[[Any], Any], values: Array) -> Array:
    flat = [function(value) for value in np.asarray(values, dtype=object).ravel()]
    found = np.empty(len(flat), dtype=object)
    found[:] = flat
    return found.reshape(np.shape(values))
