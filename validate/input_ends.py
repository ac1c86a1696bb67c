"""How far the inputs of a strut go before its links cannot follow, in plain floating point.

The lower arm has two dead points, where its ball joint is highest or lowest on its circle, and tie rod and
steering arm can come to lie in line. Both ends are worked out from the circles on which the two ball
joints move, apart from both models and from the truth.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Inputs = dict[str, float]

DRIVEN = ("arm_angle", "rack")
ARM, TIE_ROD = "arm", "tie_rod"
SCAN = 200  # places between the drawing and the end of an input where a closure is looked at
PATH = 60  # places on the way from the drawing where the closures must be met
PARTS, ROUNDS = 64, 10  # dividing an interval in 64 parts ten times leaves 2^-60 of it: rounding


@dataclass(frozen=True)
class Car:
    """Hardpoints, mm, and how the car stands in the frame."""

    points: dict[str, tuple[float, float, float]]
    side: str
    up: tuple[float, float, float]
    right: tuple[float, float, float]


@dataclass(frozen=True)
class Linkage:
    """The circles of a car's ball joints, to say how far its inputs go; arrays of inputs at once."""

    p: Mapping[str, Array]
    up: Array
    right: Array

    @classmethod
    def of(cls, car: Car) -> Linkage:
        """Taken from a car's hardpoints."""
        origin = np.array(car.points["lower_arm_front"])
        places = {name: np.array(place) - origin for name, place in car.points.items()}
        return cls(places, np.array(car.up), np.array(car.right))

    @property
    def size(self) -> float:
        """Largest distance of a point from the arm's front pivot."""
        return max(float(np.linalg.norm(place)) for place in self.p.values())

    @property
    def arm_length(self) -> float:
        """From the front pivot to the ball joint."""
        return float(np.linalg.norm(self.p["lower_ball_joint"]))

    @property
    def drawn_angle(self) -> float:
        """Arm angle of the drawing."""
        return math.acos(float(self.p["lower_ball_joint"] @ self.up) / self.arm_length)

    @property
    def drawn_rack(self) -> float:
        """Rack travel of the drawing; positive against `right`."""
        return -float((self.p["tie_rod_inner"] - self.p["rack_centre"]) @ self.right)

    @property
    def sound(self) -> bool:
        """Whether neither link is shorter than a twentieth of the car, nor the drawing flat or upright."""
        ball, outer, lower = (self.p[n] for n in ("lower_ball_joint", "tie_rod_outer", "strut_lower"))
        lengths = (ball, outer - ball, outer - lower, outer - self.p["tie_rod_inner"], lower - ball)
        axis = self.p["lower_arm_rear"]
        flat = abs(float(np.cross(axis, self.up) @ ball)) / float(np.linalg.norm(axis) * self.arm_length)
        shortest = min(float(np.linalg.norm(vector)) for vector in lengths)
        return shortest > 0.05 * self.size and flat > 0.05

    def dead_points(self) -> tuple[float, float]:
        """Arm angles at which the ball joint is highest and lowest on its circle about the arm's axis."""
        axis, ball = self.p["lower_arm_rear"], self.p["lower_ball_joint"]
        along = float(axis @ ball) / float(axis @ axis)
        radius = float(np.linalg.norm(ball - along * axis))
        middle = along * float(axis @ self.up)
        across = self.up - axis * float(axis @ self.up) / float(axis @ axis)
        swing = radius * float(np.linalg.norm(across))
        high, low = (min(1.0, max(-1.0, (middle + s) / self.arm_length)) for s in (swing, -swing))
        return math.acos(high), math.acos(low)

    def spare(self, angle: Array, rack: Array) -> Array:
        """How far tie rod and steering arm are from lying in line; negative where they cannot meet.

        The square of the height of the tie rod's outer end over the plane of the strut's lower points
        and the rack, in parts of the steering arm's square; NaN beyond the arm's dead points.
        """
        axis, ball, top = (self.p[n] for n in ("lower_arm_rear", "lower_ball_joint", "strut_top"))
        outer, lower, inner = (self.p[n] for n in ("tie_rod_outer", "strut_lower", "tie_rod_inner"))
        with np.errstate(invalid="ignore"):
            height = self.arm_length * np.cos(angle)
            side = math.copysign(1.0, float(np.cross(axis, self.up) @ ball))
            ball_now = _corner(axis, float(axis @ ball), self.up, height, float(ball @ ball), side)
            strut = top - ball_now
            strut /= np.linalg.norm(strut, axis=-1, keepdims=True)
            towards = math.copysign(1.0, float((lower - ball) @ (top - ball)))
            r7 = strut * (towards * float(np.linalg.norm(lower - ball)))
            r9 = self.p["rack_centre"] - rack[..., None] * self.right - ball_now
            arm, rod, stay = (_square(v) for v in (outer - ball, outer - inner, outer - lower))
            along_7 = 0.5 * (arm + _square(lower - ball) - stay)
            along_9 = 0.5 * (arm + np.sum(r9 * r9, axis=-1) - rod)
            flat = _flat(r7, along_7, r9, along_9)
            return np.asarray(1.0 - np.sum(flat * flat, axis=-1) / arm)

    def end(self, inputs: Inputs, driven: str, ahead: bool) -> tuple[float, str] | None:
        """Last value of an input that can be reached from `inputs`, and what locks there; None if none."""
        start = inputs[driven]
        if driven == "arm_angle":
            low, high = self.dead_points()
            limit, closure = (high if ahead else low), ARM
        else:
            limit, closure = start + (2.0 if ahead else -2.0) * self.size, ""

        def spare(values: Array) -> Array:
            pair = {name: np.full_like(values, inputs[name]) for name in DRIVEN} | {driven: values}
            return self.spare(pair["arm_angle"], pair["rack"])

        # The last place of an arm is its dead point itself, where the root is of rounding.
        values = np.linspace(start, limit, SCAN + 1)[: SCAN if driven == "arm_angle" else None]
        open_ = spare(values) > 0.0
        if not open_[0]:
            return None
        if open_.all():
            return (limit, closure) if closure else None
        first = int(np.argmin(open_))
        return _narrowed(spare, float(values[first - 1]), float(values[first])), TIE_ROD

    def way_is_open(self, home: Inputs, inputs: Inputs) -> bool:
        """Whether the closures are met all along the straight way of ball joint height and rack."""
        s = np.linspace(0.0, 1.0, PATH)
        rise = (1.0 - s) * math.cos(home["arm_angle"]) + s * math.cos(inputs["arm_angle"])
        rack = (1.0 - s) * home["rack"] + s * inputs["rack"]
        return bool((self.spare(np.arccos(rise), rack)[:-1] > 1e-3 * (1.0 - s[:-1])).all())


def _narrowed(spare: Callable[[Array], Array], inside: float, outside: float) -> float:
    for _ in range(ROUNDS):
        values = np.linspace(inside, outside, PARTS + 1)
        shut = ~(spare(values[1:]) > 0.0)
        first = int(np.argmax(shut)) if shut.any() else PARTS - 1
        inside, outside = float(values[first]), float(values[first + 1])
    return inside


def _square(vector: Array) -> float:
    return float(vector @ vector)


def _flat(a: Array, along_a: Array | float, b: Array, along_b: Array | float) -> Array:
    """The vector in the plane of a and b with the products along_a with a and along_b with b."""
    aa, ab, bb = (np.sum(u * v, axis=-1) for u, v in ((a, a), (a, b), (b, b)))
    determinant = aa * bb - ab * ab
    alpha = (along_a * bb - along_b * ab) / determinant
    beta = (along_b * aa - along_a * ab) / determinant
    return np.asarray(alpha[..., None] * a + beta[..., None] * b)


def _corner(a: Array, along_a: float, b: Array, along_b: Array, squared: float, side: float) -> Array:
    """The vector of given square with these two products, on one side of the plane of a and b."""
    flat = _flat(np.broadcast_to(a, (*along_b.shape, 3)), along_a, b, along_b)
    normal = np.cross(a, b)
    height = np.sqrt((squared - np.sum(flat * flat, axis=-1)) / float(normal @ normal))
    return np.asarray(flat + side * height[..., None] * normal)
