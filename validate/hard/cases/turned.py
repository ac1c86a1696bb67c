"""Cars turned as a whole, which changes nothing about their mechanism: no axis of the frame is preferred."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from validate.cars.car import any_rotation, rotation, turned
from validate.hard.cars import Array
from validate.hard.case import RIGHT, Case, decades
from validate.hard.family import OF_PARTS, SUBJECTS, Content, Subject, family

AXES = "xyz"
NEAR, SEEDS = (*decades(-12, -1), 0.0), tuple(float(seed) for seed in range(1, 13))


def quarter_turn_less(axis: int, value: float) -> Array:
    """The turn by 90 degrees less `value` rad about a coordinate axis; at 0 a permutation, unrounded."""
    return rotation(axis, math.sin(value), math.cos(value))


def _moving(turn: Callable[[float], Array], subject: Subject, value: float) -> Content:
    """All inputs move, with all rates."""
    return subject.content([-0.1, 0.4], [0.0, 40.0], car=turned(subject.car, turn(value)), stop=0.5)


def _cases(
    name: str,
    why: str,
    parameter: str,
    values: tuple[float, ...],
    turn: Callable[[float], Array],
    subjects: tuple[Subject, ...] = SUBJECTS,
) -> tuple[Case, ...]:
    return family(
        name=name,
        group="Turned cars",
        why=why,
        parameter=parameter,
        values=values,
        scene=partial(_moving, turn),
        expected=RIGHT,
        behaviour="right however the car is turned",
        subjects=subjects,
    )


CASES: tuple[Case, ...] = (
    *(
        case
        for axis, letter in enumerate(AXES)
        for case in _cases(
            f"quarter-turn-about-{letter}",
            "the car comes to lie along other axes of the frame, and coordinates change places",
            f"90 degrees about {letter} less this, rad; then exactly 90",
            NEAR,
            partial(quarter_turn_less, axis),
        )
    ),
    *_cases(
        "turned-at-random",
        "no axis of the car lies along an axis of the frame, so nothing cancels by chance",
        "number of a random rotation",
        SEEDS,
        lambda seed: any_rotation(int(seed)),
        (*SUBJECTS, *OF_PARTS),
    ),
)
