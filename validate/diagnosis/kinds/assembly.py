"""The same links put together otherwise: closed otherwise than the scene asks for, or another assembly."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.method import AUTO
from pointcoord.simulation import prepare_task, scene_mechanism, solve_task
from validate.diagnosis.evidence import Evidence, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis

Array = NDArray[np.float64]

# Of the car's size: how far a length may be off and still be meant, and how far another assembly is away.
KEPT, ELSEWHERE = 1e-5, 1e-4


def _solved(scene: Scene, **changes: object) -> Motion | None:
    """The motion of a scene with a mechanism otherwise drawn or closed; None where there is none.

    No drawing check: a drawing that is asked to close otherwise may not close so by itself, and another
    assembly may have its wheel inboard.
    """
    mechanism = scene.mechanism.model_copy(update=changes)
    try:
        return solve_task(prepare_task(scene.model_copy(update={"mechanism": mechanism}), AUTO))
    except PointcoordError:
        return None


def other_closures(evidence: Evidence) -> Iterator[Hypothesis]:
    """The whole car, by each other closure of its type of suspension."""
    part = evidence.scene.mechanism
    for closure in part.file.closures:
        if closure != part.closure and (motion := _solved(evidence.solved.ends, closure=closure)):
            words = f"the car is closed as {closure}, where the scene asks for {part.closure}"
            yield Hypothesis(closure, words, evidence.by(motion), whole=True)


def other_assemblies(evidence: Evidence) -> Iterator[Hypothesis]:
    """Places that keep every length of the drawing at the same inputs, elsewhere, from some instant on.

    Whoever draws the car as it stands there draws the same links. So that drawing is solved for the same
    inputs: if the given places are that car's at every instant, they are another assembly of ours.
    """
    scene, topology = evidence.scene, evidence.scene.mechanism.topology
    placed = {row[1]: row for row in evidence.given if kind_of(row) == "point" and order(row) == 0}
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
    chassis = ChassisMotion.of(mechanism := scene_mechanism(scene), scene.functions)
    there = np.stack([evidence.given[placed[name]][first] for name in free]) - mechanism.origin
    when = np.full(len(free), evidence.times[first])
    pose = drawn | dict(zip(free, chassis.taken_back(when, there) + mechanism.origin, strict=True))
    plain = scene.mechanism.plain(())
    # Of every body: a point that only rides on it has its place there too, and misdrawn it is another car.
    moving = [points for body, points in plain["bodies"].items() if body != CHASSIS]
    links = {*map(tuple, plain["rods"].values()), *(ends for p in moving for ends in combinations(p, 2))}
    closed = {name: place * mechanism.unit for name, place in mechanism.places(mechanism.drawn).items()}
    missed = [np.linalg.norm(pose[a] - pose[b]) - np.linalg.norm(closed[a] - closed[b]) for a, b in links]
    motion = None
    if np.abs(missed).max() <= KEPT * size:
        points = {name: tuple(place.tolist()) for name, place in pose.items()}
        motion = _solved(evidence.solved.ends, points=points)
    if motion is None:
        return
    numbers = motion.at(evidence.times).numbers
    rows = {}
    for row in evidence.held:
        if row[1] in numbers[row[0]]:
            value = np.array(numbers[row[0]][row[1]])
            value[:first] = evidence.held[row][:first]
            # The drawing is made of given numbers: they are off twice, as it and at each instant.
            rows[row] = (value, 4.0 * evidence.rounded(row, value))
    # Other inputs keep all lengths too, and from the first pose on they are no motion of ours.
    left = [np.abs(evidence.given[row] - rows[row][0]).max() for row in placed.values() if row in rows]
    if max(left) <= KEPT * size:
        since = "" if first == 0 else f" from t = {evidence.times[first]:.6g} s on"
        words = f"another assembly of the same links{since}: all {len(links)} lengths are kept"
        yield Hypothesis("branch", words, rows, whole=True)
