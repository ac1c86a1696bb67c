"""Cars turned as a whole, which changes nothing about their mechanism: no axis of the frame is preferred."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from validate.cars.car import any_rotation, rotation, turned
from validate.hard.cars import Array
from validate.hard.case import HARD, IF_ANY, RIGHT, family
from validate.hard.subjects import ROLLING, SUBJECTS, Content, Subject

Turn = Callable[[float], Array]


def quarter_turn_less(value: float) -> Array:
    """The turn by 90 degrees less `value` rad about the x axis; at 0 a permutation, unrounded."""
    return rotation(0, math.sin(value), math.cos(value))


def seeded(number: float) -> Array:
    """The random turn of a number."""
    return any_rotation(int(number))


def all_moving(turn: Turn, subject: Subject, value: float) -> Content:
    """All inputs move, with all rates."""
    return subject.content([-0.1, 0.4], [0.0, 40.0], car=turned(subject.car, turn(value)), stop=0.5)


# Of Bricard's ring, turned, the reference finds no proof.
_turned = partial(family, expected=lambda one: IF_ANY if one.name in HARD else RIGHT, group="Turned cars")

CASES = (
    *_turned(
        *(partial(all_moving, seeded), "number of a random rotation", (1.0, 7.0, 12.0)),
        subjects=(*SUBJECTS, ROLLING),
        name="turned-at-random",
        why="No axis of the car lies along an axis of the frame, so nothing cancels by chance.",
    ),
    *_turned(
        partial(all_moving, quarter_turn_less),
        "90 degrees about x less this, rad; then exactly 90",
        (1e-1, 1e-8, 0.0),
        name="quarter-turn-about-x",
        why="The car comes to lie along other axes of the frame, and coordinates change places.",
    ),
)
