"""Cars far from the origin, and very small and very large cars.

The error has to grow with the size of the mechanism, not with its distance from the origin. The paper's
hardpoints are whole millimetres, so a shift by whole millimetres is exact, and so is a scale by a power of
two: nothing changes but the place or the unit. The car at home says what a rate may be off by far away.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.cars.car import moved, scaled
from validate.formulations.protocol import Accuracy, Solution
from validate.hard.answer import Answer, judged_answer
from validate.hard.cars import SQUARE
from validate.hard.case import RIGHT, Expected, case, decades, family, values_of
from validate.hard.subjects import ALL, BESIDE, HEAVING, SUBJECTS, WISHBONE, Content, Subject
from validate.hard.trial import Trial, solved

Array = NDArray[np.float64]

AWAY = (1.0, -1.0, 3.0)
# A model subtracts an origin of its own that lies within a few sizes of the car, wherever the car is: its
# own coordinates are up to 8 sizes instead of 1, and rounded so much more coarsely.
PLACED = 8.0
# A car at home may happen to be off by less than another by this factor: errors of a few roundings each.
LUCKY = 16.0
SIZES = (1e4, 1e2, 1e-1, 1e-3, 1e-6)
RATES = tuple(quantity for quantity in QUANTITIES if quantity != "position")

# From home, rad and mm over s: from 1.5 rad where that is a right angle.
RAD, MM = (1.5 - SQUARE, 0.25, 0.125), (0.0, 30.0, 10.0)
# Beyond 1e9 mm a millimetre is less than one part in 1e9: a model may decline to take that for a drawing.
NEARER = Expected(("right", "refused"), right_from=1e-9)


def moved_car(distance: float, subject: Subject = SUBJECTS[0]) -> Content:
    """A car in motion, its origin some whole millimetres away."""
    return subject.content(RAD, MM, car=moved(subject.car, distance * np.array(AWAY)), stop=0.4)


@cache
def at_home(name: str, subject: Subject) -> Solution:
    """A formulation's solution of the car at home."""
    solution = solved(name, Scene.from_mapping(moved_car(0.0, subject)))
    assert isinstance(solution, Solution)  # nothing about it is hard
    return solution


def far_from_the_origin(subject: Subject, value: float) -> Content:
    """Far from the origin coordinates keep few digits of the car, and differences lose more."""
    return moved_car(1.0 / value, subject)


def as_at_home(subject: Subject, value: float, trial: Trial) -> Trial:
    """The trial of a moved car, each rate held to what the car at home may be off by."""
    answers = (_as_at_home(a, trial, subject) if a.outcome == "right" else a for a in trial.answers)
    return replace(trial, answers=tuple(answers))


def _as_at_home(answer: Answer, trial: Trial, subject: Subject) -> Answer:
    """An answer that is right by its own bounds, compared by those that the car has at home as well.

    Positions are allowed one rounding of a far coordinate more; then they are taken as true, and rates and
    angles are allowed nothing more than at home.
    """
    scene, solution, reference = trial.scene, trial.came[answer.formulation], trial.reference
    home = at_home(answer.formulation, subject)
    # Else it would not be right.
    assert scene is not None
    assert isinstance(solution, Solution)
    assert isinstance(reference, Solution)
    places, near = solution.position, home.position
    farthest, nearest = (max(float(np.abs(p).max()) for p in q.values()) for q in (places, near))
    for away, position in ((farthest, places), (nearest, reference.position)):
        strict = replace(
            solution.with_numbers({"position": position}), accuracy=_held_to(home.accuracy, EPS * away)
        )
        judged = judged_answer(scene, strict, reference)
        if judged.outcome != "right":
            reason = f"by the bounds of the car at home: {judged.reason}"
            return replace(answer, outcome="wrong", reason=reason)
    return answer


def _held_to(home: Accuracy, rounding: float) -> Accuracy:
    """What a car may be off by that is off by as much at home, with a rounding of its positions."""

    def widened(quantity: str, more: float) -> dict[str, Array]:
        claims = home.claims[quantity]
        largest = max(float(np.max(claim)) for claim in claims.values())
        return {name: np.full_like(claim, PLACED * LUCKY * largest + more) for name, claim in claims.items()}

    rates = {quantity: widened(quantity, 0.0) for quantity in RATES if home.claims.get(quantity)}
    return replace(home, claims={"position": widened("position", rounding), **rates})


def scaled_car(subject: Subject, scale: float) -> Content:
    """A car in motion, all lengths multiplied."""
    there, lengths = scaled(subject.car, scale), tuple(scale * x for x in MM)
    return subject.content(RAD, lengths, car=there, scale=scale, tolerance=1e-9 * scale, stop=0.4)


def far_and_heaved_back(subject: Subject, value: float) -> Content:
    """Drawn far up and heaved back, a car comes to stand near the origin by two far coordinates."""
    distance = 1.0 / value
    there = moved(subject.car, distance * np.array(subject.car.up))
    return subject.content(RAD, MM, (-distance, 20.0), car=there, stop=0.4)


WHYS = {
    BESIDE: "The same with the strut's axis beside the ball joint: one more difference of places.",
    WISHBONE: "The same of a double wishbone, whose knuckle has no direction of its own.",
}
TWOS = "Squares of small and large lengths differ by twice as many decades as the lengths."
TENS = f"{TWOS[:-1]}, and every coordinate is rounded anew."
GROUP = "Far from the origin, and mixed sizes"
_far = partial(family, group=GROUP)

CASES = (
    *(
        case(
            far_from_the_origin,
            "1 mm over the distance along x; thrice as far along z",
            values_of(subject, decades()),
            {"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER},
            subject,
            group=GROUP,
            why=WHYS.get(subject, ""),
            judged=as_at_home,
        )
        for subject in (ALL[0], BESIDE, *ALL[1:])
    ),
    *_far(
        far_and_heaved_back,
        "1 mm over the distance along up, which the heave cancels",
        decades(-9),
        subjects=HEAVING,
    ),
    *(
        one
        for name, why, values, subjects in (
            ("sizes-by-powers-of-two", TWOS, tuple(2.0**k for k in (11, 2, -4, -10, -19)), SUBJECTS[:1]),
            ("sizes-by-powers-of-ten", TENS, SIZES, SUBJECTS[:1]),
            ("sizes", TENS, SIZES, (BESIDE, *ALL[1:])),
        )
        for one in _far(
            *(scaled_car, "size, in parts of a car of some 500 mm", values),
            subjects=subjects,
            name=name,
            why=why,
        )
    ),
)
