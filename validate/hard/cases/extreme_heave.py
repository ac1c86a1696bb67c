"""Heave by a law of every kind, with numbers that no computation survives at each of their places.

Heave drives no coordinate: it is added to what was solved, so that nothing else meets its numbers and
refuses them. What is too large to be added to anything must be refused with a reason.

The reference gives up on a car that is displaced by 1e308 times its size. There it is the reference without
heave, with the law's value, rate and acceleration added along up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.numerics.rounding import EPS
from validate.adjudication.reference_solution import reference_solution
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Solution
from validate.hard.case import REFUSED, RIGHT_OR_REFUSED, Answer, Case, Expected, Trial
from validate.hard.cases.links import GROUP
from validate.hard.classify import judged_answer
from validate.hard.family import SOLVERS, SUBJECTS, Content, Subject, values_of
from validate.hard.trial import solved, try_scene

Array = NDArray[np.float64]

LAWS: dict[str, dict[str, Any]] = {
    "constant": {"constant": 10.0},
    "polynomial": {"polynomial": [10.0, 20.0, 30.0]},
    "sine": {"sine": {"amplitude": 5.0, "angular_frequency": 2.0, "phase": 0.3, "offset": 1.0}},
}
PLACES: tuple[tuple[str, str | int | None], ...] = (
    ("constant", None),
    *(("polynomial", k) for k in range(3)),
    *(("sine", key) for key in ("amplitude", "angular_frequency", "phase", "offset")),
)
EXTREME = (1.2e308, -1.2e308, 1e-308, math.ulp(0.0))
# Their squares, which an acceleration takes, are at the end of the range and beyond it.
FREQUENCIES = (1e100, 1e200)
NOT_FINITE = (math.nan, math.inf, -math.inf)
Tried = tuple[str, str | int | None, float]


def law(kind: str, place: str | int | None, number: float) -> dict[str, Any]:
    """A law with another number at one place."""
    whole = deepcopy(LAWS[kind])
    if place is None:
        whole[kind] = number
    else:
        whole[kind][place] = number
    return whole


def _each(numbers: tuple[float, ...]) -> tuple[Tried, ...]:
    return tuple((*place, number) for place in PLACES for number in numbers)


def content(heave: dict[str, Any] | None, subject: Subject = SUBJECTS[0]) -> Content:
    """A scene in which all inputs move; of body rates and angles heave is no part."""
    effects = ("velocity", "acceleration")
    return subject.content((0.0, 0.1), (0.0, 5.0), heave, stop=0.2, samples=2, effects=effects)


def displaced(trial: Trial, heave: dict[str, Any], subject: Subject = SUBJECTS[0]) -> Trial:
    """The trial, with what the reference could not judge held to that of the car without heave, displaced."""
    if all(answer.outcome != "unjudged" for answer in trial.answers):
        return trial
    scene, plain = (Scene.from_mapping(content(h, subject)) for h in (heave, None))
    law = rates(scene.inputs["heave"], scene.instants)
    reference = added(reference_solution(plain), law, scene.mechanism.up)
    answers = []
    for answer in trial.answers:
        one = solved(answer.formulation, scene) if answer.outcome == "unjudged" else answer
        answers.append(one if isinstance(one, Answer) else judged_answer(scene, one, reference))
    return Trial(trial.value, tuple(answers), {**trial.facts, "reference": "that without heave, displaced"})


def added(home: Solution, heave: Array, up: Sequence[float]) -> Solution:
    """A solution displaced along up by a law's value, rate and acceleration, shape (N, 3)."""
    value, rate, push = (heave[:, k, None] * np.array(up) for k in range(3))
    position = {name: place + value for name, place in home.position.items()}
    velocity = {name: v + rate for name, v in home.velocity.items()}
    acceleration = {name: a + push for name, a in home.acceleration.items()}
    sums = {"position": position, "velocity": velocity, "acceleration": acceleration}
    claims = {
        quantity: _rounded(home.accuracy.claims[quantity], sums[quantity], more)
        for quantity, more in (("position", value), ("velocity", rate), ("acceleration", push))
    }
    return replace(home.with_numbers(sums), accuracy=home.accuracy.with_claims(claims))


def _rounded(claims: Mapping[str, Array], sums: Mapping[str, Array], added: Array) -> dict[str, Array]:
    """What is claimed at home; what is added is rounded once, and so is the sum."""
    return {name: claims[name] + EPS * np.abs(array) + EPS * np.abs(added) for name, array in sums.items()}


def heaved(value: float, every: tuple[Tried, ...], subject: Subject) -> Content:
    """The scene with one of these, counted from 1."""
    return content(law(*every[int(value) - 1]), subject)


def heaving(value: float, every: tuple[Tried, ...], subject: Subject) -> Trial:
    """Tries one of these, counted from 1, while all inputs move."""
    kind, place, number = every[int(value) - 1]
    trial = try_scene(value, heaved(value, every, subject), SOLVERS)
    trial = displaced(trial, law(kind, place, number), subject)
    where = kind if place is None else f"{kind}.{place}"
    return replace(trial, facts={**trial.facts, "place": where, "number": f"{number:g}"})


def _case(name: str, why: str, every: tuple[Tried, ...], expected: Expected, subject: Subject) -> Case:
    values = values_of(subject, [float(n) for n in range(1, len(every) + 1)])
    return Case(
        name=f"{name}{subject.suffix}",
        group=GROUP,
        why=why,
        parameter="number of the place and what stands there",
        values=values,
        expected=dict.fromkeys(SOLVERS, expected),
        behaviour="refused, by all" if expected == REFUSED else "right, or refused with a reason",
        examine=partial(heaving, every=every, subject=subject),
        content=None if expected == REFUSED else partial(heaved, every=every, subject=subject),
        # A phase is taken modulo a turn, and what is small is as good as 0.
        also_answered=tuple(v for v in values if expected != REFUSED and _is_harmless(*every[int(v) - 1])),
    )


def _is_harmless(kind: str, place: str | int | None, number: float) -> bool:
    return place == "phase" or abs(number) < 1.0


CASES: tuple[Case, ...] = tuple(
    _case(name, why, every, expected, subject)
    for subject in SUBJECTS
    if subject.heaves
    for name, why, every, expected in (
        (
            "heave-not-finite",
            "A displacement of the whole car that is no number makes none of every place.",
            _each(NOT_FINITE),
            REFUSED,
        ),
        (
            "heave-huge-or-tiny",
            "Heave meets no constraint that would refuse it, and its rates overflow before it does.",
            (*_each(EXTREME), *(("sine", "angular_frequency", number) for number in FREQUENCIES)),
            RIGHT_OR_REFUSED,
        ),
    )
)
