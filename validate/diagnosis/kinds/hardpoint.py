"""A misread hardpoint: the change of one coordinate of the drawing that gives the given numbers.

The exact derivatives of all numbers by each coordinate of the drawing, computed once, show which coordinates
are worth a search. If one point takes the place of another, as tie_rod_inner does for rack_centre, the two
are misread together or one alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.car_axes import Direction
from pointcoord.scene.scene_file import Scene
from pointcoord.sweeping.designs import coordinates_of
from pointcoord.sweeping.hardpoint_slopes import slopes_of_motion
from validate.diagnosis.evidence import Content, Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.kinds.numbers import constant_gap, so_much_more
from validate.diagnosis.other_car import Change, any_of

Array = NDArray[np.float64]

# Largest misreading, as a share of the car's size: a larger one is a different car, and slow to solve.
FARTHEST = 0.1
MOST_POINTS = 2  # largest number of points at rest that are misread independently
TOO: Mapping[Direction, str] = {
    "up": "high",
    "down": "low",
    "outboard": "far out",
    "inboard": "far in",
    "rearward": "far back",
    "forward": "far forward",
}


def points_that_rest_elsewhere(evidence: Evidence) -> Iterator[Hypothesis]:
    """Points at rest that are given at another position: each was misread.

    If there are more than a few, they have another fault in common.
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
            texts = (_in_words(evidence.scene, row.name, int(i), float(gap[i])) for i in off)
            there = so_much_more(evidence, row, gap)
            yield Hypothesis(" and ".join(texts), there, len(off), 1.5 + len(off), rests=True)


def misread_hardpoints(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each coordinate alone, and each coordinate of points that are read together."""
    motion, points = evidence.solved.motion, evidence.scene.mechanism.points
    if motion is None:
        return iter(())
    some = [(point, i, others) for point, *others in _read_together(evidence.scene) for i in range(3)]
    alone = coordinates_of(evidence.scene, [*points])
    slopes = slopes_of_motion(evidence.scene, motion.solved, evidence.few.times, alone).numbers
    farthest = FARTHEST * float(np.ptp([*points.values()], axis=0).max())

    def slope(together: Sequence[str], i: int, looked: Sequence[Row]) -> Array:
        moved = [alone.index(f"{point}.{'xyz'[i]}") for point in together]
        return np.concatenate([slopes[quantity][of][moved].sum(axis=0).ravel() for quantity, of in looked])

    # Points that are given at their own positions do not show whether a point read with them is misread.
    wrong = {of for _, of in evidence.wrong}
    right = frozenset(row.name for row in evidence.given if row.is_place and row.name not in wrong)

    def change(point: str, i: int, others: Sequence[str]) -> Change:
        def put(content: Content, more: float) -> None:
            for name in (point, *others):
                content["mechanism"]["points"][name][i] += more

        moved = [name for name in others if name not in right]
        words = partial(_in_words, evidence.scene, point, i, others=moved)
        silent = right.intersection(others)
        key = (point, i, *others)
        return Change(key, put, words, partial(slope, (point, *others), i), farthest=farthest, silent=silent)

    return any_of(evidence, [change(*one) for one in some])


def _read_together(scene: Scene) -> list[tuple[str, ...]]:
    """Every point alone, and each point together with the coincident points whose place it takes."""
    points, groups = scene.mechanism.points, dict[str, list[str]]()
    for missing, point in scene.mechanism.topology.stand_ins.items():
        if missing in points and points[missing] == points[point]:
            groups.setdefault(point, []).append(missing)
    return [*((point, *others) for point, others in groups.items()), *((point,) for point in points)]


def _in_words(scene: Scene, point: str, i: int, amount: float, others: Sequence[str] = ()) -> str:
    place, component = scene.mechanism.points[point][i], scene.mechanism.axes.component
    direction = np.eye(3)[i] * np.sign(amount)
    word = next((word for way, word in TOO.items() if component(direction, way) > 0.999), "")
    word = word or ("large" if amount > 0.0 else "small")
    with_it = "".join(f", and {other} with it" for other in others)
    drawn = f"{abs(amount):.4g} mm too {word}: {place + amount:.6g}, not {place:.6g}"
    return f"{point}.{'xyz'[i]} seems {drawn}{with_it}"
