"""Cars rotated as a whole, far from the origin, very small and very large: the mechanism is unchanged.

No axis of the frame may matter. The error may grow with the size of the mechanism, but not with its distance
from the origin. The paper's hardpoints are whole millimetres, so a shift by whole millimetres is exact.
Errors of rates far away are compared with the error bounds of the car at its original position.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, partial

import numpy as np

from pointcoord import Scene
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.cars.car import any_rotation, rotation
from validate.formulations.protocol import Solution
from validate.hard.answer import Answer, Trial, solved
from validate.hard.case import HARD, IF_ANY, RIGHT, Case, Expected, decades, family, right_from
from validate.hard.subjects import BESIDE, HEAVING, PAPER, ROLLING, SQUARE, SUBJECTS, Content, Subject

AWAY = (1.0, -1.0, 3.0)
# A model subtracts a local origin within a few sizes of the car, wherever the car is: its local coordinates
# are up to 8 sizes instead of 1, and their rounding is coarser by this factor. The bound of the car at home
# may happen to be smaller by a factor of 16, since both errors are only a few roundings.
LOOSER = 8.0 * 16.0
# Laws from home, rad and mm over s: they start at 1.5 rad if home is a right angle.
RAD, MM = (1.5 - SQUARE, 0.25, 0.125), (0.0, 30.0, 10.0)
# Beyond 1e9 mm a millimetre is less than one part in 1e9: a model may refuse such a drawing.
NEARER = right_from(1e-9)
FAR = {"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER}
CARS = (PAPER, BESIDE, *SUBJECTS[1:], ROLLING)
CASES: list[Case] = []
_turned = partial(family, CASES, "Turned cars")
_far = partial(family, CASES, "Far from the origin, and mixed sizes")


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
    return subject.content(RAD, MM, car=subject.car.moved(distance * np.array(AWAY)), stop=0.4)


@cache
def at_home(name: str, subject: Subject) -> Solution:
    """A formulation's solution of the car at its original position."""
    solution = solved(name, Scene.from_mapping(moved_car(subject, 0.0)))
    assert isinstance(solution, Solution)  # this scene is not hard
    return solution


def as_at_home(subject: Subject, _: float, trial: Trial, answer: Answer) -> Answer:
    """Compare the errors of a right answer for a moved car with the error bounds of the car at home.

    Positions are allowed one rounding of a far coordinate in addition, rates and angles nothing.
    """
    answered, reference = trial.came.get(answer.formulation), trial.reference
    if answer.outcome != "right" or not (isinstance(answered, Solution) and isinstance(reference, Solution)):
        return answer
    home = at_home(answer.formulation, subject)
    for quantity, claims in home.accuracy.claims.items():
        allowed = LOOSER * max((float(np.max(claim)) for claim in claims.values()), default=np.inf)
        if quantity == "position":
            allowed += EPS * max(float(np.abs(place).max()) for place in answered.position.values())
        for name in sorted(claims.keys() & reference.numbers.get(quantity, {}).keys()):
            off = float(np.abs(answered.numbers[quantity][name] - reference.numbers[quantity][name]).max())
            if off > allowed:
                reason = f"by the bounds of the car at home: {quantity} of {name} has an error of {off:.2g}"
                return replace(answer, outcome="wrong", reason=reason)
    return answer


@_far("1 mm over the distance along x; thrice as far along z", decades(), FAR, CARS, judge=as_at_home)
def far_from_the_origin(subject: Subject, value: float) -> Content:
    """Far from the origin coordinates have few digits left for the car, and differences lose more."""
    return moved_car(subject, 1.0 / value)


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
