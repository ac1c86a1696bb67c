"""Cars turned as a whole, which changes nothing about their mechanism: no axis of the frame is preferred."""

from __future__ import annotations

import math
from functools import partial

from validate.cars.car import any_rotation, rotation
from validate.hard.cars import Array
from validate.hard.case import HARD, IF_ANY, RIGHT, Case, Expected, family
from validate.hard.subjects import ROLLING, SUBJECTS, Content, Subject

CASES: list[Case] = []
_turned = partial(family, CASES, "Turned cars")


def all_moving(turn: Array, subject: Subject) -> Content:
    """All inputs of a turned car move, with all rates."""
    return subject.content([-0.1, 0.4], [0.0, 40.0], car=subject.car.turned(turn), stop=0.5)


def right(subject: Subject) -> Expected:
    """Of Bricard's ring, turned, the reference finds no proof."""
    return IF_ANY if subject.name in HARD else RIGHT


@_turned("number of a random rotation", (1.0, 7.0, 12.0), right, (*SUBJECTS, ROLLING))
def turned_at_random(subject: Subject, number: float) -> Content:
    """No axis of the car lies along an axis of the frame, so nothing cancels by chance."""
    return all_moving(any_rotation(int(number)), subject)


@_turned("90 degrees about x less this, rad; then exactly 90", (1e-1, 1e-8, 0.0), right)
def quarter_turn_about_x(subject: Subject, value: float) -> Content:
    """The car comes to lie along other axes of the frame, and coordinates change places."""
    # At 0 a permutation, unrounded.
    return all_moving(rotation(0, math.sin(value), math.cos(value)), subject)
