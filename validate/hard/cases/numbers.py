"""Invalid and extreme numbers, one at a time, at every place of a scene; and coincident points.

With a NaN, an infinite, huge or subnormal number the scene must be refused with a reason, or the answer must
be right. Every number of a scene is replaced in turn. Heave is run with every kind of law: it drives no
coordinate but is added to the solution, so no other check meets its numbers.
"""

from __future__ import annotations

import itertools
import math
from copy import deepcopy
from dataclasses import replace
from functools import cache, partial
from typing import Any

from validate.hard.case import IF_ANY, REFUSED, RIGHT_OR_REFUSED, Case, Setup, family, numbers_of
from validate.hard.cases.links import GROUP, held_apart
from validate.hard.subjects import LEVEL, Content, Subject

Place = tuple[str | int, ...]
SINE = {"sine": {"amplitude": 5.0, "angular_frequency": 2.0, "phase": 0.3, "offset": 1.0}}
TABLE = {"table": {"times": [0.0, 0.1, 0.2, 0.3], "values": [0.0, 1.0, 3.0, 2.0]}}
OF_HEAVE = (SINE, {"polynomial": [10.0, 20.0, 30.0]}, {"constant": 10.0})
CASES: list[Case] = []


def pairs(held: bool, subject: Subject) -> list[tuple[str, str]]:
    """Pairs of drawn points that a link or an axis keeps at a distance; or the pairs without a link."""
    links = {frozenset(pair) for pair in held_apart(subject)}
    every = itertools.combinations(subject.car.points, 2)
    return [pair for pair in every if (frozenset(pair) in links) is held]


def in_one_place(held: bool, subject: Subject, value: float) -> Setup:
    """The scene with the second point of a pair moved onto the first."""
    onto, moved = pairs(held, subject)[int(value) - 1]
    car = replace(subject.car, points={**subject.car.points, moved: subject.car.points[onto]})
    inputs = {**subject.home, "arm_angle": 1.65} if subject.home is LEVEL else subject.home
    return Setup(subject.absolute(inputs, car), {"place": f"{moved} on {onto}"})


_pairs = partial(family, CASES, GROUP, "number of the pair of points")
_pairs(
    numbers_of(partial(pairs, True)),
    # In other mechanisms two rods may meet at one point of a body, and a crank may have no length.
    lambda one: REFUSED if one.home is LEVEL else IF_ANY,
    given=False,
    name="link-without-length",
    why="Two points that a link or an axis keeps at a distance are drawn in one place.",
)(partial(in_one_place, True))
_pairs(
    numbers_of(partial(pairs, False)),
    RIGHT_OR_REFUSED,
    step=3,
    name="points-in-one-place",
    why="Two points without a link are drawn in one place; the result may be a mechanism or not.",
)(partial(in_one_place, False))


def content(subject: Subject, heave: Content = TABLE) -> Content:
    """A short motion of a car with a law of every kind."""
    law = heave if "heave" in subject.inputs else None
    return deepcopy(subject.content((0.0, 0.1, 0.05), SINE, law, stop=0.2, samples=2))


def _places(part: Any, here: Place = ()) -> list[Place]:
    if isinstance(part, dict | list):
        inner = part.items() if isinstance(part, dict) else enumerate(part)
        return [place for key, value in inner for place in _places(value, (*here, key))]
    return [here] if isinstance(part, float | int) and not isinstance(part, bool) else []


@cache
def places(subject: Subject) -> list[tuple[Content, Place]]:
    """Every place of a number in the scene, and in the scene with every other law of heave, with this law."""
    return [
        (law, place)
        for law in (TABLE, *OF_HEAVE)
        for place in _places(content(subject, law))
        if law is TABLE or place[:2] == ("inputs", "heave")
    ]


def with_number(number: object, subject: Subject, value: float) -> Setup:
    """The scene with the number at one place replaced; the place in words: mechanism.points.strut_top.2."""
    heave, place = places(subject)[int(value) - 1]
    whole = content(subject, heave)
    part: Any = whole
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = number
    return Setup(whole, {"place": ".".join(map(str, place))})


# Name, number, expected outcome, why, and step between places: scenes that are mostly solved take time.
for name, number, expected, why, step in (
    ("not-a-number", math.nan, REFUSED, "A NaN spreads through all computations.", 1),
    ("minus-infinity", -math.inf, REFUSED, "It passes every check for too large numbers.", 1),
    ("huge", 1e308, RIGHT_OR_REFUSED, "The square of 1e308 overflows.", 3),
    ("tiny", 1e-308, RIGHT_OR_REFUSED, "The square of 1e-308 is 0.", 3),
    ("whole-number-too-large", 10**400, REFUSED, "A number of 401 digits is no floating-point number.", 1),
):
    # A scene that must be refused cannot be given to other solvers.
    family(
        *(CASES, GROUP, "number of the place in the scene", numbers_of(places), expected),
        name=name,
        why=why,
        step=step,
        given=expected != REFUSED,
    )(partial(with_number, number))
