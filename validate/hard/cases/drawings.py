"""Cars whose drawing is extreme: turned, far away, of any size, or with points in extreme proportions.

Turned, moved or scaled as a whole, a mechanism is unchanged: no axis of the frame may matter, and the error
may grow with the size of the mechanism, but not with its distance from the origin. The paper's hardpoints are
whole millimetres, so a shift by whole millimetres is exact.

Points nearly in line, nearly coincident, or far away: links between close points lose digits when coordinates
are subtracted, and rounding turns directions through them. A case takes an assembled car and changes only
these points; the changes are in `points.toml`. A strut's axis is fixed in the knuckle, so it may have any
position relative to the three points that carry the knuckle: through any of them, in their plane or at right
angles to it, with its two points far away or close together. None of these makes the mechanism singular. It
is singular when the slide reaches its end: the ball joint is as near to the strut's top as it lies beside the
axis, and two positions of the top on the axis meet.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from importlib.resources import files
from typing import Any

import numpy as np

from pointcoord import Scene
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.cars.car import any_rotation, rotation, unit
from validate.formulations.protocol import Solution
from validate.hard.answer import Answer, Trial, solved
from validate.hard.case import HARD, IF_ANY, RIGHT, Case, Expected, Setup, decades, family, right_from
from validate.hard.subjects import BESIDE, HEAVING, NAMED, PAPER, ROLLING, SQUARE, SUBJECTS, Content, Subject

CASES: list[Case] = []
_turned = partial(family, CASES, "Turned cars")
_far = partial(family, CASES, "Far from the origin, and mixed sizes")
CARS = (PAPER, replace(BESIDE, suffix="-beside"), *SUBJECTS[1:], ROLLING)
# Laws from home, rad and mm over s: they start at 1.5 rad if home is a right angle.
RAD, MM = (1.5 - SQUARE, 0.25, 0.125), (0.0, 30.0, 10.0)
# Beyond 1e9 mm a millimetre is less than one part in 1e9: a model may refuse such a drawing.
NEARER = right_from(1e-9)
FAR = {"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER}
# A model subtracts a local origin within a few sizes of the car, wherever the car is: its local coordinates
# are up to 8 sizes instead of 1, and their rounding is coarser by this factor. The bound of the car at home
# may happen to be smaller by a factor of 16, since both errors are only a few roundings.
LOOSER = 8.0 * 16.0


def all_moving(turn: Array, subject: Subject) -> Content:
    """All inputs of a rotated car move, with velocities and accelerations."""
    return subject.content([-0.1, 0.4], [0.0, 40.0], car=subject.car.turned(turn), stop=0.5)


def right(subject: Subject) -> Expected:
    """`RIGHT`; for Bricard's ring, which the reference cannot prove when it is rotated, `IF_ANY`."""
    return IF_ANY if subject.name in HARD else RIGHT


@_turned("number of a random rotation", (1.0, 7.0, 12.0), right, (*SUBJECTS, ROLLING))
def turned_at_random(subject: Subject, number: float) -> Content:
    """No axis of the car is parallel to an axis of the frame, so nothing cancels by chance."""
    return all_moving(any_rotation(int(number)), subject)


@_turned("90 degrees about x less this, rad; then exactly 90", (1e-1, 1e-8, 0.0), right)
def quarter_turn_about_x(subject: Subject, value: float) -> Content:
    """The car is rotated to other axes of the frame, so that coordinates change places."""
    # At 0 the rotation is a permutation without rounding.
    return all_moving(rotation(0, math.sin(value), math.cos(value)), subject)


def moved_car(subject: Subject, distance: float) -> Content:
    """A car in motion, moved away from the origin by whole millimetres."""
    away = distance * np.array((1.0, -1.0, 3.0))
    return subject.content(RAD, MM, car=subject.car.moved(away), stop=0.4)


@_far("1 mm over the distance along x; thrice as far along z", decades(), FAR, CARS)
def far_from_the_origin(subject: Subject, value: float) -> Setup:
    """Far from the origin coordinates have few digits left for the car, and differences lose more."""
    return Setup(moved_car(subject, 1.0 / value), judge=partial(as_at_home, subject))


def as_at_home(subject: Subject, trial: Trial, answer: Answer) -> Answer:
    """Compare the errors of a right answer for a moved car with the error bounds of the car at home.

    Positions are allowed one rounding of a far coordinate in addition, rates and angles nothing.
    """
    answered, reference = trial.came.get(answer.formulation), trial.reference
    if answer.outcome != "right" or not (isinstance(answered, Solution) and isinstance(reference, Solution)):
        return answer
    far = max(float(np.abs(place).max()) for place in answered.position.values())
    for quantity, claims in at_home(answer.formulation, subject).accuracy.claims.items():
        allowed = LOOSER * max((float(np.max(claim)) for claim in claims.values()), default=np.inf)
        allowed += EPS * far if quantity == "position" else 0.0
        for name in sorted(claims.keys() & reference.numbers.get(quantity, {}).keys()):
            off = float(np.abs(answered.numbers[quantity][name] - reference.numbers[quantity][name]).max())
            if off > allowed:
                reason = f"by the bounds of the car at home: {quantity} of {name} has an error of {off:.2g}"
                return replace(answer, outcome="wrong", reason=reason)
    return answer


@cache
def at_home(name: str, subject: Subject) -> Solution:
    """A formulation's solution of the car at its original position."""
    solution = solved(name, Scene.from_mapping(moved_car(subject, 0.0)))
    assert isinstance(solution, Solution)  # this scene is not hard
    return solution


@_far("1 mm over the distance along up, which the heave cancels", decades(-9), RIGHT, HEAVING)
def far_and_heaved_back(subject: Subject, value: float) -> Content:
    """Drawn far up and heaved back, a car is near the origin as the difference of two large coordinates."""
    distance = 1.0 / value
    there = subject.car.moved(distance * np.array(subject.car.up))
    return subject.content(RAD, MM, (-distance, 20.0), car=there, stop=0.4)


@_far("size, in parts of a car of some 500 mm", (1e4, 1e2, 1.0, 1e-1, 1e-4, 1e-6), RIGHT, CARS)
def sizes(subject: Subject, scale: float) -> Content:
    """Squares of small and large lengths differ by twice as many decades as the lengths, and scaling rounds
    every coordinate.
    """
    there, lengths = subject.car.scaled(scale), tuple(scale * x for x in MM)
    return subject.content(RAD, lengths, car=there, scale=scale, tolerance=1e-9 * scale, stop=0.4)


Points = Mapping[str, Array]
BALL, OUTER, LOWER, TOP = "lower_ball_joint", "tie_rod_outer", "strut_lower", "strut_top"


def put(
    p: Points, value: float, *, points: Sequence[str], power: int = 1, times: float = 1.0, **at: str
) -> Points:
    """Points moved along their lines through another point, to `times value^power` of their distance."""
    start = p[at["from"]]
    return {n: start + times * value**power * (x - start) if n in points else x for n, x in p.items()}


def aside(p: Points, value: float, *, point: str, way: Sequence[float]) -> Points:
    """A point moved off its line by `value` times a direction, mm."""
    return {**p, point: p[point] + value * np.array(way)}


def flattened(p: Points, value: float, *, point: str, onto: Sequence[str]) -> Points:
    """A point moved towards the line or the plane through others, to `value` of its distance."""
    first, *others = (p[name] for name in onto)
    basis, _ = np.linalg.qr(np.transpose([other - first for other in others]))
    foot = first + basis @ (basis.T @ (p[point] - first))
    return {**p, point: foot + value * (p[point] - foot)}


def axis(p: Points, value: float, *, weights: Mapping[str, float], off: float, way: str) -> Points:
    """The strut axis through a weighted mean of points, moved from it by `value` times `off` mm.

    Directions `way`: `foot` is from the ball joint to strut_lower; `inboard` is its component normal to the
    line from ball joint to top; `upright` is normal to the plane of ball joint, top and tie rod end.
    """
    mean: Array = np.add.reduce([share * p[name] for name, share in weights.items()])
    foot, along = p[LOWER] - p[BALL], unit(p[TOP] - p[BALL])
    ways = {
        "foot": foot,
        "inboard": unit(foot - (foot @ along) * along),
        "upright": unit(np.cross(p[TOP] - p[BALL], p[OUTER] - p[BALL])),
    }
    lower = mean + value * off * ways[way]
    return {**p, LOWER: lower, "strut_rod_end": p[TOP] + 0.4 * (lower - p[TOP])}


def slide_run_out(p: Points, value: float) -> Points:
    """The strut axis at a right angle to the line from top to ball joint, except for `value`, rad."""
    down = unit(p[BALL] - p[TOP])
    along = unit(unit(np.cross(down, (1.0, 0.0, 0.0))) + value * down)
    return {**p, LOWER: p[TOP] + 300.0 * along, "strut_rod_end": p[TOP] + 100.0 * along}


DRAWS: Mapping[str, Any] = {draw.__name__: draw for draw in (put, aside, flattened, axis, slide_run_out)}


def in_motion(row: Mapping[str, Any], subject: Subject, value: float) -> Content:
    """The scene of a row: its car in motion from the drawing."""
    ((draw, given),) = row["draw"].items()
    car = subject.car.drawn_as(DRAWS[draw](subject.assembled.array, value, **given))
    size = value if row.get("shrinks") else 1.0
    laws = {name: [drawn, *(size * rate for rate in row[name])] for name, drawn in subject.drawn.items()}
    return subject.absolute(laws, car, stop=1.0)


TABLE = tomllib.loads(files("validate.hard.cases").joinpath("points.toml").read_text(encoding="utf-8"))
for row in (group | row for group in TABLE["group"] for row in group["row"]):
    family(
        *(CASES, row["group"], row["parameter"], row["values"]),
        right_from(row["right_from"]) if row["right_from"] else RIGHT,
        [NAMED[row["car"]]],
        name=row["name"],
        why=row["why"],
    )(partial(in_motion, row))
