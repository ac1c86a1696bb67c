"""Cars rotated as a whole: the mechanism is unchanged, and no axis of the frame may matter."""

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
