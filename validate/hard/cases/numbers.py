"""Numbers that no computation survives, one at a time, at every place of a scene.

A number that is none, infinite, huge or below the smallest normal one must be refused with a reason, or the
answer must be right. Every place of a scene that holds a number is tried, with the other numbers left alone.

Heave is tried by a law of every kind. It drives no coordinate: it is added to what was solved, so that
nothing else meets its numbers and refuses them. The reference gives up on a car that is displaced by 1e308
times its size. There it is the reference without heave, with the law's value, rate and acceleration added
along up.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import replace
from functools import cache, partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.numerics.rounding import EPS
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import reference_solution
from validate.hard.case import IF_ANY, REFUSED, RIGHT_OR_REFUSED, Case, Expected, Values, counted, values_of
from validate.hard.case import case as case_of
from validate.hard.cases.links import GROUP, held_apart
from validate.hard.subjects import BESIDE, HEAVING, SUBJECTS, Content, Subject
from validate.hard.trial import Trial, compared, solved

Array = NDArray[np.float64]
LEAST = math.ulp(0.0)  # 5e-324
Place = tuple[str | int, ...]
Pair = tuple[str, str]
Heave = tuple[Place, float]
One = TypeVar("One")


def _numbered(
    subject: Subject,
    name: str,
    why: str,
    parameter: str,
    every: Sequence[One],
    scene: Callable[[Subject, One], Content],
    expected: Expected,
    facts: Callable[[One], dict[str, str]],
    *,
    values: Values = (),
    given: bool = True,
    is_harmless: Callable[[One], bool] = lambda _: False,
    judged: Callable[[Subject, One, Trial], Trial] = lambda _, __, trial: trial,
) -> Case:
    """A case whose parameter counts things that may be in a scene, from 1.

    Args:
        values: the numbers that are tried; as a family has it if not given.
        is_harmless: whether a scene with one of them has an answer although it may be refused.
    """

    def at(value: float) -> One:
        return every[int(value) - 1]

    values = values or values_of(subject, counted(len(every)))
    return case_of(
        lambda one, value: scene(one, at(value)),
        parameter,
        values,
        expected,
        subject,
        name=name,
        why=why,
        group=GROUP,
        judged=lambda one, value, trial: judged(one, at(value), trial).noting(facts(at(value))),
        given=given,
        also_answered=tuple(v for v in values if given and is_harmless(at(v))),
    )


def _some(subject: Subject, every: Sequence[Any], first: int = 0, step: int = 1) -> Values:
    """Every number of the strut, or each of a step; a seventh of these of the wishbone."""
    step *= 1 if subject is SUBJECTS[0] else 7
    return counted(len(every))[first::step] if subject.level else ()


def content(subject: Subject = SUBJECTS[0]) -> Content:
    """A short motion of a car with a law of every kind, in which every number has a place."""
    return subject.content(
        (0.0, 0.1, 0.05),
        {"sine": {"amplitude": 5.0, "angular_frequency": 2.0, "phase": 0.3, "offset": 1.0}},
        {"table": {"times": [0.0, 0.1, 0.2, 0.3], "values": [0.0, 1.0, 3.0, 2.0]}}
        if subject.heaves
        else None,
        stop=0.2,
        samples=2,
    )


def _places(part: Any, here: Place = ()) -> list[Place]:
    if isinstance(part, dict | list):
        inner = part.items() if isinstance(part, dict) else enumerate(part)
        return [place for key, value in inner for place in _places(value, (*here, key))]
    return [here] if isinstance(part, float | int) and not isinstance(part, bool) else []


@cache
def places(subject: Subject = SUBJECTS[0]) -> tuple[Place, ...]:
    """Every place of the scene that holds a number."""
    return tuple(_places(content(subject)))


def told(place: Place) -> str:
    """A place in words, such as mechanism.points.strut_top.2."""
    return ".".join(str(key) for key in place)


def with_number(whole: Content, place: Place, number: object) -> Content:
    """A scene, or a part of one, with another number at one place, where it is changed."""
    part: Any = whole
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = number
    return whole


# Name, the number, what has to come of it, why.
NUMBERS: tuple[tuple[str, object, Expected, str], ...] = (
    ("not-a-number", math.nan, REFUSED, "A NaN spreads through everything that it meets."),
    ("infinity", math.inf, REFUSED, "An infinity makes a NaN of every difference."),
    ("minus-infinity", -math.inf, REFUSED, "An infinity of the other sign passes every check for too large."),
    ("huge", 1e308, RIGHT_OR_REFUSED, "The square of 1e308 overflows."),
    ("minus-huge", -1e308, RIGHT_OR_REFUSED, "The square of -1e308 overflows."),
    ("tiny", 1e-308, RIGHT_OR_REFUSED, "The square of 1e-308 is 0."),
    ("denormal", LEAST, RIGHT_OR_REFUSED, "Below the smallest normal number digits are lost, down to none."),
    (
        "whole-number-too-large",
        10**400,
        REFUSED,
        "A whole number of 401 digits fits no floating-point number.",
    ),
)
# Places where such a number leaves an ordinary motion: a phase is taken modulo a turn, and what is small
# beside the rest of the car or of the motion is as good as 0.
# Scenes with such a number are mostly solved, which takes time: each is tried at every third place.
THIRDS = {"tiny": (0, 3), "minus-huge": (1, 3), "denormal": (2, 3)}
PHASE = "inputs.rack.sine.phase"
SMALL = (PHASE, "inputs.heave.table.values.3", "mechanism.points.lower_ball_joint.2")
HARMLESS = {"huge": (PHASE,), "minus-huge": (PHASE,), "tiny": SMALL, "denormal": SMALL}


def _number_case(subject: Subject, name: str, number: object, expected: Expected, why: str) -> Case:
    return _numbered(
        subject,
        name,
        why,
        "number of the place in the scene",
        places(subject),
        lambda one, place: with_number(content(one), place, number),
        expected,
        lambda place: {"place": told(place)},
        values=_some(subject, places(subject), *THIRDS.get(name, ())),
        # What has to be refused is no scene, and cannot be given to a solver.
        given=expected != REFUSED,
        is_harmless=lambda place: told(place) in HARMLESS.get(name, ()),
    )


# A rod without length has no answer in the reference: which way its end lies is not drawn.
PAIRS_BESIDE = tuple(
    pair for pair in itertools.combinations(BESIDE.car.points, 2) if pair != ("strut_top", "strut_rod_end")
)
# Pairs that may be in one place in any car: what the knuckle carries is no joint, nor is the rack's middle.
SOUND = (
    ("rack_centre", "tie_rod_inner"),
    *itertools.product(
        ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer"), ("wheel_centre", "wheel_axis_inner")
    ),
)


def in_one_place(subject: Subject, pair: Pair) -> Content:
    """The scene with the second point of a pair put on the first."""
    onto, moved = pair
    points = {**subject.car.points, moved: subject.car.points[onto]}
    inputs = {**subject.home, "arm_angle": 1.65} if subject.level else subject.home
    return subject.absolute(inputs, replace(subject.car, points=points))


def _pair_case(
    subject: Subject,
    name: str,
    why: str,
    pairs: Sequence[Pair],
    expected: Expected = RIGHT_OR_REFUSED,
    **more: Any,
) -> Case:
    return _numbered(
        subject,
        name,
        why,
        "number of the pair of points",
        pairs,
        in_one_place,
        expected,
        lambda pair: {"place": "{1} on {0}".format(*pair)},
        is_harmless=lambda pair: pair in SOUND,
        **more,
    )


def _cases(subject: Subject) -> Iterator[Case]:
    held = {frozenset(pair) for pair in held_apart(subject.plain)}
    pairs = tuple(itertools.combinations(subject.car.points, 2))
    apart, loose = (
        tuple(pair for pair in pairs if (frozenset(pair) in held) == wanted) for wanted in (True, False)
    )
    yield _pair_case(
        subject,
        "link-without-length",
        "Two points that a link or an axis holds apart are drawn in one place.",
        apart,
        # Elsewhere two rods may meet in one point of a body, and a crank have no length.
        REFUSED if subject.level else IF_ANY,
        values=counted(len(apart)) if subject.level else (),
        given=False,
    )
    why = "Two points without a link are drawn in one place, which may be a mechanism or not."
    yield _pair_case(subject, "points-in-one-place", why, loose, values=_some(subject, loose))
    for row in NUMBERS:
        yield _number_case(subject, *row)


# Heave by a law of every kind, and every place of each.
LAWS: dict[str, dict[str, Any]] = {
    "constant": {"constant": 10.0},
    "polynomial": {"polynomial": [10.0, 20.0, 30.0]},
    "sine": {"sine": {"amplitude": 5.0, "angular_frequency": 2.0, "phase": 0.3, "offset": 1.0}},
}


def law(place: Place, number: float) -> dict[str, Any]:
    """A law with another number at one place; the first key of that is its kind."""
    kind = str(place[0])
    return with_number(deepcopy(LAWS[kind]), place, number)


def _each(numbers: Sequence[float]) -> tuple[Heave, ...]:
    return tuple((place, n) for kind in LAWS for place in _places(LAWS[kind]) for n in numbers)


def heaved(heave: dict[str, Any] | None, subject: Subject = SUBJECTS[0]) -> Content:
    """A scene in which all inputs move; of body rates and angles heave is no part."""
    effects = ("velocity", "acceleration")
    return subject.content((0.0, 0.1), (0.0, 5.0), heave, stop=0.2, samples=2, effects=effects)


def displaced(trial: Trial, heave: dict[str, Any], subject: Subject = SUBJECTS[0]) -> Trial:
    """The trial, with what the reference could not judge held to that of the car without heave, displaced."""
    if all(answer.outcome != "unjudged" for answer in trial.answers):
        return trial
    scene, plain = (Scene.from_mapping(heaved(h, subject)) for h in (heave, None))
    law = rates(scene.inputs["heave"], scene.instants)
    reference = added(reference_solution(plain), law, scene.mechanism.up)
    answers = tuple(
        compared(scene, one.formulation, solved(one.formulation, scene), reference)
        if one.outcome == "unjudged"
        else one
        for one in trial.answers
    )
    return replace(trial, answers=answers).noting({"reference": "that without heave, displaced"})


def added(home: Solution, heave: Array, up: Sequence[float]) -> Solution:
    """A solution displaced along up by a law's value, rate and acceleration, shape (N, 3).

    What is added is rounded once, and so is the sum.
    """
    numbers: dict[str, dict[str, Array]] = {}
    claims: dict[str, dict[str, Array]] = {}
    for quantity, size in zip(("position", "velocity", "acceleration"), heave.T, strict=True):
        away, claimed = size[:, None] * np.array(up), home.accuracy.claims[quantity]
        numbers[quantity] = {name: array + away for name, array in home.numbers[quantity].items()}
        claims[quantity] = {
            name: claimed[name] + EPS * np.abs(array) + EPS * np.abs(away)
            for name, array in numbers[quantity].items()
        }
    return replace(home.with_numbers(numbers), accuracy=home.accuracy.with_claims(claims))


_heave_case = partial(
    _numbered,
    parameter="number of the place and what stands there",
    scene=lambda subject, heave: heaved(law(*heave), subject),
    facts=lambda heave: {"place": told(heave[0]), "number": f"{heave[1]:g}"},
    judged=lambda subject, heave, trial: displaced(trial, law(*heave), subject),
    # A phase is taken modulo a turn, and what is small is as good as 0.
    is_harmless=lambda heave: heave[0][-1] == "phase" or abs(heave[1]) < 1.0,
)
NO_NUMBER = "A displacement of the whole car that is no number makes none of every place."
OVERFLOWS = "Heave meets no constraint that would refuse it, and its rates overflow before it does."
NOT_FINITE = _each((math.nan, math.inf, -math.inf))
# The squares of the frequencies, which an acceleration takes, are at the end of the range and beyond it.
HUGE_OR_TINY = (
    *_each((1.2e308, -1.2e308, 1e-308, LEAST)),
    *((("sine", "angular_frequency"), number) for number in (1e100, 1e200)),
)

CASES = (
    *(case for subject in SUBJECTS for case in _cases(subject)),
    _pair_case(
        *(BESIDE, "points-in-one-place"),
        "Of a strut beside its ball joint two points are drawn in one place, links without length too.",
        PAIRS_BESIDE,
        values=counted(len(PAIRS_BESIDE))[::3],
    ),
    *(
        case
        for one in HEAVING
        for case in (
            _heave_case(one, "heave-not-finite", NO_NUMBER, every=NOT_FINITE, expected=REFUSED, given=False),
            _heave_case(one, "heave-huge-or-tiny", OVERFLOWS, every=HUGE_OR_TINY, expected=RIGHT_OR_REFUSED),
        )
    ),
)
