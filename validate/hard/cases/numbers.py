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

from validate.cars.car import Car
from validate.cars.closed_form import BALL, FRONT, INNER, OUTER, RACK, REAR
from validate.cars.double_wishbone import UPPER_BALL, UPPER_FRONT, UPPER_REAR
from validate.cars.macpherson import BESIDE, ROD_END, TOP
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.cars import BESIDE_CAR, CARS, PAPER_CAR
from validate.hard.case import REFUSED, RIGHT, RIGHT_OR_REFUSED, Case, Expected, Trial
from validate.hard.cases.links import GROUP, links_of
from validate.hard.trial import try_scene

SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
LEAST = math.ulp(0.0)  # 5e-324
SPIN = "wheel_axis_inner"
Place = tuple[str | int, ...]
Content = Callable[[float], dict[str, Any]]


def content(car: str = "paper") -> dict[str, Any]:
    """A short motion of a car with a law of every kind, in which every number has a place."""
    return scene_content(
        CARS[car],
        (SQUARE, 0.1, 0.05),
        {"sine": {"amplitude": 5.0, "angular_frequency": 2.0, "phase": 0.3, "offset": 1.0}},
        {"table": {"times": [0.0, 0.1, 0.2, 0.3], "values": [0.0, 1.0, 3.0, 2.0]}},
        stop=0.2,
        samples=2,
    )


def _places(part: Any, here: Place = ()) -> list[Place]:
    if isinstance(part, dict | list):
        inner = part.items() if isinstance(part, dict) else enumerate(part)
        return [place for key, value in inner for place in _places(value, (*here, key))]
    return [here] if isinstance(part, float | int) and not isinstance(part, bool) else []


@cache
def places(car: str = "paper") -> tuple[Place, ...]:
    """Every place of the scene that holds a number."""
    return tuple(_places(content(car)))


def told(place: Place) -> str:
    """A place in words, such as mechanism.points.strut_top.2."""
    return ".".join(str(key) for key in place)


def with_number(place: Place, number: object, car: str = "paper") -> dict[str, Any]:
    """The scene with another number at one place."""
    whole = content(car)
    part: Any = whole
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = number
    return whole


def everywhere(number: object, car: str = "paper") -> Callable[[float], Trial]:
    """Tries a number at the place of a number counted from 1."""

    def examine(value: float) -> Trial:
        trial = try_scene(value, with_number_at(value, number, car), SOLVERS)
        return replace(trial, facts={**trial.facts, "place": told(places(car)[int(value) - 1])})

    return examine


def with_number_at(value: float, number: object, car: str) -> dict[str, Any]:
    """The scene with another number at the place of this number, counted from 1."""
    return with_number(places(car)[int(value) - 1], number, car)


# A rod without length has no answer in the reference: which way its end lies is not drawn.
PAIRS_BESIDE = tuple(p for p in itertools.combinations(BESIDE, 2) if p != (TOP, ROD_END))
# Pairs that may be in one place in any car: what the knuckle carries is no joint, nor is the rack's middle.
SOUND = (
    (RACK, INNER),
    *((joint, carried) for joint in (BALL, UPPER_BALL, OUTER) for carried in ("wheel_centre", SPIN)),
)
# Pairs that are no link but make a line together.
LINES = ((FRONT, REAR), (UPPER_FRONT, UPPER_REAR))


def linked(first: bool, car: str = "paper") -> tuple[tuple[str, str], ...]:
    """The pairs that cannot be in one place, a link or a line, or all others."""
    apart = {frozenset((link.start, link.end)) for link in links_of(car)} | set(map(frozenset, LINES))
    pairs = itertools.combinations(CARS[car].points, 2)
    return tuple(pair for pair in pairs if (frozenset(pair) in apart) == first)


def coincident(pairs: tuple[tuple[str, str], ...], car: Car = PAPER_CAR) -> Callable[[float], Trial]:
    """Tries a car with the points of one pair in one place: the second is put on the first."""

    def examine(value: float) -> Trial:
        onto, moved = pairs[int(value) - 1]
        trial = try_scene(value, in_one_place(value, pairs, car), SOLVERS)
        return replace(trial, facts={**trial.facts, "place": f"{moved} on {onto}"})

    return examine


def in_one_place(value: float, pairs: tuple[tuple[str, str], ...], car: Car) -> dict[str, Any]:
    """The scene with the points of this pair, counted from 1, in one place."""
    onto, moved = pairs[int(value) - 1]
    return scene_content(replace(car, points={**car.points, moved: car.points[onto]}), 1.65)


def _counted(number: int) -> tuple[float, ...]:
    return tuple(float(n) for n in range(1, number + 1))


def _case(
    name: str,
    why: str,
    examine: Callable[[float], Trial],
    values: tuple[float, ...],
    expected: Expected,
    parameter: str = "number of the place in the scene",
    content: Content | None = None,
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


def _is_harmless(value: float, name: str, car: str) -> bool:
    return told(places(car)[int(value) - 1]) in HARMLESS.get(name, ())


def _cases(suffix: str, car: str) -> tuple[Case, ...]:
    def some(count: int, step: int = 1) -> tuple[float, ...]:
        # Of the second car every seventh place or pair must do.
        return _counted(count)[:: 7 * step if suffix else step]

    every = len(places(car))
    return (
        _case(
            f"link-without-length{suffix}",
            "Two points that a link or an axis holds apart are drawn in one place.",
            coincident(linked(True, car), CARS[car]),
            _counted(len(linked(True, car))),
            REFUSED,
            EVERY_PAIR,
        ),
        _case(
            f"points-in-one-place{suffix}",
            "Two points without a link are drawn in one place, which may be a mechanism or not.",
            coincident(linked(False, car), CARS[car]),
            some(len(linked(False, car))),
            RIGHT_OR_REFUSED,
            EVERY_PAIR,
            partial(in_one_place, pairs=linked(False, car), car=CARS[car]),
            lambda value: linked(False, car)[int(value) - 1] in SOUND,
        ),
        *(
            # A scene with a tiny number is solved, which takes time: every third place must do.
            _case(
                f"{name}{suffix}",
                why,
                everywhere(number, car),
                some(every, 3 if name == "tiny" else 1),
                ends,
                # What has to be refused is no scene, and cannot be given to a solver.
                content=None if ends == REFUSED else partial(with_number_at, number=number, car=car),
                sound=partial(_is_harmless, name=name, car=car),
            )
            for name, why, number, ends in NUMBERS
        ),
    )


CASES: tuple[Case, ...] = (
    *_cases("", "paper"),
    _case(
        "points-in-one-place-beside",
        "Of a strut beside its ball joint any two points are drawn in one place, links without length too.",
        coincident(PAIRS_BESIDE, BESIDE_CAR),
        _counted(len(PAIRS_BESIDE)),
        RIGHT_OR_REFUSED,
        EVERY_PAIR,
        partial(in_one_place, pairs=PAIRS_BESIDE, car=BESIDE_CAR),
        lambda value: PAIRS_BESIDE[int(value) - 1] in SOUND,
    ),
    *_cases("-wishbone", "wishbone"),
)
