"""Links that are missing, given twice or contradictory: each case changes a mechanism's tables in one way.

The changed mechanism has no pose, or the inputs do not determine its pose. It must be refused before any
number is given; pointcoord must name the fault. A rod that is given twice constrains no more than one rod: a
model may leave the second out and answer, or refuse it. Two constraints of one coordinate that agree in the
drawing and nowhere else leave no motion, however close they are.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from pointcoord import Scene
from validate.cars.car import Car, Point, as_tuple, content_of
from validate.hard.answer import Answer, Trial
from validate.hard.case import IF_ANY, REFUSED, Case, Setup, decades, family, numbers_of, right_from
from validate.hard.subjects import ALL, Subject

GROUP = "Links and numbers that make no mechanism"
SOLVERS = ("pointcoord", "absolute")
MUST_REFUSE, MAY_ANSWER = dict.fromkeys(SOLVERS, REFUSED), dict.fromkeys(SOLVERS, IF_ANY)
AGAIN, PIVOT = "again", "second_pivot"
Tables = dict[str, Any]
CASES: list[Case] = []
_links = partial(family, CASES, GROUP, given=False)


@dataclass(frozen=True)
class Piece:
    """A constraint of a mechanism: a rod, a slide, or a point that joins a body to others.

    Attributes:
        words: `rod tie_rod`, or `tie_rod_outer of knuckle`.
        names: an error must give one of these names if the piece is missing.
        rows: the number of rods that constrain as much.
        tables: the mechanism's tables without the piece.
    """

    words: str
    names: frozenset[str]
    rows: int
    tables: Tables


def joints(plain: Mapping[str, Any]) -> dict[str, list[str]]:
    """The points of each moving body that another body, a rod or a slide uses too."""
    slides = plain["slides"].values()
    users = [*plain["bodies"].values(), *plain["rods"].values()]
    users += [(*slide["points"], slide["through"]) for slide in slides]
    lines = {slide["along"] for slide in slides}
    return {
        body: [name for name in points if name in lines or sum(name in user for user in users) > 1]
        for body, points in plain["bodies"].items()
        if body != "chassis"
    }


@cache
def pieces(subject: Subject) -> list[Piece]:
    """The constraints of a mechanism."""
    plain, found = subject.plain, list[Piece]()
    bodies = plain["bodies"]
    for rod, ends in plain["rods"].items():
        tables = tables_of(subject)
        del tables["rods"][rod]
        found.append(Piece(f"rod {rod}", frozenset((rod, *ends)), 1, tables))
    for name, slide in plain["slides"].items():
        tables, points = tables_of(subject), slide["points"]
        del tables["slides"][name]
        found.append(Piece(f"slide {name}", frozenset((name, *points)), 2 * len(points), tables))
    for body, points in joints(plain).items():
        shared = [set(other) & set(bodies[body]) for name, other in bodies.items() if name != body]
        for point in points:
            tables, hinged = tables_of(subject), any(len(both) == 2 and point in both for both in shared)
            tables["bodies"][body].remove(point)
            names = frozenset((body, *bodies[body]))
            found.append(Piece(f"{point} of {body}", names, 2 if hinged else 3, tables))
    return found


def exchangeable(subject: Subject) -> list[Piece]:
    """The pieces without which at least one rod is left."""
    return [piece for piece in pieces(subject) if piece.tables["rods"]]


def held_apart(subject: Subject) -> list[tuple[str, str]]:
    """Pairs of points at a fixed distance: joints of a moving body, and the ends of a rod."""
    plain = subject.plain
    rods = ((first, last) for first, last in plain["rods"].values())
    within = (pair for points in joints(plain).values() for pair in itertools.combinations(points, 2))
    return list({frozenset(pair): pair for pair in (*within, *rods)}.values())


def tables_of(subject: Subject) -> Tables:
    """A copy of the mechanism's tables that may be changed."""
    plain = subject.plain
    parts = {part: {"side": side} for part, side in plain.get("sides", {}).items()}
    return {name: plain[name] for name in ("bodies", "rods", "slides", "inputs", "roles")} | {"parts": parts}


@cache
def closed(subject: Subject) -> Car:
    """The car with a closed drawing and all its points given, so that its tables can be changed."""
    car = subject.assembled
    scene = Scene.from_mapping(subject.absolute(dict.fromkeys(subject.driven, 0.0), car))
    points = scene.mechanism.plain(subject.driven)["points"]
    return replace(car, points={name: tuple(place) for name, place in points.items()}, closure="drawn")


def changed(
    subject: Subject,
    tables: Tables,
    names: Iterable[str] = (),
    facts: Mapping[str, str] | None = None,
    inputs: Mapping[str, Any] | None = None,
    points: Mapping[str, Point] | None = None,
) -> Setup:
    """The scene of a mechanism with changed tables and further points; inputs as drawn if not given.

    Args:
        names: an error of pointcoord must give one of these, if there are any.
    """
    car = closed(subject)
    there = replace(car, points={**car.points, **(points or {})}, tables=tables)
    laws = {n: law for n, law in (inputs or subject.drawn).items() if n in tables["inputs"]}
    content = content_of(there, laws, stop=0.1, samples=2, effects=("velocity",))
    return Setup(content, facts or {}, partial(must_name, frozenset(names)))


def must_name(names: frozenset[str], _: Trial, answer: Answer) -> Answer:
    """A refusal by pointcoord that gives none of the names is wrong; other answers are unchanged."""
    given = not names or any(name in answer.reason for name in names)
    if given or (answer.formulation, answer.outcome) != ("pointcoord", "refused"):
        return answer
    reason = f"names none of {', '.join(sorted(names))}: {answer.reason}"
    return replace(answer, outcome="wrong", reason=reason)


PIECE = "number of the piece"
PIVOT_AT = "distance of its pivot from the first pivot, in parts of the first link"
WITH_RODS = [subject for subject in ALL if subject.plain["rods"]]


@_links(PIECE, numbers_of(pieces), MUST_REFUSE, ALL)
def link_missing(subject: Subject, number: float) -> Setup:
    """A constraint is missing: a point or a body can move although all inputs are held."""
    piece = pieces(subject)[int(number) - 1]
    return changed(subject, piece.tables, piece.names, {"missing": piece.words})


@_links("number of the pair of points that are held apart", numbers_of(held_apart), MAY_ANSWER, ALL)
def link_twice(subject: Subject, number: float) -> Setup:
    """There are more equations than unknowns, and two of them are equivalent.

    An additional rod joins two points that are already at a fixed distance.
    """
    pair, tables = held_apart(subject)[int(number) - 1], tables_of(subject)
    tables["rods"][AGAIN] = list(pair)
    return changed(subject, tables, (AGAIN, *pair, *subject.driven), {"twice": " - ".join(pair)})


@_links(PIECE, numbers_of(exchangeable), MUST_REFUSE, [one for one in ALL if exchangeable(one)])
def link_twice_for_another(subject: Subject, number: float) -> Setup:
    """There are as many equations as unknowns, but some are redundant and some are missing.

    A piece is removed, and a rod is repeated to make up for the number of its equations.
    """
    piece = exchangeable(subject)[int(number) - 1]
    rod, ends = next(iter(piece.tables["rods"].items()))
    more = {f"{AGAIN}_{k}": list(ends) for k in range(piece.rows)}
    tables = {**piece.tables, "rods": {**piece.tables["rods"], **more}}
    return changed(subject, tables, piece.names | {rod, AGAIN}, {"twice": rod, "missing": piece.words})


@_links("difference of their values, rad or mm", (*decades(), 0.0), MUST_REFUSE, WITH_RODS)
def input_twice(subject: Subject, gap: float) -> Setup:
    """Two inputs drive one coordinate and contradict each other, by less and less until they agree."""
    tables, first = tables_of(subject), subject.driven[0]
    tables["inputs"][AGAIN] = dict(tables["inputs"][first])
    return changed(
        subject, tables, (AGAIN, first), inputs={**subject.drawn, AGAIN: subject.drawn[first] + gap}
    )


def with_third_link(subject: Subject, share: float) -> tuple[Tables, dict[str, Point]]:
    """A rod next to a link from the chassis to a moving point, its pivot a share of the length above."""
    tables, places = tables_of(subject), closed(subject).array
    chassis = tables["bodies"]["chassis"]
    ground, moving = next(
        pair if pair[0] in chassis else pair[::-1]
        for pair in held_apart(subject)
        if (pair[0] in chassis) != (pair[1] in chassis)
    )
    # In a plane mechanism a pivot moved along the hinge axis would make an equivalent link.
    along_up = any(
        not np.cross(places[first] - places[last], subject.car.up).any()
        for points in tables["bodies"].values()
        if moving in points
        for first, last in itertools.combinations([name for name in points if name in chassis], 2)
    )
    aside = np.array(subject.car.right if along_up else subject.car.up)
    pivot = places[ground] + share * float(np.linalg.norm(places[moving] - places[ground])) * aside
    chassis.append(PIVOT)
    tables["rods"][AGAIN] = [PIVOT, moving]
    return tables, {PIVOT: as_tuple(pivot)}


# Two rows of n = 40 unknowns are distinguished down to 64 n EPS = 6e-13 of their size: a link closer to
# another than this is a copy of it, as in `link_twice`.
@_links(PIVOT_AT, decades(low=-11), MUST_REFUSE, WITH_RODS)
def contradictory_links(subject: Subject, share: float) -> Setup:
    """A further link agrees with the other links as drawn and nowhere else."""
    rates = {"rad": 0.5, "mm": 50.0}
    inputs = {name: [value, rates[subject.inputs[name].unit]] for name, value in subject.drawn.items()}
    tables, pivot = with_third_link(subject, share)
    return changed(subject, tables, (AGAIN, PIVOT, *subject.driven), inputs=inputs, points=pivot)


# Two nearly equal links differ by the distance of their pivots, and the condition number is some 30 over this
# distance: at 1e-6 half of the digits are left. If the link replaced the only input, nothing would drive the
# mechanism.
@_links(
    f"{PIVOT_AT}; then a copy of it",
    (*decades(), 0.0),
    dict.fromkeys(SOLVERS, right_from(1e-6)),
    [one for one in WITH_RODS if len(one.driven) > 1],
)
def arm_held_by_a_third_link(subject: Subject, share: float) -> Setup:
    """A further link replaces an input and constrains the mechanism less and less, until it is a copy."""
    tables, pivot = with_third_link(subject, share)
    del tables["inputs"][subject.driven[0]]
    return changed(subject, tables, points=pivot)
