"""Numbers that no computation survives, one at a time, at every place of a scene.

A number that is none, infinite, huge or below the smallest normal one must be refused with a reason, or the
answer must be right. Every place of a scene that holds a number is tried, with the other numbers left alone.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any

from validate.hard.case import IF_ANY, REFUSED, RIGHT, RIGHT_OR_REFUSED, Case, Expected, Trial
from validate.hard.cases.links import GROUP, held_apart
from validate.hard.family import BESIDE, SOLVERS, SUBJECTS, Content, Subject
from validate.hard.trial import try_scene

LEAST = math.ulp(0.0)  # 5e-324
Place = tuple[str | int, ...]
Pairs = tuple[tuple[str, str], ...]


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


def with_number(place: Place, number: object, subject: Subject = SUBJECTS[0]) -> Content:
    """The scene with another number at one place."""
    whole = content(subject)
    part: Any = whole
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = number
    return whole


def with_number_at(value: float, number: object, subject: Subject) -> Content:
    """The scene with another number at the place of this number, counted from 1."""
    return with_number(places(subject)[int(value) - 1], number, subject)


def anywhere(value: float, number: object, subject: Subject) -> Trial:
    """Tries a number at the place of a number counted from 1."""
    trial = try_scene(value, with_number_at(value, number, subject), SOLVERS)
    return replace(trial, facts={**trial.facts, "place": told(places(subject)[int(value) - 1])})


@cache
def pairs_of(subject: Subject, apart: bool) -> Pairs:
    """The pairs that cannot be in one place, or all others."""
    held = {frozenset(pair) for pair in held_apart(subject.plain)}
    pairs = itertools.combinations(subject.car.points, 2)
    return tuple(pair for pair in pairs if (frozenset(pair) in held) == apart)


def in_one_place(value: float, pairs: Pairs, subject: Subject) -> Content:
    """The scene with the second point of this pair, counted from 1, put on the first."""
    onto, moved = pairs[int(value) - 1]
    points = {**subject.car.points, moved: subject.car.points[onto]}
    inputs = {**subject.home, "arm_angle": 1.65} if subject.level else subject.home
    return subject.absolute(inputs, replace(subject.car, points=points))


def coincident(value: float, pairs: Pairs, subject: Subject) -> Trial:
    """Tries a car with the points of one pair in one place."""
    onto, moved = pairs[int(value) - 1]
    trial = try_scene(value, in_one_place(value, pairs, subject), SOLVERS)
    return replace(trial, facts={**trial.facts, "place": f"{moved} on {onto}"})


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


def _counted(number: int) -> tuple[float, ...]:
    return tuple(float(n) for n in range(1, number + 1))


def _case(
    name: str,
    why: str,
    examine: Callable[[float], Trial],
    values: tuple[float, ...],
    expected: Expected,
    parameter: str = "number of the place in the scene",
    content: Callable[[float], Content] | None = None,
    sound: Callable[[float], bool] | None = None,
) -> Case:
    behaviour = {REFUSED: "refused, by all", RIGHT: "right, by all"}.get(expected, "right, or refused")
    return Case(
        name=name,
        group=GROUP,
        why=why,
        parameter=parameter,
        values=values,
        expected=dict.fromkeys(SOLVERS, expected),
        behaviour=behaviour,
        examine=examine,
        content=content,
        also_answered=tuple(v for v in values if sound is not None and sound(v)),
    )


NUMBERS: tuple[tuple[str, str, object, Expected], ...] = (
    ("not-a-number", "A NaN spreads through everything that it meets.", math.nan, REFUSED),
    ("infinity", "An infinity makes a NaN of every difference.", math.inf, REFUSED),
    ("minus-infinity", "An infinity of the other sign passes every check for too large.", -math.inf, REFUSED),
    ("huge", "The square of 1e308 overflows.", 1e308, RIGHT_OR_REFUSED),
    ("minus-huge", "The square of -1e308 overflows.", -1e308, RIGHT_OR_REFUSED),
    ("tiny", "The square of 1e-308 is 0.", 1e-308, RIGHT_OR_REFUSED),
    ("denormal", "Below the smallest normal number digits are lost, down to none.", LEAST, RIGHT_OR_REFUSED),
    (
        "whole-number-too-large",
        "A whole number of 401 digits fits no floating-point number.",
        10**400,
        REFUSED,
    ),
)
# Places where such a number leaves an ordinary motion: a phase is taken modulo a turn, and what is small
# beside the rest of the car or of the motion is as good as 0.
PHASE = "inputs.rack.sine.phase"
SMALL = (PHASE, "inputs.heave.table.values.3", "mechanism.points.lower_ball_joint.2")
HARMLESS = {"huge": (PHASE,), "minus-huge": (PHASE,), "tiny": SMALL, "denormal": SMALL}
EVERY_PAIR = "number of the pair of points"


def _is_harmless(value: float, name: str, subject: Subject) -> bool:
    return told(places(subject)[int(value) - 1]) in HARMLESS.get(name, ())


def _cases(subject: Subject) -> tuple[Case, ...]:
    # Of the second car every seventh place or pair must do, of the others one amid them.
    first, second = subject is SUBJECTS[0], bool(subject.level)

    def some(count: int, step: int = 1) -> tuple[float, ...]:
        numbers = _counted(count)
        return numbers[:: 7 ** (not first) * step] if second else numbers[count // 2 : count // 2 + 1]

    suffix, every = subject.suffix, len(places(subject))
    apart, others = pairs_of(subject, True), pairs_of(subject, False)
    return (
        _case(
            f"link-without-length{suffix}",
            "Two points that a link or an axis holds apart are drawn in one place.",
            partial(coincident, pairs=apart, subject=subject),
            _counted(len(apart)) if second else some(len(apart)),
            # Elsewhere two rods may meet in one point of a body, and a crank have no length.
            REFUSED if subject.level else IF_ANY,
            EVERY_PAIR,
        ),
        _case(
            f"points-in-one-place{suffix}",
            "Two points without a link are drawn in one place, which may be a mechanism or not.",
            partial(coincident, pairs=others, subject=subject),
            some(len(others)),
            RIGHT_OR_REFUSED,
            EVERY_PAIR,
            partial(in_one_place, pairs=others, subject=subject),
            lambda value: others[int(value) - 1] in SOUND,
        ),
        *(
            # A scene with a tiny number is solved, which takes time: every third place must do.
            _case(
                f"{name}{suffix}",
                why,
                partial(anywhere, number=number, subject=subject),
                some(every, 3 if name == "tiny" else 1),
                ends,
                # What has to be refused is no scene, and cannot be given to a solver.
                content=None if ends == REFUSED else partial(with_number_at, number=number, subject=subject),
                sound=partial(_is_harmless, name=name, subject=subject),
            )
            for name, why, number, ends in NUMBERS
        ),
    )


CASES: tuple[Case, ...] = (
    *(case for subject in SUBJECTS for case in _cases(subject)),
    _case(
        "points-in-one-place-beside",
        "Of a strut beside its ball joint any two points are drawn in one place, links without length too.",
        partial(coincident, pairs=PAIRS_BESIDE, subject=BESIDE),
        _counted(len(PAIRS_BESIDE)),
        RIGHT_OR_REFUSED,
        EVERY_PAIR,
        partial(in_one_place, pairs=PAIRS_BESIDE, subject=BESIDE),
        lambda value: PAIRS_BESIDE[int(value) - 1] in SOUND,
    ),
)
