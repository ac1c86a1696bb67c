"""Suspensions that have a closed form: random cars in fractions, and their assemblies in mpmath."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import lotus_front
import mpmath
import numpy as np
from cars_in_closed_form import FORMS as IN_CLOSED_FORM
from cars_in_closed_form import ClosedForm
from exact_vectors import Points, number, rational_turn, turned
from hypothesis import Phase
from hypothesis import strategies as st
from mpmath import mpf
from plain_mechanisms import close_car, count_car, solve_car
from sample_cars import GENERAL_STRUT, WISHBONE, SampleCar

from validate.reference import Instant
from validate.reference.vectors import Vector, dot, minus, plus, times

# Without shrinking: a failure is told in seconds, and a car of round numbers explains no more.
PHASES = (Phase.explicit, Phase.reuse, Phase.generate)
UP: Vector = (0, 0, 1)
RIGHT: Vector = (0, 1, 0)

# A strut of a real car's size, mm; the ball joint is a few centimetres beside the strut's axis.
BASE: Points = {
    "lower_arm_front": (1200, -350, 200),
    "lower_arm_rear": (1500, -340, 210),
    "rack_centre": (1450, -100, 250),
    "strut_top": (1330, -560, 820),
    "lower_ball_joint": (1310, -720, 190),
    "tie_rod_outer": (1440, -690, 230),
    "strut_lower": (1318, -640, 330),
    "strut_rod_end": (1324, -600, 575),
    "tie_rod_inner": (1450, -330, 250),
    "wheel_centre": (1312, -770, 300),
    "wheel_axis_inner": (1312, -660, 302),
}
ARM = ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
# Points of each body, the first three not on one line.
BODIES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "macpherson": {
        "knuckle": ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner"),
        "lower_arm": ARM,
    },
    "double_wishbone": {
        "knuckle": (
            "lower_ball_joint",
            "upper_ball_joint",
            "tie_rod_outer",
            "wheel_centre",
            "wheel_axis_inner",
        ),
        "lower_arm": ARM,
        "upper_arm": ("upper_arm_front", "upper_arm_rear", "upper_ball_joint"),
    },
}


@dataclass(frozen=True)
class ExactCar:
    """A drawing that closes, and the car's directions; exact fractions."""

    suspension: str
    points: Points
    up: Vector = UP
    right: Vector = RIGHT

    closure = "drawn"

    @property
    def form(self) -> ClosedForm:
        """Its closed form, in as many digits as mpmath has."""
        return IN_CLOSED_FORM[self.suspension].of(self, number)

    @property
    def bodies(self) -> Mapping[str, tuple[str, ...]]:
        """Points of each body."""
        return BODIES[self.suspension]

    @property
    def kind(self) -> dict[str, Any]:
        """What every function of the reference is told beside points and inputs."""
        return {"up": self.up, "right": self.right, "suspension": self.suspension}

    @property
    def part(self) -> dict[str, Any]:
        """The mechanism of a scene, in doubles."""

        def doubles(vector: Vector) -> tuple[float, ...]:
            return tuple(float(c) for c in vector)

        outboard = dot(minus(self.points["wheel_centre"], self.points["lower_arm_front"]), self.right)
        return {
            "type": self.suspension,
            "side": "right" if outboard > 0 else "left",
            "points": {name: doubles(place) for name, place in self.points.items()},
            "up": doubles(self.up),
            "right": doubles(self.right),
        }

    @property
    def drawn(self) -> tuple[mpf, mpf]:
        """theta and S of the drawing."""
        p, arm = self.points, minus(self.points["lower_ball_joint"], self.points["lower_arm_front"])
        angle = mpmath.acos(number(dot(arm, self.up)) / mpmath.sqrt(number(dot(arm, arm))))
        return angle, number(dot(minus(p["rack_centre"], p["tie_rod_inner"]), self.right))

    def drawn_pose(self, theta: object, travel: object, heave: object = 0) -> Points | None:
        """The assembly on the sides of the drawing, or none."""
        return _posed(self.form, theta, travel, heave)

    def poses(self, theta: object, travel: object, heave: object = 0) -> Iterator[Points]:
        """Every assembly: each of the three steps of the closed form has two answers, or none."""
        form = self.form
        for sides in itertools.product((1, -1), repeat=3):
            other = replace(
                form, **dict(zip(("arm_side", form.upper_side_of, "tie_side"), sides, strict=True))
            )
            pose = _posed(other, theta, travel, heave)
            if pose is not None:
                yield pose

    def solve(self, inputs: Mapping[str, tuple[Any, ...]], **settings: Any) -> Instant:
        return solve_car(self.points, inputs, **{**self.kind, **settings})

    def count(self, inputs: Mapping[str, tuple[Any, ...]], **settings: Any) -> Any:
        return count_car(self.points, inputs, **self.kind, **settings)

    def close(self) -> Any:
        return close_car(self.points, **self.kind)


def _posed(form: ClosedForm, *inputs: object) -> Points | None:
    """The points at one pair of inputs and a heave; None where there is no pose."""
    found = form.pose(*(np.array([number(value)], dtype=object) for value in inputs))
    if any(mpmath.isnan(x) for place in found.values() for x in place[0]):
        return None
    return {name: tuple(place[0]) for name, place in found.items()}


def closing(points: Points, rod: Fraction, travel: Fraction, right: Vector) -> Points:
    """The points with the rod's end on the strut's axis and the tie rod's on the rack's line."""
    top = points["strut_top"]
    return points | {
        "strut_rod_end": plus(top, times(minus(points["strut_lower"], top), rod)),
        "tie_rod_inner": minus(points["rack_centre"], times(right, travel)),
    }


OFF_AXIS = ExactCar("macpherson", closing(BASE, Fraction(1, 2), Fraction(230), RIGHT))
LOTUS = ExactCar("double_wishbone", {**lotus_front.POINTS, "rack_centre": (-10, 0, 154)})


@st.composite
def off_axis_struts(draw: st.DrawFn) -> ExactCar:
    """Cars with every point up to 30 mm from `BASE`, turned at will, left or right."""
    points = draw(_nudged(BASE, 30))
    rod = draw(st.sampled_from([-1, 1])) * Fraction(draw(st.integers(5, 60)), 64)
    travel = Fraction(draw(st.integers(200 * 8, 260 * 8)), 8)
    return draw(_anywhere(ExactCar("macpherson", closing(points, rod, travel, RIGHT))))


@st.composite
def wishbones(draw: st.DrawFn) -> ExactCar:
    """Cars with every point up to 20 mm from the Lotus, turned at will, right or left."""
    points = draw(_nudged(LOTUS.points, 20))
    travel = Fraction(draw(st.integers(-200 * 8, -150 * 8)), 8)
    points["tie_rod_inner"] = minus(points["rack_centre"], times(RIGHT, travel))
    return draw(_anywhere(replace(LOTUS, points=points)))


@st.composite
def _nudged(draw: st.DrawFn, points: Points, most: int) -> Points:
    """Points that are each so many mm elsewhere at most along each axis, in eighths."""
    nudge = st.integers(-most * 8, most * 8).map(lambda n: Fraction(n, 8))
    return {
        name: (Fraction(x) + draw(nudge), Fraction(y) + draw(nudge), Fraction(z) + draw(nudge))
        for name, (x, y, z) in points.items()
    }


@st.composite
def _anywhere(draw: st.DrawFn, car: ExactCar) -> ExactCar:
    """The car or its mirror image, turned."""
    points = car.points
    if draw(st.booleans()):
        points = {name: (x, -y, z) for name, (x, y, z) in points.items()}
    turn = rational_turn(draw(st.tuples(*[st.integers(-9, 9)] * 4).filter(any)))
    places = {name: turned(turn, place) for name, place in points.items()}
    return replace(car, points=places, up=turned(turn, UP), right=turned(turn, RIGHT))


@dataclass(frozen=True)
class Suspension:
    """A suspension: random cars of it, and what its knuckle is seen by."""

    sample: SampleCar
    cars: st.SearchStrategy[ExactCar]
    knuckle: tuple[str, str, str]

    @property
    def type(self) -> str:
        """What a scene calls the suspension."""
        return self.sample.type

    @property
    def steering_axis(self) -> tuple[str, str]:
        """The points of the kingpin."""
        return IN_CLOSED_FORM[self.type].steering

    @property
    def sample_car(self) -> ExactCar:
        """The sample as a car of the closed form."""
        points = dict(self.sample.points)
        points.setdefault("rack_centre", points["tie_rod_inner"])
        exact = {name: (Fraction(x), Fraction(y), Fraction(z)) for name, (x, y, z) in points.items()}
        return ExactCar(self.type, exact)


FORMS = [
    Suspension(GENERAL_STRUT, off_axis_struts(), ("lower_ball_joint", "tie_rod_outer", "strut_lower")),
    Suspension(WISHBONE, wishbones(), ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer")),
]


def rounded(car: ExactCar) -> ExactCar:
    """The car as a scene gives it: every coordinate a double."""

    def double(vector: Vector) -> Vector:
        x, y, z = (Fraction(float(c)) for c in vector)
        return x, y, z

    points = {name: double(place) for name, place in car.points.items()}
    return replace(car, points=points, up=double(car.up), right=double(car.right))
