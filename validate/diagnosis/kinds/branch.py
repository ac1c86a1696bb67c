"""Another assembly: places that keep every length of the drawing, at the same inputs, elsewhere.

Whoever draws the car as it stands there draws the same links. So that drawing is solved for the same inputs:
if the given places are that car's at every instant, they are another assembly of ours.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.method import AUTO
from pointcoord.simulation import prepare_task, scene_mechanism, solve_task
from validate.diagnosis.evidence import Evidence, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, Kind

Array = NDArray[np.float64]

# Of the car's size: how far a length may be off and still be meant, and how far another assembly is away.
KEPT, ELSEWHERE = 1e-5, 1e-4


class Branch(Kind):
    """From the first instant on, or from where the given numbers leave ours."""

    name, solves, of_time = "branch", True, True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The one of the whole car."""
        topology = evidence.scene.mechanism.topology
        placed = {row[1]: row for row in evidence.given if kind_of(row) == "point" and order(row) == 0}
        if any(name not in placed for name in (*topology.moving, *topology.carried)):
            return
        drawn = {name: np.array(place) for name, place in evidence.scene.mechanism.points.items()}
        size = max(float(np.ptp([place[i] for place in drawn.values()])) for i in range(3))
        away = np.max([self._away(evidence, row) for row in placed.values()], axis=0)
        if not (away > ELSEWHERE * size).any():
            return
        first = int(np.argmax(away > ELSEWHERE * size))
        pose = drawn | {
            name: self._in_chassis(evidence, evidence.given[placed[name]][first], first)
            for name in (*topology.moving, *topology.carried)
        }
        links = {ends for constraint in topology.constraints for ends in constraint.squared_lengths}
        # What rides on a body has its place there: misdrawn, it would be another car.
        links |= {(held, name) for of in topology.bodies.values() for held in of for name in topology.carried}
        off = max(
            abs(float(np.linalg.norm(pose[a] - pose[b]) - np.linalg.norm(drawn[a] - drawn[b])))
            for a, b in links
        )
        if not off <= KEPT * size:
            return
        try:
            # No drawing check: another assembly may have its wheel inboard.
            task = prepare_task(self._scene(evidence.solved.fine, pose), AUTO)
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
        if any(
            not np.abs(evidence.given[row] - rows[row][0]).max() <= KEPT * size
            for row in placed.values()
            if row in rows
        ):
            return
        when = "" if first == 0 else f" from t = {evidence.times[first]:.6g} s on"
        words = f"another assembly of the same links{when}: all {len(links)} lengths are kept"
        yield Hypothesis(self.name, "branch", words, rows, whole=True)

    @staticmethod
    def _away(evidence: Evidence, row: tuple[str, str]) -> Array:
        return np.asarray(np.linalg.norm(evidence.given[row] - evidence.held[row], axis=-1))

    @staticmethod
    def _in_chassis(evidence: Evidence, place: Array, instant: int) -> Array:
        """Where a place of the moved car is on a chassis that stands still."""
        mechanism = scene_mechanism(evidence.scene)
        chassis, when = ChassisMotion.of(mechanism, evidence.scene.functions), evidence.times[[instant]]
        local = (place - mechanism.origin)[None]
        return np.asarray(chassis.taken_back(when, local)[0] + mechanism.origin)

    @staticmethod
    def _scene(scene: Scene, pose: dict[str, Array]) -> Scene:
        """The scene of a car that is drawn in a pose."""
        part = scene.mechanism
        points = {name: tuple(place.tolist()) for name, place in pose.items()}
        return scene.model_copy(update={"mechanism": part.model_copy(update={"points": points})})


KIND = Branch()
