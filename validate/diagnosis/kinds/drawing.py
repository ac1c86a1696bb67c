"""Faults in the drawing of the car: a misread hardpoint, a rod of another length, another closure, another
assembly mode.

The exact derivatives of all numbers by each coordinate of the drawing, computed once, show which coordinates
are worth a search. If one point takes the place of another, as tie_rod_inner does for rack_centre, the two
are misread together or one alone; so are points of two wheels that are mirror images, which a scene gives
once.

For a rod, the scene is rewritten with its mechanism's tables. The rod becomes an input, the distance of its
ends, with the drawn value plus an amount. This is done only for mechanisms that are not composed of others,
so not for axles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from pointcoord import Motion, Scene
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.directions import Direction
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import CLOSING
from pointcoord.method import AUTO
from pointcoord.simulation import prepare_task, scene_mechanism, solve_task
from pointcoord.sweeping.designs import coordinates_of
from pointcoord.sweeping.hardpoint_slopes import slopes_of_motion
from validate.arrays import Array
from validate.diagnosis.evidence import Content, Evidence, Hypothesis, Row
from validate.diagnosis.kinds.numbers import constant_gap, so_much_more
from validate.diagnosis.other_car import Change, any_of, otherwise

# Largest misreading, as a share of the car's size: a larger one is a different car, and slow to solve.
FARTHEST = 0.1
MOST_POINTS = 2  # largest number of points at rest that are misread independently
STEP = 0.05  # step of a difference by a length, mm
# As shares of the car's size: largest error of a length that counts as kept; least distance to another mode.
KEPT, ELSEWHERE = 1e-5, 1e-4
TOO: Mapping[Direction, str] = {
    "up": "high",
    "down": "low",
    "outboard": "far out",
    "inboard": "far in",
    "rearward": "far back",
    "forward": "far forward",
}


def points_that_rest_elsewhere(evidence: Evidence) -> Iterator[Hypothesis]:
    """Points that rest as drawn are given at another position: each was misread.

    If there are more than a few, they have another fault in common.
    """
    drawn = evidence.scene.mechanism.points
    rest = (
        row
        for row in evidence.wrong
        if row.is_place and row.name in drawn
        if (np.abs(evidence.held[row] - drawn[row.name]) <= evidence.rounded(row)).all()
    )
    gaps = {row: gap for row in rest if (gap := constant_gap(evidence, row)) is not None}
    for row, gap in gaps.items() if len(gaps) <= MOST_POINTS else ():
        off = np.flatnonzero(gap)
        texts = (_in_words(evidence.scene, row.name, int(i), float(gap[i])) for i in off)
        there = so_much_more(evidence, row, gap)
        yield Hypothesis(" and ".join(texts), there, len(off), 1.5 + len(off), rests=True)


def misread_hardpoints(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each coordinate alone, and each coordinate of points that are read together."""
    motion, points = evidence.solved.motion, evidence.scene.mechanism.points
    if motion is None:
        return iter(())
    alone = coordinates_of(evidence.scene, [*points])
    slopes = slopes_of_motion(evidence.scene, motion.solved, evidence.few.times, alone).numbers
    farthest = FARTHEST * float(np.ptp([*points.values()], axis=0).max())

    def slope(together: Mapping[str, float], i: int, looked: Sequence[Row]) -> Array:
        moved = [alone.index(f"{point}.{'xyz'[i]}") for point in together]
        signs = [*together.values()]
        return np.concatenate(
            [np.tensordot(signs, slopes[quantity][of][moved], 1).ravel() for quantity, of in looked]
        )

    # Points that are given at their own positions do not show whether a point read with them is misread.
    wrong = {of for _, of in evidence.wrong}
    right = frozenset(row.name for row in evidence.given if row.is_place and row.name not in wrong)

    def change(together: Mapping[str, float], i: int) -> Change:
        point, *others = together

        def put(content: Content, more: float) -> None:
            for name, sign in together.items():
                content["mechanism"]["points"][name][i] += sign * more

        moved = [n for n in others if n not in right or n not in evidence.scene.mechanism.topology.stand_ins]
        words = partial(_in_words, evidence.scene, point, i, others=moved)
        by, silent = partial(slope, together, i), right.intersection(others)
        return Change((i, *together), put, words, by, farthest=farthest, silent=silent)

    return any_of(evidence, [change(some, i) for i in range(3) for some in _read_together(evidence.scene, i)])


def _read_together(scene: Scene, i: int) -> list[dict[str, float]]:
    """The points whose coordinate i may be misread together, with the sign of the change of each.

    Every point alone, each point together with the coincident points whose place it takes, and all of these
    together with their mirror images at the other wheel.
    """
    points, topology = scene.mechanism.points, scene.mechanism.topology
    groups = {point: {point: 1.0} for point in points}
    for missing, point in topology.stand_ins.items():
        if missing in points and points[missing] == points[point]:
            groups[point][missing] = 1.0
    alone = [{point: 1.0} for point in points]
    found = [*(group for group in groups.values() if len(group) > 1), *alone]
    signs = 1.0 - 2.0 * np.abs(scene.mechanism.right)
    if not np.isin(signs, (-1.0, 1.0)).all():
        return found  # the mirror image of a coordinate is none
    for one, two in combinations(topology.sides, 2):
        for group in tuple(found):
            images = {point: point.replace(f"{one}.", f"{two}.", 1) for point in group}
            if all(
                point.startswith(f"{one}.") and np.array_equal(signs * points[point], points.get(image, ()))
                for point, image in images.items()
            ):
                found.append(group | {image: float(signs[i]) for image in images.values()})
    return found


def _in_words(scene: Scene, point: str, i: int, amount: float, others: Sequence[str] = ()) -> str:
    place, part = scene.mechanism.points[point][i], point.rpartition(".")[0]
    component = scene.mechanism.axes.on(scene.mechanism.topology.sides.get(part, "")).component
    direction = np.eye(3)[i] * np.sign(amount)
    word = next((word for way, word in TOO.items() if component(direction, way) > 0.999), "")
    word = word or ("large" if amount > 0.0 else "small")
    with_it = "".join(f", and {other} with it" for other in others)
    drawn = f"{abs(amount):.4g} mm too {word}: {place + amount:.6g}, not {place:.6g}"
    return f"{point}.{'xyz'[i]} seems {drawn}{with_it}"


def wrong_lengths(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rod alone is too long or too short; not in mechanisms with parts, or with points put in place."""
    scene, topology = evidence.scene, evidence.scene.mechanism.topology
    if topology.puts_in_place or topology.sides:
        return iter(())
    plain = scene.mechanism.plain(tuple(scene.inputs))
    tables = {table: plain[table] for table in CLOSING if table in plain}
    return any_of(evidence, [_length(scene, tables, rod) for rod in plain["rods"]])


def _length(scene: Scene, tables: Mapping[str, Any], rod: str) -> Change:
    """The change of the length of a rod."""
    name, ends = f"length of {rod}", tables["rods"][rod]
    start, end = (np.array(scene.mechanism.points[point]) for point in ends)
    drawn = float(np.linalg.norm(end - start))
    changed = {
        **tables,
        "rods": {key: one for key, one in tables["rods"].items() if key != rod},
        "inputs": {**tables["inputs"], name: {"distance": ends}},
    }

    def put(content: Content, more: float) -> None:
        # Tables replace the name of a mechanism file.
        own = {key: one for key, one in content["mechanism"].items() if key not in ("type", "closure")}
        content["mechanism"] = own | changed
        content["inputs"][name] = {"sum": [{"constant": "drawn"}, {"constant": more}]}

    def words(more: float) -> str:
        amount = f"{abs(more):.4g} mm too {'long' if more > 0.0 else 'short'}"
        return f"{rod} is {amount}: {drawn + more:.6g} mm, not {drawn:.6g}"

    return Change(rod, put, words, STEP)


def _as_it_stands(scene: Scene) -> Motion:
    """The motion without a check of the drawing.

    The check could refuse a drawing with another closure, or another assembly mode with the wheel inboard.
    """
    return solve_task(prepare_task(scene, AUTO))


def other_closures(evidence: Evidence) -> Iterator[Hypothesis]:
    """The whole car with another closure of its suspension type."""
    part = evidence.scene.mechanism
    for closure in part.file.closures:

        def put(content: Content, closure: str = closure) -> None:
            content["mechanism"]["closure"] = closure

        if closure != part.closure:
            words = f"the car is closed as {closure}, where the scene asks for {part.closure}"
            yield from otherwise(evidence, words, put, solve=_as_it_stands)


def other_assemblies(evidence: Evidence) -> Iterator[Hypothesis]:
    """Another assembly mode from some instant on: given positions that keep all lengths, unlike ours.

    A car drawn at these positions has the same links. So this drawing is solved with the same inputs: if the
    given positions are those of this car at every instant, they are another assembly mode.
    """
    scene, topology = evidence.scene, evidence.scene.mechanism.topology
    placed = {row.name: row for row in evidence.given if row.is_place}
    free = (*topology.moving, *topology.carried)
    if any(name not in placed for name in free):
        return
    drawn = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    size = float(np.ptp([*drawn.values()], axis=0).max())
    gaps = [np.linalg.norm(evidence.given[row] - evidence.held[row], axis=-1) for row in placed.values()]
    away = np.max(gaps, axis=0) > ELSEWHERE * size
    if not away.any():
        return
    first = int(np.argmax(away))
    mechanism = scene_mechanism(scene)
    there = np.stack([evidence.given[placed[name]][first] for name in free]) - mechanism.origin
    when = np.full(len(free), evidence.times[first])
    moved = ChassisMotion.of(mechanism, scene.functions).taken_back(when, there) + mechanism.origin
    pose = drawn | dict(zip(free, moved, strict=True))
    closed = {name: place * mechanism.unit for name, place in mechanism.places(mechanism.drawn).items()}
    links = _links(scene)
    missed = [np.linalg.norm(pose[a] - pose[b]) - np.linalg.norm(closed[a] - closed[b]) for a, b in links]
    if np.abs(missed).max() > KEPT * size:
        return

    def put(content: Content) -> None:
        content["mechanism"]["points"] |= {name: place.tolist() for name, place in pose.items()}

    since = "" if first == 0 else f" from t = {evidence.times[first]:.6g} s on"
    words = f"another assembly of the same links{since}: all {len(links)} lengths are kept"
    for one in otherwise(evidence, words, put, 1.2, _as_it_stands):
        # The error of given numbers counts twice: in the drawing, made of them, and at each instant.
        rows = {row: (value, 2.0 * allowed) for row, (value, allowed) in one.rows.items()}
        for row, (value, allowed) in rows.items():
            # Travels count from the drawing, which is another one here: they are 0 at its pose.
            if (
                row.of == "car"
                and row.unit == "mm"
                and row.order == 0
                and abs(value[first]) <= allowed[first]
            ):
                value += evidence.given[row][first]
            value[:first] = evidence.held[row][:first]
        # Other inputs keep all lengths too, but would not follow the motion from the first pose on.
        left = [np.abs(evidence.given[row] - rows[row][0]).max() for row in placed.values() if row in rows]
        if max(left) <= KEPT * size:
            yield replace(one, rows=rows)


def _links(scene: Scene) -> set[tuple[str, str]]:
    """The pairs of points at fixed distances: ends of rods, and every two points of a moving body."""
    plain = scene.mechanism.plain(())
    moving = [points for body, points in plain["bodies"].items() if body != CHASSIS]
    return {
        *map(tuple, plain["rods"].values()),
        *(ends for points in moving for ends in combinations(points, 2)),
    }
