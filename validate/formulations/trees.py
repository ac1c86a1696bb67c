"""The mechanism as a tree of joints with loops, in Pinocchio (relative coordinates) and in outside programs.

MuJoCo and Exudyn are outside witnesses, which share no mechanics with any of ours.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pointcoord import Scene, SceneError
from validate.errors import NoAnswer
from validate.formulations.asked_numbers import asked_of_the_car
from validate.formulations.modelled import Problem, require_the_drawn_car
from validate.formulations.protocol import AccuracyError, FormulationError, Solution
from validate.peers.linkage import Linkage, linkage_of
from validate.peers.motion import Poses
from validate.peers.motion import numbers as numbers_of
from validate.peers.program import Program

# Rad and car sizes: far above rounding, and its square far below. A correction that small leaves none.
TOLERANCE = 1e-10


def linkage_in(scene: Scene) -> Linkage:
    """The car of a scene.

    Raises:
        NoAnswer: its points make no linkage.
    """
    return linkage_of(scene.mechanism.plain(tuple(scene.inputs)))


@dataclass(frozen=True)
class InTree:
    """A program as a formulation.

    Attributes:
        program: makes a linkage one of the program's own models.
    """

    name: str
    program: Callable[[Linkage], Program]

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: a pose is not reached, or the drawing is no such car.
        """
        problem = Problem.of(scene)

        def solution(poses: Poses) -> Solution:
            known = inputs.first(len(poses.inputs))
            with np.errstate(over="ignore"):  # what is too large has no claim either
                rates = program.rates(poses, known.series)
                found = numbers_of(linkage, known, poses, rates, asked_of_the_car(scene))
            return problem.solution(self.name, found, linkage.accuracy(poses.last_step))

        def partial(before: Poses | None) -> Solution | None:
            try:
                return None if before is None else solution(before)
            except NoAnswer:
                return None

        try:
            linkage = linkage_in(scene)
            inputs = linkage.inputs({name: law[:, :3] for name, law in problem.laws.items()})
            program = self.program(linkage)
            closed = program.closed(TOLERANCE)
            require_the_drawn_car(scene, linkage.moved(closed.places))
            # An input that is far too large leads to no pose, which is found out by overflow.
            with np.errstate(over="ignore", invalid="ignore"):
                poses = program.poses(inputs.values, TOLERANCE, closed)
            return solution(poses)
        except NoAnswer as error:
            before = error.partial
            raise FormulationError(self.name, error, lambda: partial(before)) from error
        except (SceneError, AccuracyError) as error:
            raise FormulationError(self.name, error) from error
