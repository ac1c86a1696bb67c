"""The same links put together otherwise: closed otherwise than the scene asks for, or another assembly."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.method import AUTO
from pointcoord.simulation import prepare_task, scene_mechanism, solve_task
from validate.diagnosis.evidence import Evidence, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis

Array = NDArray[np.float64]

# Of the car's size: how far a length may be off and still be meant, and how far another assembly is away.
KEPT, ELSEWHERE = 1e-5, 1e-4


def other_closures(evidence: Evidence) -> Iterator[Hypothesis]:
    """The whole car, by each other closure of its type of suspension."""
    scene = evidence.solved.fine
    part = scene.mechanism
    for closure in part.file.closures:
        if closure == part.closure:
            continue
        mechanism = part.model_copy(update={"closure": closure})
        try:
            # No drawing check: a drawing that is asked to close otherwise may not close so by itself.
            motion = solve_task(
                prepare_task(scene.model_copy(update={"mechanism": mechanism, "points": None}), AUTO)
            )
        except PointcoordError:
            continue
        words = f"the car is closed as {closure}, where the scene asks for {part.closure}"
        # Closed otherwise, a car may have the lengths of another assembly of it, which is less likely.
        yield Hypothesis(closure, words, evidence.by(motion), cost=0.9, whole=True)


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
    away = np.max(
        [np.linalg.norm(evidence.given[row] - evidence.held[row], axis=-1) for row in placed.values()], axis=0
    )
    if not (away > ELSEWHERE * size).any():
        return
    first = int(np.argmax(away > ELSEWHERE * size))
    pose = drawn | {
        name: _on_a_still_chassis(evidence, evidence.given[placed[name]][first], first) for name in free
    }
    links = {ends for constraint in topology.constraints for ends in constraint.squared_lengths}
    # What rides on a body has its place there: misdrawn, it would be another car.
    links |= {(held, name) for of in topology.bodies.values() for held in of for name in topology.carried}
    kept = [abs(_apart(pose, *link) - _apart(drawn, *link)) <= KEPT * size for link in links]
    if not all(kept):
        return
    points = {name: tuple(place.tolist()) for name, place in pose.items()}
    mechanism = scene.mechanism.model_copy(update={"points": points})
    try:
        # No drawing check: another assembly may have its wheel inboard.
        task = prepare_task(evidence.solved.fine.model_copy(update={"mechanism": mechanism}), AUTO)
        numbers = solve_task(task).at(evidence.times).numbers
    except PointcoordError:
        return
    rows = {}
    for row in evidence.held:
        if row[1] in numbers[row[0]]:
            value = np.array(numbers[row[0]][row[1]])
            value[:first] = evidence.held[row][:first]
            # The drawing is made of given numbers: they are off twice, as it and at each instant.
            rows[row] = (value, 4.0 * evidence.rounded(row, value))
    # Other inputs keep all lengths too, and from the first pose on they are no motion of ours.
    if all(
        np.abs(evidence.given[row] - rows[row][0]).max() <= KEPT * size
        for row in placed.values()
        if row in rows
    ):
        when = "" if first == 0 else f" from t = {evidence.times[first]:.6g} s on"
        words = f"another assembly of the same links{when}: all {len(links)} lengths are kept"
        yield Hypothesis("branch", words, rows, whole=True)


def _apart(places: Mapping[str, Array], one: str, other: str) -> float:
    return float(np.linalg.norm(places[one] - places[other]))


def _on_a_still_chassis(evidence: Evidence, place: Array, instant: int) -> Array:
    """Where a place of the moved car is on a chassis that stands still."""
    mechanism = scene_mechanism(evidence.scene)
    chassis, when = ChassisMotion.of(mechanism, evidence.scene.functions), evidence.times[[instant]]
    local = (place - mechanism.origin)[None]
    return np.asarray(chassis.taken_back(when, local)[0] + mechanism.origin)
