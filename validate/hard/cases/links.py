"""Links that are missing, given twice or contradictory: each case changes a mechanism's tables in one way.

The changed mechanism has no pose, or the inputs do not determine its pose. It must be refused before any
number is given; pointcoord must name the fault. A rod that is given twice constrains no more than one rod: a
model may leave the second out and answer, or refuse it. Two constraints of one coordinate that agree in the
drawing and nowhere else leave no motion, however close they are.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from pointcoord import Scene
from validate.cars.car import Car, Point, as_tuple, content_of
from validate.hard.answer import Answer
from validate.hard.case import (
    IF_ANY,
    REFUSED,
    Case,
    Every,
    Expected,
    Values,
    decades,
    every,
    family,
    reason_of,
    right_from,
)
from validate.hard.subjects import ALL, Content, Subject, hyphens

GROUP = "Links and numbers that make no mechanism"
SOLVERS = ("pointcoord", "absolute")
AGAIN, PIVOT = "again", "second_pivot"
Tables = dict[str, Any]
Piece = tuple[str, ...]
"""A rod, a slide, or a point of a body: its keys in the tables."""
Changed = tuple[Content, frozenset[str], dict[str, str]]
"""A changed mechanism at rest, names of which an error must give one, and the change as facts."""
Change = Callable[[Subject, float], Changed]
CASES: list[Case] = []
_links = partial(family, CASES, GROUP, given=False)


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


def pieces(plain: Mapping[str, Any]) -> dict[Piece, tuple[frozenset[str], int]]:
    """The constraints of a mechanism: rods, slides, and points that join a body to others.

    Returns:
        For each piece, names of which an error must give one, and the number of rods that constrain as much.
    """
    bodies = plain["bodies"]
    found: dict[Piece, tuple[frozenset[str], int]] = {}
    for rod, ends in plain["rods"].items():
        found["rods", rod] = frozenset((rod, *ends)), 1
    for name, slide in plain["slides"].items():
        found["slides", name] = frozenset((name, *slide["points"])), 2 * len(slide["points"])
    for body, points in joints(plain).items():
        shared = [set(other) & set(bodies[body]) for name, other in bodies.items() if name != body]
        for point in points:
            hinged = any(len(both) == 2 and point in both for both in shared)
            found["bodies", body, point] = frozenset((body, *bodies[body])), 2 if hinged else 3
    return found


def without(tables: Tables, piece: Piece) -> str:
    """Remove a piece from the tables; returns its name: `rod tie_rod`, or `tie_rod_outer of knuckle`."""
    table, key, *point = piece
    if point:
        tables[table][key].remove(*point)
        return f"{point[0]} of {key}"
    del tables[table][key]
    return f"{table[:-1]} {key}"


def held_apart(plain: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Pairs of points at a fixed distance: joints of a moving body, and the ends of a rod."""
    rods = ((first, last) for first, last in plain["rods"].values())
    within = (pair for points in joints(plain).values() for pair in itertools.combinations(points, 2))
    return tuple({frozenset(pair): pair for pair in (*within, *rods)}.values())


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
    subject: Subject, tables: Tables, inputs: Mapping[str, Any] | None = None, **more: Point
) -> Content:
    """The scene of a mechanism with changed tables and further points; inputs as drawn if not given."""
    car = closed(subject)
    there = replace(car, points={**car.points, **more}, tables=tables)
    laws = {n: law for n, law in (inputs or subject.drawn).items() if n in tables["inputs"]}
    return content_of(there, laws, stop=0.1, samples=2, effects=("velocity",))


def named(answer: Answer, names: frozenset[str]) -> Answer:
    """A refusal by pointcoord that names nothing at fault is wrong; other answers are unchanged."""
    if (answer.formulation, answer.outcome) != ("pointcoord", "refused") or any(
        name in answer.reason for name in names
    ):
        return answer
    reason = f"names none of {', '.join(sorted(names))}: {answer.reason}"
    return replace(answer, outcome="wrong", reason=reason)


def _changes(
    parameter: str, values: Values | Every, subjects: Sequence[Subject], expected: Expected = REFUSED
) -> Callable[[Change], Change]:
    """A decorator of a change: adds its cases, in which pointcoord must name the fault."""

    def rows(change: Change) -> Change:
        _links(
            *(parameter, values, dict.fromkeys(SOLVERS, expected), subjects),
            name=hyphens(change.__name__),
            why=reason_of(change),
            judge=lambda subject, value, _, answer: named(answer, change(subject, value)[1]),
            facts=lambda subject, value: change(subject, value)[2],
        )(lambda subject, value: change(subject, value)[0])
        return change

    return rows


PIECE = "number of the piece"
PIVOT_AT = "distance of its pivot from the first pivot, in parts of the first link"
WITH_RODS = [subject for subject in ALL if subject.plain["rods"]]


@_changes(PIECE, every(lambda subject: list(pieces(subject.plain))), ALL)
def link_missing(subject: Subject, number: float) -> Changed:
    """A constraint is missing: a point or a body can move although all inputs are held."""
    tables = tables_of(subject)
    piece, (names, _) = list(pieces(subject.plain).items())[int(number) - 1]
    missing = without(tables, piece)
    return changed(subject, tables), names, {"missing": missing}


@_changes(
    "number of the pair of points that are held apart",
    every(lambda subject: held_apart(subject.plain)),
    *(ALL, IF_ANY),
)
def link_twice(subject: Subject, number: float) -> Changed:
    """There are more equations than unknowns, and two of them are equivalent.

    An additional rod joins two points that are already at a fixed distance.
    """
    pair, tables = held_apart(subject.plain)[int(number) - 1], tables_of(subject)
    tables["rods"][AGAIN] = list(pair)
    return changed(subject, tables), frozenset((AGAIN, *pair, *subject.driven)), {"twice": " - ".join(pair)}


def exchangeable(subject: Subject) -> list[Piece]:
    """The pieces without which at least one rod is left."""
    return [piece for piece in pieces(subject.plain) if set(subject.plain["rods"]) - {piece[1]}]


@_changes(PIECE, every(exchangeable), [one for one in ALL if exchangeable(one)])
def link_twice_for_another(subject: Subject, number: float) -> Changed:
    """There are as many equations as unknowns, but some are redundant and some are missing.

    A piece is removed, and a rod is repeated to make up for the number of its equations.
    """
    tables, piece = tables_of(subject), exchangeable(subject)[int(number) - 1]
    names, rows = pieces(subject.plain)[piece]
    rod, ends = next((name, ends) for name, ends in tables["rods"].items() if name != piece[1])
    facts = {"twice": rod, "missing": without(tables, piece)}
    tables["rods"] |= {f"{AGAIN}_{k}": list(ends) for k in range(rows)}
    return changed(subject, tables), names | {rod, AGAIN}, facts


@_changes("difference of their values, rad or mm", (*decades(), 0.0), WITH_RODS)
def input_twice(subject: Subject, gap: float) -> Changed:
    """Two inputs drive one coordinate and contradict each other, by less and less until they agree."""
    tables, first = tables_of(subject), subject.driven[0]
    tables["inputs"][AGAIN] = dict(tables["inputs"][first])
    inputs = {**subject.drawn, AGAIN: subject.drawn[first] + gap}
    return changed(subject, tables, inputs), frozenset((AGAIN, first)), {}


def _with_third_link(subject: Subject, share: float) -> tuple[Tables, dict[str, Any]]:
    """A rod next to a link from the chassis to a moving point, its pivot a share of the length above."""
    tables, places = tables_of(subject), {n: np.array(p) for n, p in closed(subject).points.items()}
    chassis = tables["bodies"]["chassis"]
    ground, moving = next(
        pair if pair[0] in chassis else pair[::-1]
        for pair in held_apart(subject.plain)
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
@_changes(PIVOT_AT, decades(low=-11), WITH_RODS)
def contradictory_links(subject: Subject, share: float) -> Changed:
    """A further link agrees with the other links as drawn and nowhere else."""
    rates = {"rad": 0.5, "mm": 50.0}
    inputs = {name: [value, rates[subject.units[name]]] for name, value in subject.drawn.items()}
    tables, pivot = _with_third_link(subject, share)
    return changed(subject, tables, inputs, **pivot), frozenset((AGAIN, PIVOT, *subject.driven)), {}


# Two nearly equal links differ by the distance of their pivots, and the condition number is some 30 over this
# distance: at 1e-6 half of the digits are left.
@_links(
    f"{PIVOT_AT}; then a copy of it",
    (*decades(), 0.0),
    dict.fromkeys(SOLVERS, right_from(1e-6)),
    # If the link replaces the only input, nothing drives the mechanism.
    [one for one in WITH_RODS if len(one.driven) > 1],
)
def arm_held_by_a_third_link(subject: Subject, share: float) -> Content:
    """A further link replaces an input and constrains the mechanism less and less, until it is a copy."""
    tables, pivot = _with_third_link(subject, share)
    del tables["inputs"][subject.driven[0]]
    return changed(subject, tables, **pivot)
