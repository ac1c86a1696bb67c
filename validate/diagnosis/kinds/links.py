"""The same points with other links: a rod of another length, a line through another point, another closure,
another assembly.

For the first two the car is written anew, with its mechanism's tables in the scene. A rod in question is an
input there, the distance of its ends, which is as drawn and so much more. A line in question leads through
another joint of its body, as that of a strut does through the ball joint in textbooks, and what slides on it
is drawn on that line. Only cars of one part are, so no axles.
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

STEP = 0.05  # mm, of differences by a length
# Of the car's size: how far a length may be off and still be meant, and how far another assembly is away.
KEPT, ELSEWHERE = 1e-5, 1e-4


def wrong_lengths(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rod by itself."""
    scene, tables = evidence.scene, _tables(evidence.scene)
    return any_of(evidence, [_length(scene, tables, rod) for rod in tables.get("rods", {})])


def _length(scene: Scene, tables: Mapping[str, Any], rod: str) -> Change:
    """By how much a rod is too long."""
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
        said = f"{abs(more):.4g} mm too {'long' if more > 0.0 else 'short'}"
        return f"{rod} is {said}, {drawn + more:.6g} mm for {drawn:.6g}"

    return Change(rod, put, words, STEP)


def other_lines(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each line of a moving body, through each other joint of it."""
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
    """The mechanism's, flat; empty of one that has parts or puts points in place."""
    topology = scene.mechanism.topology
    if topology.puts_in_place or topology.sides:
        return {}
    plain = scene.mechanism.plain(tuple(scene.inputs))
    return {table: plain[table] for table in CLOSING if table in plain}


def _put_tables(content: Content, tables: Mapping[str, Any]) -> None:
    """Tables of its own in the place of its mechanism's file."""
    part = content["mechanism"]
    for key in ("type", "closure"):
        part.pop(key, None)
    part |= tables


def _as_it_stands(scene: Scene) -> Motion:
    """The motion without a check of the drawing.

    One that is asked to close otherwise may not close so by itself, and another assembly may have its wheel
    inboard.
    """
    return solve_task(prepare_task(scene, AUTO))


def other_closures(evidence: Evidence) -> Iterator[Hypothesis]:
    """The whole car, by each other closure of its type of suspension."""
    part = evidence.scene.mechanism
    for closure in part.file.closures:

        def put(content: Content, closure: str = closure) -> None:
            content["mechanism"]["closure"] = closure

        if closure != part.closure:
            words = f"the car is closed as {closure}, where the scene asks for {part.closure}"
            yield from otherwise(evidence, words, put, solve=_as_it_stands)


def other_assemblies(evidence: Evidence) -> Iterator[Hypothesis]:
    """Places that keep every length of the drawing at the same inputs, elsewhere, from some instant on.

    Whoever draws the car as it stands there draws the same links. So that drawing is solved for the same
    inputs: if the given places are that car's at every instant, they are another assembly of ours.
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
        # The drawing is made of given numbers: they are off twice, as it and at each instant.
        rows = {row: (value, 2.0 * allowed) for row, (value, allowed) in one.rows.items()}
        for row, (value, _) in rows.items():
            value[:first] = evidence.held[row][:first]
        # Other inputs keep all lengths too, and from the first pose on they are no motion of ours.
        left = [np.abs(evidence.given[row] - rows[row][0]).max() for row in placed.values() if row in rows]
        if max(left) <= KEPT * size:
            yield replace(one, rows=rows)


def _links(scene: Scene) -> set[tuple[str, str]]:
    """The ends of every length: of rods, and of every two points of a moving body.

    A point that only rides on a body has its place there too, and misdrawn it is another car.
    """
    plain = scene.mechanism.plain(())
    moving = [points for body, points in plain["bodies"].items() if body != CHASSIS]
    return {
        *map(tuple, plain["rods"].values()),
        *(ends for points in moving for ends in combinations(points, 2)),
    }
