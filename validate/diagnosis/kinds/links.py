"""Faults in links: a rod of another length, a slide through another point, another closure, another assembly
mode.

For the first two, the scene is rewritten with its mechanism's tables. The rod becomes an input, the distance
of its ends, with the drawn value plus an amount. The line of the slide leads through another joint of its
body, as the strut axis leads through the ball joint in textbooks, and the sliding points are moved onto this
line. This is done only for mechanisms that are not composed of others, so not for axles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from pointcoord import Motion, Scene
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import CLOSING
from pointcoord.method import AUTO
from pointcoord.simulation import prepare_task, scene_mechanism, solve_task
from validate.diagnosis.evidence import Content, Evidence
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.other_car import Change, any_of, otherwise

STEP = 0.05  # step of a difference by a length, mm
# As shares of the car's size: largest error of a length that counts as kept; least distance to another mode.
KEPT, ELSEWHERE = 1e-5, 1e-4


def wrong_lengths(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rod alone is too long or too short."""
    scene, tables = evidence.scene, _tables(evidence.scene)
    return any_of(evidence, [_length(scene, tables, rod) for rod in tables.get("rods", {})])


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
        _put_tables(content, changed)
        content["inputs"][name] = {"sum": [{"constant": "drawn"}, {"constant": more}]}

    def words(more: float) -> str:
        amount = f"{abs(more):.4g} mm too {'long' if more > 0.0 else 'short'}"
        return f"{rod} is {amount}: {drawn + more:.6g} mm, not {drawn:.6g}"

    return Change(rod, put, words, STEP)


def other_lines(evidence: Evidence) -> Iterator[Hypothesis]:
    """The line of each slide in a moving body leads through another joint of the body."""
    tables = _tables(evidence.scene)
    points = evidence.scene.mechanism.points
    ends = {end for rod in tables.get("rods", {}).values() for end in rod}
    for name, slide in tables.get("slides", {}).items():
        own = tables["bodies"][slide["body"]]
        others = {p for body, some in tables["bodies"].items() if body != slide["body"] for p in some}
        joints = [p for p in own if p in others | ends and p not in (slide["through"], slide["along"])]
        for joint in joints if slide["body"] != CHASSIS and slide["along"] in points else ():
            line = np.subtract(points[slide["along"]], points[joint])
            line /= np.linalg.norm(line)
            along = {point: np.subtract(points[point], points[joint]) @ line for point in slide["points"]}
            moved = {point: (np.array(points[joint]) + far * line).tolist() for point, far in along.items()}
            slides = {**tables["slides"], name: {**slide, "through": joint}}

            def put(content: Content, slides: Any = slides, moved: Any = moved) -> None:
                _put_tables(content, {**tables, "slides": slides})
                content["mechanism"]["points"] |= moved

            words = f"the line of {name} leads through {joint}, not through {slide['through']}"
            yield from otherwise(evidence, words, put, cost=1.5)


def _tables(scene: Scene) -> Mapping[str, Any]:
    """The flat tables of the mechanism; empty if it has parts, or a closure that places points."""
    topology = scene.mechanism.topology
    if topology.puts_in_place or topology.sides:
        return {}
    plain = scene.mechanism.plain(tuple(scene.inputs))
    return {table: plain[table] for table in CLOSING if table in plain}


def _put_tables(content: Content, tables: Mapping[str, Any]) -> None:
    """Replace the mechanism's type in a scene's content by tables."""
    part = content["mechanism"]
    for key in ("type", "closure"):
        part.pop(key, None)
    part |= tables


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
    """Another assembly mode from some instant on: given positions that keep every length, but differ from
    ours.

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
        # The drawing is made of given numbers, so their error counts twice: in the drawing and at each
        # instant.
        rows = {row: (value, 2.0 * allowed) for row, (value, allowed) in one.rows.items()}
        for row, (value, _) in rows.items():
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
