"""Cars far from the origin, and very small and very large cars.

The error has to grow with the size of the mechanism, not with its distance from the origin. The paper's
hardpoints are whole millimetres, so a shift by whole millimetres is exact. The car at home says what a rate
may be off by far away.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np

from pointcoord import Scene
from pointcoord.numerics.rounding import EPS
from validate.formulations.protocol import Solution
from validate.hard.answer import Answer, Trial, solved
from validate.hard.cars import SQUARE
from validate.hard.case import RIGHT, Case, decades, family, right_from
from validate.hard.subjects import BESIDE, HEAVING, PAPER, ROLLING, SUBJECTS, Content, Subject

AWAY = (1.0, -1.0, 3.0)
# A model subtracts an origin of its own that lies within a few sizes of the car, wherever the car is: its
# own coordinates are up to 8 sizes instead of 1, and rounded so much more coarsely. A car at home may happen
# to be off by less than another by a factor of 16: errors of a few roundings each.
LOOSER = 8.0 * 16.0
# From home, rad and mm over s: from 1.5 rad where that is a right angle.
RAD, MM = (1.5 - SQUARE, 0.25, 0.125), (0.0, 30.0, 10.0)
# Beyond 1e9 mm a millimetre is less than one part in 1e9: a model may decline to take that for a drawing.
NEARER = right_from(1e-9)
FAR = {"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER}
CARS = (PAPER, BESIDE, *SUBJECTS[1:], ROLLING)
CASES: list[Case] = []
_far = partial(family, CASES, "Far from the origin, and mixed sizes")


def moved_car(subject: Subject, distance: float) -> Content:
    """A car in motion, its origin some whole millimetres away."""
    return subject.content(RAD, MM, car=subject.car.moved(distance * np.array(AWAY)), stop=0.4)


@cache
def at_home(name: str, subject: Subject) -> Solution:
    """A formulation's solution of the car at home."""
    solution = solved(name, Scene.from_mapping(moved_car(subject, 0.0)))
    assert isinstance(solution, Solution)  # nothing about it is hard
    return solution


def as_at_home(subject: Subject, _: float, trial: Trial, answer: Answer) -> Answer:
    """A right answer of a moved car, held to what the car may be off by at home.

    Positions are allowed one rounding of a far coordinate more, rates and angles nothing.
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
                reason = f"by the bounds of the car at home: {quantity} of {name} is off by {off:.2g}"
                return replace(answer, outcome="wrong", reason=reason)
    return answer


@_far("1 mm over the distance along x; thrice as far along z", decades(), FAR, CARS, judge=as_at_home)
def far_from_the_origin(subject: Subject, value: float) -> Content:
    """Far from the origin coordinates keep few digits of the car, and differences lose more."""
    return moved_car(subject, 1.0 / value)


@_far("1 mm over the distance along up, which the heave cancels", decades(-9), RIGHT, HEAVING)
def far_and_heaved_back(subject: Subject, value: float) -> Content:
    """Drawn far up and heaved back, a car comes to stand near the origin by two far coordinates."""
    distance = 1.0 / value
    there = subject.car.moved(distance * np.array(subject.car.up))
    return subject.content(RAD, MM, (-distance, 20.0), car=there, stop=0.4)


@_far("size, in parts of a car of some 500 mm", (1e4, 1e2, 1.0, 1e-1, 1e-4, 1e-6), RIGHT, CARS)
def sizes(subject: Subject, scale: float) -> Content:
    """Squares of small and large lengths differ by twice as many decades as the lengths, and every coordinate
    is rounded anew.
    """
    there, lengths = subject.car.scaled(scale), tuple(scale * x for x in MM)
    return subject.content(RAD, lengths, car=there, scale=scale, tolerance=1e-9 * scale, stop=0.4)
