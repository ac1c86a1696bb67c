"""A hardpoint misread: the coordinate of the drawing that makes our numbers theirs, and by how much.

With s how the numbers change with a coordinate of the drawing (differences of solved designs, once for the
car), least squares of s a = theirs - ours picks the likeliest; their amounts are found by solving the
corrected designs. A point that another one stands in for, as the tie rod's inner end does for the rack's
centre, is misread with it or alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, Sweep, sweep
from pointcoord.linkage.car_axes import Direction
from validate.diagnosis.evidence import Content, Evidence, Row, Solved, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, WouldBe
from validate.diagnosis.least import LIKELY
from validate.diagnosis.other_car import Change, amount_of, by_what_tells, supposed

Array = NDArray[np.float64]
Coordinate = tuple[str, ...]
"""Of a point, such as `tie_rod_outer.z`, and of the points that are read with it."""

STEP = 0.05  # mm, of the differences
SAME = 1e-9  # of a scene's time: instants that are counted from another start are rounded otherwise
MOST_INSTANTS = 25  # that amounts are found from
LIKELIEST = 4
# How many times what the best choice leaves another may leave.
POORER = 30.0
# Of the car's size: what is read wrongly by more is another car, and whether it closes takes long to find.
FARTHEST = 0.1
MOST_POINTS = 2  # that are misread each by itself
TOO: Mapping[Direction, str] = {
    "up": "high",
    "down": "low",
    "outboard": "far out",
    "inboard": "far in",
    "rearward": "far back",
    "forward": "far forward",
}


def points_that_rest_elsewhere(evidence: Evidence) -> Iterator[Hypothesis]:
    """A point that rests where it is drawn, and is given at rest elsewhere, was misread.

    More than a few that are have something else in common.
    """
    drawn = evidence.scene.mechanism.points
    rest = [
        row
        for row in evidence.wrong
        if kind_of(row) == "point" and order(row) == 0 and row[1] in drawn
        if (np.abs(evidence.held[row] - drawn[row[1]]) <= evidence.rounded(row)).all()
    ]
    for row in rest if len(rest) <= MOST_POINTS else ():
        gap, allowed = evidence.given[row] - evidence.held[row], evidence.allowed[row].max(axis=0)
        off = [i for i in range(3) if abs(gap[0, i]) > allowed[i]]
        if off and (np.ptp(gap, axis=0) <= 2.0 * allowed).all():
            said = (_said(evidence, (f"{row[1]}.{'xyz'[i]}",), float(gap[0, i])) for i in off)
            there = {row: (evidence.held[row] + gap[0], evidence.rounded(row, gap[0]))}
            yield Hypothesis(row, " and ".join(said), there, len(off), 1.5 + len(off), rests=True)


def misread_hardpoints(evidence: Evidence) -> Iterator[Hypothesis]:
    """The likeliest coordinates, each by itself."""
    few = _few_instants(evidence.scene)
    at = np.searchsorted(0.5 * (evidence.times[1:] + evidence.times[:-1]), few)
    if np.abs(evidence.times[at] - few).max() <= SAME * np.ptp(evidence.scene.instants):
        return by_what_tells(evidence, partial(_misread, evidence, evidence.at(at)))
    return iter(())


def _few_instants(scene: Scene) -> Array:
    return scene.instants[:: -(-len(scene.instants) // MOST_INSTANTS)]


@lru_cache(maxsize=1)
def _beside(solved: Solved) -> tuple[tuple[Coordinate, ...], Sweep]:
    """Every coordinate of the drawing, and the car as drawn and with each a little less, at a few instants.

    Those of a point that others stand at the place of are there with theirs too.
    """
    mechanism, instants = solved.scene.mechanism, _few_instants(solved.scene)
    points, with_others = mechanism.points, dict[str, list[str]]()
    for missing, point in mechanism.topology.stand_ins.items():
        if missing in points and points[missing] == points[point]:
            with_others.setdefault(point, []).append(missing)
    together = [(point, *others) for point, others in with_others.items()]
    names = tuple(
        tuple(f"{name}.{axis}" for name in some)
        for some in (*together, *((point,) for point in points))
        for axis in "xyz"
    )
    # Every point is varied, if by nothing: else those that others stand in for go along with these.
    offsets = {f"{name}.{axis}": np.zeros(len(names) + 1) for name in points for axis in "xyz"}
    for i, some in enumerate(names, 1):
        for name in some:
            offsets[name][i] = -STEP
    time = solved.scene.time.model_copy(update={"stop": float(instants[-1]), "samples": len(instants)})
    return names, sweep(solved.fine.model_copy(update={"time": time}), offsets=offsets)


def _misread(evidence: Evidence, few: Evidence, looked: Sequence[Row]) -> list[Hypothesis]:
    """The likeliest by some numbers.

    Args:
        few: the same at the instants that designs are solved at.
    """
    held, theirs, _ = few.joined(looked)
    if not np.isfinite(theirs).all():
        return []
    names, beside = _beside(evidence.solved)
    parts = [beside.numbers[quantity][name].reshape(len(beside), -1) for quantity, name in looked]
    ours, *less = np.concatenate(parts, axis=1)
    slopes, gap = (ours - np.array(less)) / STEP, held - theirs
    squares, products, whole = np.sum(slopes**2, axis=1), slopes @ -gap, float(gap @ gap)
    farthest = FARTHEST * float(np.ptp([*evidence.scene.mechanism.points.values()], axis=0).max())
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = np.where(np.abs(products) <= farthest * squares, whole - products**2 / squares, np.inf)
    likeliest = [int(i) for i in np.argsort(rest)[:LIKELIEST] if rest[i] <= LIKELY**2 * whole]
    found: list[tuple[float, Hypothesis]] = []
    for i in likeliest:
        change = _coordinate(evidence, names[i])
        fit = amount_of(few, looked, change, slopes[i])
        if fit and abs(fit[0]) < farthest and (one := supposed(evidence, change, fit[0])):
            found.append((fit[1], replace(one, rows=_but_for(_echoed(evidence, names[i]), one.rows))))
    best = min((left for left, _ in found), default=0.0)
    return [one for left, one in found if left <= POORER * best]


def _echoed(evidence: Evidence, names: Coordinate) -> set[str]:
    """The points read with another one that are given back at their own places, which say nothing of it."""
    placed = {row[1] for row in evidence.given if kind_of(row) == "point" and order(row) == 0}
    others = {name.rpartition(".")[0] for name in names[1:]}
    return (others & placed) - {of for _, of in evidence.wrong}


def _but_for(points: set[str], rows: Mapping[Row, WouldBe]) -> dict[Row, WouldBe]:
    return {row: numbers for row, numbers in rows.items() if row[1] not in points}


def _coordinate(evidence: Evidence, names: Coordinate) -> Change:
    def put(content: Content, more: float) -> None:
        for point, _, axis in (name.rpartition(".") for name in names):
            content["mechanism"]["points"][point]["xyz".index(axis)] += more

    return Change(names, 0.0, STEP, put, partial(_said, evidence, names))


def _said(evidence: Evidence, names: Coordinate, amount: float) -> str:
    coordinate, *others = names
    point, _, axis = coordinate.rpartition(".")
    place = evidence.scene.mechanism.points[point]["xyz".index(axis)]
    direction = np.eye(3)["xyz".index(axis)] * np.sign(amount)
    component = evidence.scene.mechanism.axes.component
    word = next((word for way, word in TOO.items() if component(direction, way) > 0.999), "")
    word = word or ("large" if amount > 0.0 else "small")
    echoed = _echoed(evidence, names)
    points = (other.rpartition(".")[0] for other in others)
    with_it = "".join(f", and {point} with it" for point in points if point not in echoed)
    drawn = f"{abs(amount):.4g} mm too {word}, at {place + amount:.6g} for {place:.6g}"
    return f"{coordinate} drawn {drawn}{with_it}"
