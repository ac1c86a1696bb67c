"""A rod of another length than drawn, and a slide whose line leads through another point of its body.

The car is written anew, with its mechanism's tables in the scene. A rod in question is an input there, the
distance of its ends, which is as drawn and so much more; by how much is found by least squares. A line in
question leads through another joint of its body, as that of a strut does through the ball joint in textbooks,
and what slides on it is drawn on that line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import CLOSING
from validate.diagnosis.evidence import Evidence, Row
from validate.diagnosis.hypothesis import Hypothesis, amounts_of, by_what_tells
from validate.diagnosis.least import decimals_of

STEP = 0.05  # mm, of differences by a length


def wrong_lengths(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rod by itself."""
    tables = _tables(evidence.scene)

    def supposed(looked: Sequence[Row], _: bool) -> list[Hypothesis]:
        rods = (_wrong_length(evidence, looked, tables, rod) for rod in tables.get("rods", {}))
        return [one for one in rods if one is not None]

    return by_what_tells(evidence, supposed)


def _wrong_length(
    evidence: Evidence, looked: Sequence[Row], tables: Mapping[str, Any], rod: str
) -> Hypothesis | None:
    ends = tables["rods"][rod]
    name = f"length of {rod}"
    changed = {
        **tables,
        "rods": {key: one for key, one in tables["rods"].items() if key != rod},
        "inputs": {**tables["inputs"], name: {"distance": ends}},
    }

    def car(more: float) -> Motion | None:
        return _solved(evidence, changed, {}, {name: {"sum": [{"constant": "drawn"}, {"constant": more}]}})

    found = amounts_of(evidence, looked, car, [0.0], STEP)
    motion = car(*found) if found else None
    if found is None or motion is None:
        return None
    (more,) = found
    start, end = (np.array(evidence.scene.mechanism.points[point]) for point in ends)
    drawn = float(np.linalg.norm(end - start))
    said = f"{abs(more):.4g} mm too {'long' if more > 0.0 else 'short'}"
    words = f"{rod} is {said}, {drawn + more:.6g} mm for {drawn:.6g}"
    return Hypothesis(rod, words, evidence.by(motion), 1, 2.5, decimals_of(np.array(found)), whole=True)


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
            moved = {}
            for point in slide["points"]:
                along = np.subtract(points[point], points[joint]) @ line
                moved[point] = tuple((np.array(points[joint]) + along * line).tolist())
            changed = {**tables["slides"], name: {**slide, "through": joint}}
            if motion := _solved(evidence, {**tables, "slides": changed}, moved, {}):
                words = f"the line of {name} leads through {joint}, not through {slide['through']}"
                yield Hypothesis((name, joint), words, evidence.by(motion), cost=1.5, whole=True)


def _tables(scene: Scene) -> Mapping[str, Any]:
    """The mechanism's, flat; empty of one that puts points in place."""
    part = scene.mechanism
    if part.topology.puts_in_place:
        return {}
    plain = part.plain(tuple(scene.inputs))
    return {table: plain[table] for table in CLOSING if table in plain}


def _in_parts(tables: Mapping[str, Any], sides: Mapping[str, str]) -> dict[str, Any]:
    """Flat tables as a scene holds them: what has a part's name before its own is in a table of the part."""
    left, parts = {table: dict(entries) for table, entries in tables.items()}, dict[str, Any]()
    for part, side in sides.items():
        prefix = f"{part}."
        own: dict[str, Any] = {
            table: {key: left[table].pop(key) for key in tuple(entries) if key.startswith(prefix)}
            for table, entries in left.items()
        }
        chassis = left["bodies"][CHASSIS]
        own["bodies"][CHASSIS] = [point for point in chassis if point.startswith(prefix)]
        left["bodies"][CHASSIS] = [point for point in chassis if not point.startswith(prefix)]
        parts[part] = {"side": side, "mechanism": _without(prefix, own)}
    return {**left, "parts": parts} if parts else left


def _without(prefix: str, entry: Any) -> Any:
    """Tables, lists and names without a prefix in names."""
    if isinstance(entry, str):
        return entry.removeprefix(prefix)
    if isinstance(entry, Mapping):
        return {_without(prefix, key): _without(prefix, value) for key, value in entry.items()}
    return [_without(prefix, each) for each in entry] if isinstance(entry, list | tuple) else entry


def _solved(
    evidence: Evidence,
    tables: Mapping[str, Any],
    points: Mapping[str, tuple[float, ...]],
    inputs: Mapping[str, Any],
) -> Motion | None:
    """The motion of the car by other tables, points and further inputs; None where there is none."""
    content = evidence.solved.ends.model_dump(exclude_none=True)
    part = {key: value for key, value in content["mechanism"].items() if key not in ("type", "closure")}
    part |= _in_parts(tables, evidence.scene.mechanism.topology.sides)
    part["points"] = {**part["points"], **points}
    content |= {"mechanism": part, "inputs": {**content["inputs"], **inputs}}
    try:
        return simulate(Scene.from_mapping(content, "another car"))
    except PointcoordError:
        return None
