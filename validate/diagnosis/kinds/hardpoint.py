"""A hardpoint misread: the coordinate of the drawing that makes our numbers theirs, and by how much.

The exact slopes of all numbers by each coordinate of the drawing, once for the car, say which coordinates are
worth a search. A point that another one stands in for, as the tie rod's inner end does for the rack's centre,
is misread with it or alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.car_axes import Direction
from pointcoord.scene.scene_file import Scene
from pointcoord.sweeping.hardpoint_slopes import ByHardpoints
from validate.diagnosis.evidence import Content, Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.kinds.numbers import constant_gap, so_much_more
from validate.diagnosis.other_car import Change, any_of

Array = NDArray[np.float64]

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
        if row.is_place and row.name in drawn
        if (np.abs(evidence.held[row] - drawn[row.name]) <= evidence.rounded(row)).all()
    ]
    for row in rest if len(rest) <= MOST_POINTS else ():
        gap = constant_gap(evidence, row)
        if gap is not None:
            off = np.flatnonzero(gap)
            said = (_said(evidence.scene, row.name, int(i), float(gap[i])) for i in off)
            there = so_much_more(evidence, row, gap)
            yield Hypothesis(" and ".join(said), there, len(off), 1.5 + len(off), rests=True)


def misread_hardpoints(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each coordinate by itself, and those of points with others that are read with them."""
    motion, points = evidence.solved.motion, evidence.scene.mechanism.points
    if motion is None:
        return iter(())
    some = [(point, i, others) for point, *others in _read_together(evidence.scene) for i in range(3)]
    moves = {point: np.zeros((len(some), 3)) for point in points}
    for k, (point, i, others) in enumerate(some):
        for name in (point, *others):
            moves[name][k, i] = 1.0
    by_hardpoints = ByHardpoints(motion.solved, moves)
    slopes = by_hardpoints.numbers(by_hardpoints.poses(evidence.few.times))
    farthest = FARTHEST * float(np.ptp([*points.values()], axis=0).max())

    def slope(k: int, looked: Sequence[Row]) -> Array:
        return np.concatenate([slopes[quantity][of][k].ravel() for quantity, of in looked])

    # Points that are given back at their own places say nothing of those that they are read with.
    wrong = {of for _, of in evidence.wrong}
    right = frozenset(row.name for row in evidence.given if row.is_place and row.name not in wrong)

    def change(k: int, point: str, i: int, others: Sequence[str]) -> Change:
        def put(content: Content, more: float) -> None:
            for name in (point, *others):
                content["mechanism"]["points"][name][i] += more

        moved = [name for name in others if name not in right]
        words = partial(_said, evidence.scene, point, i, others=moved)
        silent = right.intersection(others)
        key = (point, i, *others)
        return Change(key, put, words, partial(slope, k), farthest=farthest, silent=silent)

    return any_of(evidence, [change(k, *one) for k, one in enumerate(some)])


def _read_together(scene: Scene) -> list[tuple[str, ...]]:
    """Every point by itself, and each with those that it stands in for and that are drawn where it is."""
    points, groups = scene.mechanism.points, dict[str, list[str]]()
    for missing, point in scene.mechanism.topology.stand_ins.items():
        if missing in points and points[missing] == points[point]:
            groups.setdefault(point, []).append(missing)
    return [*((point, *others) for point, others in groups.items()), *((point,) for point in points)]


def _said(scene: Scene, point: str, i: int, amount: float, others: Sequence[str] = ()) -> str:
    place, component = scene.mechanism.points[point][i], scene.mechanism.axes.component
    direction = np.eye(3)[i] * np.sign(amount)
    word = next((word for way, word in TOO.items() if component(direction, way) > 0.999), "")
    word = word or ("large" if amount > 0.0 else "small")
    with_it = "".join(f", and {other} with it" for other in others)
    drawn = f"{abs(amount):.4g} mm too {word}, at {place + amount:.6g} for {place:.6g}"
    return f"{point}.{'xyz'[i]} drawn {drawn}{with_it}"
