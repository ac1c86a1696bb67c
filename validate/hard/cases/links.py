"""Links that are missing, given twice or contradictory: one change of a mechanism's tables each.

What is left has no pose, or none that the inputs determine, and has to be refused before anything is said of
it; pointcoord names what is wrong. A rod that is there twice holds nothing more than one: a model may leave
it out and answer, or refuse it. Two constraints of one coordinate that agree in the drawing and nowhere else
leave no motion, however near to each other they are.
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
from validate.hard.cars import drawn_at
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
"""A rod or a slide, or a point of a body: the keys of its tables."""
Changed = tuple[Content, frozenset[str], dict[str, str]]
"""A changed mechanism at rest, what an error has to name one of, and the change as facts."""
Change = Callable[[Subject, float], Changed]
CASES: list[Case] = []
_links = partial(family, CASES, GROUP, given=False)


def joints(plain: Mapping[str, Any]) -> dict[str, list[str]]:
    """Points of each moving body that another body, a rod or a slide has as well."""
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
    """Everything without which a mechanism is another one, or none: rods, slides, points that hold a body.

    Returns:
        Of each the names of which an error has to give one, and how many rods hold as much.
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
    """Take a piece out of some tables; what it was, such as `rod tie_rod`, or `tie_rod_outer of knuckle`."""
    table, key, *point = piece
    if point:
        tables[table][key].remove(*point)
        return f"{point[0]} of {key}"
    del tables[table][key]
    return f"{table[:-1]} {key}"


def held_apart(plain: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Pairs of points at a fixed distance: points by which a moving body is held, and a rod's ends."""
    rods = ((first, last) for first, last in plain["rods"].values())
    within = (pair for points in joints(plain).values() for pair in itertools.combinations(points, 2))
    return tuple({frozenset(pair): pair for pair in (*within, *rods)}.values())


def tables_of(subject: Subject) -> Tables:
    """A mechanism's tables, to be changed."""
    plain = subject.plain
    return {name: plain[name] for name in ("bodies", "rods", "slides", "inputs", "roles")}


@cache
def closed(subject: Subject) -> Car:
    """The car with its drawing closed and every point in it, so that its tables can be changed."""
    car = subject.car if subject.car.closure == "drawn" else drawn_at(subject.car, subject.drawn)
    scene = Scene.from_mapping(subject.absolute(dict.fromkeys(subject.driven, 0.0), car))
    points = scene.mechanism.plain(subject.driven)["points"]
    return replace(car, points={name: tuple(place) for name, place in points.items()}, closure="drawn")


def changed(
    subject: Subject, tables: Tables, inputs: Mapping[str, Any] | None = None, **more: Point
) -> Content:
    """The scene of a mechanism with other tables and more points, and its inputs, as drawn if not given."""
    car = closed(subject)
    there = replace(car, points={**car.points, **more}, tables=tables)
    laws = {n: law for n, law in (inputs or subject.drawn).items() if n in tables["inputs"]}
    return content_of(there, laws, stop=0.1, samples=2, effects=("velocity",))


def named(answer: Answer, names: frozenset[str]) -> Answer:
    """A refusal of pointcoord is wrong that names nothing of what is at fault."""
    if (answer.formulation, answer.outcome) != ("pointcoord", "refused") or any(
        name in answer.reason for name in names
    ):
        return answer
    reason = f"names none of {', '.join(sorted(names))}: {answer.reason}"
    return replace(answer, outcome="wrong", reason=reason)


def _changes(
    parameter: str, values: Values | Every, subjects: Sequence[Subject], expected: Expected = REFUSED
) -> Callable[[Change], Change]:
    """Changes of mechanisms, of which pointcoord has to name what is at fault."""

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
PIVOT_AT = "distance of its pivot from the first one, in parts of the first link"
WITH_RODS = [subject for subject in ALL if subject.plain["rods"]]


@_changes(PIECE, every(lambda subject: list(pieces(subject.plain))), ALL)
def link_missing(subject: Subject, number: float) -> Changed:
    """A point, or a body, is free to move although all inputs are held."""
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
    """There are more rows than unknowns, and two of them say the same.

    Two points that are held apart are held by a rod once more.
    """
    pair, tables = held_apart(subject.plain)[int(number) - 1], tables_of(subject)
    tables["rods"][AGAIN] = list(pair)
    return changed(subject, tables), frozenset((AGAIN, *pair, *subject.driven)), {"twice": " - ".join(pair)}


def exchangeable(subject: Subject) -> list[Piece]:
    """The pieces without which there is another rod left."""
    return [piece for piece in pieces(subject.plain) if set(subject.plain["rods"]) - {piece[1]}]


@_changes(PIECE, every(exchangeable), [one for one in ALL if exchangeable(one)])
def link_twice_for_another(subject: Subject, number: float) -> Changed:
    """There are as many rows as unknowns, but some say nothing new and some are missing.

    A rod is there as often again as makes up for a piece that is missing.
    """
    tables, piece = tables_of(subject), exchangeable(subject)[int(number) - 1]
    names, rows = pieces(subject.plain)[piece]
    rod, ends = next((name, ends) for name, ends in tables["rods"].items() if name != piece[1])
    facts = {"twice": rod, "missing": without(tables, piece)}
    tables["rods"] |= {f"{AGAIN}_{k}": list(ends) for k in range(rows)}
    return changed(subject, tables), names | {rod, AGAIN}, facts


@_changes("difference of their values, rad or mm", (*decades(), 0.0), WITH_RODS)
def input_twice(subject: Subject, gap: float) -> Changed:
    """Two inputs drive one coordinate and contradict each other by less and less; at last they agree."""
    tables, first = tables_of(subject), subject.driven[0]
    tables["inputs"][AGAIN] = dict(tables["inputs"][first])
    inputs = {**subject.drawn, AGAIN: subject.drawn[first] + gap}
    return changed(subject, tables, inputs), frozenset((AGAIN, first)), {}


def _with_third_link(subject: Subject, share: float) -> tuple[Tables, dict[str, Any]]:
    """A rod beside one that holds a moving point to the chassis, its pivot a share of its length above."""
    tables, places = tables_of(subject), {n: np.array(p) for n, p in closed(subject).points.items()}
    chassis = tables["bodies"]["chassis"]
    ground, moving = next(
        pair if pair[0] in chassis else pair[::-1]
        for pair in held_apart(subject.plain)
        if (pair[0] in chassis) != (pair[1] in chassis)
    )
    # Along the hinge of a plane mechanism it would be the same link.
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


# Two rows of n = 40 unknowns are told from one down to 64 n EPS = 6e-13 of their size: a link that is nearer
# to another than this is that one again, as in `link_twice`.
@_changes(PIVOT_AT, decades(low=-11), WITH_RODS)
def contradictory_links(subject: Subject, share: float) -> Changed:
    """A further link agrees with the others as drawn and nowhere else."""
    rates = {"rad": 0.5, "mm": 50.0}
    inputs = {name: [value, rates[subject.units[name]]] for name, value in subject.drawn.items()}
    tables, pivot = _with_third_link(subject, share)
    return changed(subject, tables, inputs, **pivot), frozenset((AGAIN, PIVOT, *subject.driven)), {}


# Two links that are nearly one differ by the distance of their pivots, and the condition number grows as its
# inverse from some 30 on: at 1e-6 half of the digits are left.
@_links(
    f"{PIVOT_AT}; then a copy of it",
    (*decades(), 0.0),
    dict.fromkeys(SOLVERS, right_from(1e-6)),
    # What is held by a link in place of its only input is driven by none.
    [one for one in WITH_RODS if len(one.driven) > 1],
)
def arm_held_by_a_third_link(subject: Subject, share: float) -> Content:
    """A further link in place of an input holds the mechanism, by less and less; at last it is a copy."""
    tables, pivot = _with_third_link(subject, share)
    del tables["inputs"][subject.driven[0]]
    return changed(subject, tables, **pivot)
