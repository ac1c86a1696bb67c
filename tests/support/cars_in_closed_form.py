r"""Strut and double wishbone in closed form, in plain floating point or in many digits; how far they go.

No solver of the project made any of it: the forms are checks of all of them.

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

In the knuckle the strut's axis is fixed: l + s d, with d a unit vector. The strut's top t is on it, as far
from the ball joint b as it is now:

    |l - b + s d| = |t - b|,    s = h +- sqrt(|t - b|^2 - a^2),

with h the foot of the ball joint on the axis and a its distance from it; the sign is that of the drawing. The
collinear strut is the one whose axis passes through the ball joint: a = 0.

The upper arm's ball joint goes round the upper pivots on a circle, and is as far from the lower ball joint as
the knuckle is high: the question of `swing`, asked once more. Where it has no answer, the upper
arm and the kingpin lie in one plane with the upper pivots and lock.

The lower arm has two dead points, where its ball joint is highest or lowest on its circle. What holds the
knuckle's upper end locks by itself: the slide of a strut runs out where the ball joint is as near to the
strut's top as it lies beside the strut's axis; upper arm and kingpin of a double wishbone come to lie in one
plane with the upper pivots. Tie rod and steering arm can come to lie in line. All three are taken from the
closed form, apart from the models and from the reference.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self

import mpmath
import numpy as np
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from validate.cars.base_cars import Variant, variants
from validate.cars.car import Car
from validate.strategies import cars

Array = NDArray[Any]  # of floats, or of mpmath's numbers
Inputs = dict[str, float]

FRONT, REAR, BALL = "lower_arm_front", "lower_arm_rear", "lower_ball_joint"
OUTER, INNER, RACK = "tie_rod_outer", "tie_rod_inner", "rack_centre"
TOP, LOWER, ROD_END = "strut_top", "strut_lower", "strut_rod_end"
UPPER_FRONT, UPPER_REAR, UPPER_BALL = "upper_arm_front", "upper_arm_rear", "upper_ball_joint"
CENTRE, AXIS = "wheel_centre", "wheel_axis_inner"
DRIVEN = ("arm_angle", "rack")
ARM, TIE_ROD = "arm", "tie_rod"
SCAN = 200  # places between the drawing and the end of an input where a lock is looked for
PARTS, ROUNDS = 64, 10  # dividing an interval in 64 parts ten times leaves 2^-60 of it: rounding
SHORT = 0.05  # of the car: links no shorter make a sound car


def dot(a: Array, b: Array) -> Array:
    """The scalar product."""
    return np.asarray((a * b).sum(axis=-1))


def length(vector: Array) -> Array:
    """The length of a vector."""
    return root(dot(vector, vector))


def unit(vector: Array) -> Array:
    """A vector of length 1."""
    return np.asarray(vector / length(vector)[..., None])


def across(vector: Array, along: Array) -> Array:
    """The part of a vector at right angles to a unit vector; twice, for the rounding of the first."""
    for _ in range(2):
        vector = vector - dot(vector, along)[..., None] * along
    return vector


def sign(value: Any) -> int:
    """1 from zero up, else -1."""
    return -1 if value < 0 else 1


def root(value: Array) -> Array:
    """Square root; not a number below zero, in either arithmetic."""
    if np.asarray(value).dtype != object:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(value))
    return np.asarray(_each(lambda x: mpmath.sqrt(x) if x >= 0 else mpmath.nan, value))


def cosine(angle: Array) -> Array:
    """Cosine of an angle, rad."""
    return np.asarray(np.cos(angle) if angle.dtype != object else _each(mpmath.cos, angle))


def _each(function: Callable[[Any], Any], values: Array) -> Array:
    flat = [function(value) for value in np.asarray(values, dtype=object).ravel()]
    found = np.empty(len(flat), dtype=object)
    found[:] = flat
    return found.reshape(np.shape(values))


class Drawn(Protocol):
    """A car as drawn, in numbers of any kind."""

    @property
    def points(self) -> Mapping[str, Sequence[Any]]: ...
    @property
    def up(self) -> Sequence[Any]: ...
    @property
    def right(self) -> Sequence[Any]: ...
    @property
    def closure(self) -> str: ...


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
    steering: ClassVar[tuple[str, str]]  # points of the kingpin
    links: ClassVar[tuple[tuple[str, str], ...]]  # pairs of points at their drawn distance
    upper_lock: ClassVar[str]  # what locks besides arm and tie rod
    upper_side_of: ClassVar[str]  # the sign of the drawing at the knuckle's upper end, by its name

    @classmethod
    def of(cls, car: Drawn, number: Callable[[Any], Any] = float) -> Self:
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
    def own_of(cls, p: Mapping[str, Array], car: Drawn) -> tuple[dict[str, Any], Array]:
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


@dataclass(frozen=True)
class StrutForm(ClosedForm):
    """A strut with what its drawing fixes.

    Attributes:
        axis: direction of the strut's axis as drawn, towards its top.
        foot: of the ball joint on the axis, drawn from the ball joint.
        rod_end: how far the rod's end lies beyond the top, along the axis.
        slide_side: sign of the drawing: on which side of that foot the top is.
    """

    axis: Array
    foot: Array
    rod_end: Any
    slide_side: int

    chassis = (FRONT, REAR, RACK, TOP)
    knuckle = (BALL, OUTER, LOWER, CENTRE, AXIS)
    steering = (BALL, TOP)
    links = ((FRONT, BALL), (BALL, OUTER), (OUTER, LOWER), (OUTER, INNER), (LOWER, BALL))
    upper_lock = "strut"
    upper_side_of = "slide_side"

    @classmethod
    def own_of(cls, p: Mapping[str, Array], car: Drawn) -> tuple[dict[str, Any], Array]:
        """The axis in the knuckle; the kingpin of a collinear strut is drawn along the knuckle's own line."""
        ball, top, lower, beyond = p[BALL], p[TOP], p[LOWER], p[ROD_END] - p[TOP]
        if car.closure == "drawn":
            axis = unit(top - lower)
            foot = lower - ball + dot(ball - lower, axis)[..., None] * axis
            leaning, slid, side = top - ball, axis, sign(dot(top - ball, axis))
        else:
            axis = sign(dot(lower - ball, top - ball)) * unit(lower - ball)
            foot = np.zeros_like(ball)
            leaning, slid, side = axis, top - ball, 1
        rod_end = sign(dot(beyond, slid)) * length(beyond)
        return {"axis": axis, "foot": foot, "rod_end": rod_end, "slide_side": side}, leaning

    def kingpin(self, angle: ArrayLike) -> Kingpin:
        """The line from ball joint to top.

        Its `spare` says how far the slide is from running out, (r^2 - a^2) / r^2.
        """
        ball = self.ball_joint(angle)
        strut = self.p[TOP] - ball
        squared, beside = dot(strut, strut), dot(self.foot, self.foot)
        slid = self.slide_side * root(squared - beside)
        in_knuckle = unit(self.foot + slid[..., None] * self.axis)
        return Kingpin(ball, unit(strut), in_knuckle, np.asarray((squared - beside) / squared))

    def of_upper_end(self, turned: Callable[[Array], Array]) -> dict[str, Array]:
        """The rod's end, on the axis as the knuckle is turned."""
        return {ROD_END: self.p[TOP] + self.rod_end * turned(self.axis)}


@dataclass(frozen=True)
class WishboneForm(ClosedForm):
    """A double wishbone with what its drawing fixes.

    Attributes:
        upper_side: sign of the drawing: the upper ball joint beside the plane of the upper pivots and the
            lower ball joint.
    """

    upper_side: int

    chassis = (FRONT, REAR, UPPER_FRONT, UPPER_REAR, RACK)
    knuckle = (BALL, UPPER_BALL, OUTER, CENTRE, AXIS)
    steering = (BALL, UPPER_BALL)
    links = (
        *((FRONT, BALL), (UPPER_FRONT, UPPER_BALL), (BALL, UPPER_BALL)),
        *((BALL, OUTER), (UPPER_BALL, OUTER), (OUTER, INNER)),
    )
    upper_lock = "upper_arm"
    upper_side_of = "upper_side"

    @classmethod
    def own_of(cls, p: Mapping[str, Array], car: Drawn) -> tuple[dict[str, Any], Array]:
        """The upper arm's side; the kingpin is drawn from one ball joint to the other."""
        pivot, upper, ball = p[UPPER_FRONT], p[UPPER_BALL], p[BALL]
        side = sign(dot(np.cross(p[UPPER_REAR] - pivot, ball - pivot), upper - pivot))
        return {"upper_side": side}, upper - ball

    def kingpin(self, angle: ArrayLike) -> Kingpin:
        """The line from the lower ball joint to the upper one.

        Its `spare` is the square of the upper ball joint's height over the plane of the upper pivots and the
        lower ball joint, in parts of the square of the ball joints' distance.
        """
        ball = self.ball_joint(angle)
        pivot = self.p[UPPER_FRONT]
        arm, drawn = self.p[UPPER_BALL] - pivot, self.p[UPPER_BALL] - self.p[BALL]
        along = np.broadcast_to(unit(self.p[UPPER_REAR] - pivot), ball.shape)
        upper_arm = swing(arm, along, along, ball - pivot, drawn)
        climb = dot(np.broadcast_to(arm, along.shape), along)
        outwards = upper_arm.outwards(along, self.upper_side)
        upper = pivot + climb[..., None] * along + upper_arm.radius[..., None] * outwards
        in_knuckle = np.broadcast_to(unit(drawn), ball.shape)
        return Kingpin(ball, unit(upper - ball), in_knuckle, np.asarray(upper_arm.spare / dot(drawn, drawn)))


FORMS: Mapping[str, type[ClosedForm]] = {"macpherson": StrutForm, "double_wishbone": WishboneForm}
VARIANTS: tuple[Variant, ...] = tuple(one for one in variants() if one.suspension in FORMS)
DRAWN = tuple(one for one in VARIANTS if one.closure == "drawn")


def cars_of(these: Sequence[Variant] = VARIANTS) -> st.SearchStrategy[Car]:
    """Random cars that have a closed form."""
    return st.one_of([cars(one.suspension, one.closure).map(lambda drawn: drawn[0]) for one in these])


@dataclass(frozen=True)
class Linkage:
    """How far a car's inputs go; arrays of inputs at once."""

    form: ClosedForm

    @classmethod
    def of(cls, car: Car) -> Linkage:
        """Taken from a car's hardpoints."""
        return cls(FORMS[car.suspension].of(car))

    @property
    def p(self) -> Mapping[str, Array]:
        """The drawing, from the arm's front pivot."""
        return self.form.p

    @property
    def up(self) -> Array:
        """Upward."""
        return self.form.up

    @property
    def right(self) -> Array:
        """To the right."""
        return self.form.right

    @property
    def size(self) -> float:
        """Largest distance of a point from the arm's front pivot."""
        return max(float(np.linalg.norm(place)) for place in self.p.values())

    @property
    def arm_length(self) -> float:
        """From the front pivot to the ball joint."""
        return float(np.linalg.norm(self.p[BALL]))

    @property
    def drawn_angle(self) -> float:
        """Arm angle of the drawing."""
        return math.acos(float(self.p[BALL] @ self.up) / self.arm_length)

    @property
    def drawn_rack(self) -> float:
        """Rack travel of the drawing; positive against `right`."""
        return -float((self.p[INNER] - self.p[RACK]) @ self.right)

    @property
    def home(self) -> Inputs:
        """The inputs of the drawing."""
        return {"arm_angle": self.drawn_angle, "rack": self.drawn_rack}

    @property
    def sound(self) -> bool:
        """Whether no link is shorter than a twentieth of the car, nor the arm drawn at its dead point."""
        axis, ball = self.p[REAR], self.p[BALL]
        flat = abs(float(np.cross(axis, self.up) @ ball)) / float(np.linalg.norm(axis) * self.arm_length)
        lengths = (float(np.linalg.norm(self.p[a] - self.p[b])) for a, b in self.form.links)
        return min(lengths) > SHORT * self.size and flat > SHORT

    def dead_points(self) -> tuple[float, float]:
        """Arm angles at which the ball joint is highest and lowest on its circle about the arm's axis."""
        axis, ball = self.p[REAR], self.p[BALL]
        along = float(axis @ ball) / float(axis @ axis)
        radius = float(np.linalg.norm(ball - along * axis))
        middle = along * float(axis @ self.up)
        across = self.up - axis * float(axis @ self.up) / float(axis @ axis)
        swing = radius * float(np.linalg.norm(across))
        high, low = (min(1.0, max(-1.0, (middle + s) / self.arm_length)) for s in (swing, -swing))
        return math.acos(high), math.acos(low)

    def spare(self, angle: Array, rack: Array) -> Array:
        """How far upper end and tie rod are from their ends, the nearer of both; see `ClosedForm`.

        Negative or not a number where there is no pose.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            upper = self.form.upper_spare(angle)
            return np.asarray(np.minimum(upper, self.form.tie_spare(angle, rack)))

    def end(self, inputs: Inputs, driven: str, ahead: bool) -> tuple[float, str] | None:
        """Last value of an input that can be reached from `inputs`, and what locks there; None if none."""
        start = inputs[driven]
        if driven == "arm_angle":
            low, high = self.dead_points()
            limit, lock = (high if ahead else low), ARM
        else:
            limit, lock = start + (2.0 if ahead else -2.0) * self.size, ""

        def spare(values: Array) -> Array:
            pair = {name: np.full_like(values, inputs[name]) for name in DRIVEN} | {driven: values}
            return self.spare(pair["arm_angle"], pair["rack"])

        s = np.linspace(1.0, 0.0, SCAN + 1)
        if driven == "arm_angle":
            # The ball joint moves as the root of the way to a dead point, where the root is of rounding.
            s = s[:-1] ** 2
        values = limit + s * (start - limit)
        open_ = spare(values) > 0.0
        if not open_[0]:
            return None
        if open_.all():
            return (limit, lock) if lock else None
        first = int(np.argmin(open_))
        inside, outside = _narrowed(spare, float(values[first - 1]), float(values[first]))
        return inside, self._lock(np.array(outside)) if driven == "arm_angle" else TIE_ROD

    def _lock(self, angle: Array) -> str:
        """What has no place any more at an arm angle beyond an end."""
        if np.isnan(self.form.ball_joint(angle)).any():
            return ARM
        return TIE_ROD if float(self.form.upper_spare(angle)) > 0.0 else self.form.upper_lock

    def ends(self, inputs: Inputs, driven: str) -> list[tuple[float, str]]:
        """The ends of an input, upper and lower, as far as it has them."""
        found = (self.end(inputs, driven, ahead) for ahead in (True, False))
        return [end for end in found if end is not None]


def _narrowed(spare: Callable[[Array], Array], inside: float, outside: float) -> tuple[float, float]:
    for _ in range(ROUNDS):
        values = np.linspace(inside, outside, PARTS + 1)
        shut = ~(spare(values[1:]) > 0.0)
        first = int(np.argmax(shut)) if shut.any() else PARTS - 1
        inside, outside = float(values[first]), float(values[first + 1])
    return inside, outside
