"""The mechanism as a tree of joints with loops, in Pinocchio (relative coordinates), MuJoCo and Exudyn.

MuJoCo and Exudyn are independent programs: their mechanics share nothing with our models.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pointcoord import Scene, SceneError
from validate.errors import NoAnswer
from validate.formulations.asked_numbers import asked_of_the_car
from validate.formulations.modelled import Problem, require_the_drawn_car
from validate.formulations.protocol import AccuracyError, Solution, refusing
from validate.peers.motion import Motion
from validate.peers.motion import numbers as numbers_of
from validate.peers.program import Program
from validate.spanning_tree.cut import cut
from validate.spanning_tree.tree import SpanningTree

# Of Newton corrections, in rad and car sizes. It is far above rounding, and its square far below: after a
# correction of this size the next one would be less than rounding.
TOLERANCE = 1e-10


def closed_in(
    program: Callable[[SpanningTree], Program], scene: Scene, tolerance: float
) -> tuple[Program, Motion]:
    """A program's model of a scene's car, and its closed drawing.

    Args:
        program: makes the program's model of a tree.
        tolerance: size of the last Newton correction, rad and car sizes.
    Raises:
        NoAnswer: the points do not form a mechanism, or the drawing does not close.
        SceneError: the drawing becomes a different car when it is closed.
    """
    made = program(cut(scene.mechanism.plain(tuple(scene.inputs))))
    closed = made.closed(tolerance)
    require_the_drawn_car(scene, made.tree.moved(closed.linear[0, 0]))
    return made, closed


@dataclass(frozen=True)
class InTree:
    """A program as a formulation.

    Attributes:
        program: makes the program's model of a tree.
    """

    name: str
    program: Callable[[SpanningTree], Program]

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: a pose is not reached, or the drawing cannot be closed to this car.
        """
        problem = Problem.of(scene)

        def solution(motion: Motion) -> Solution:
            with np.errstate(over="ignore"):  # a number that overflows has no error bound either
                found = numbers_of(tree, laws, motion, asked_of_the_car(scene))
            return problem.solution(self.name, found, tree.accuracy(motion.last_step))

        with refusing(self.name, NoAnswer, SceneError, AccuracyError, partial=solution):
            program, closed = closed_in(self.program, scene, TOLERANCE)
            tree, laws = program.tree, {name: law[:, :3] for name, law in problem.laws.items()}
            # An input that is far too large has no pose; the program notices by overflow.
            with np.errstate(over="ignore", invalid="ignore"):
                motion = program.motion(tree.series(laws), TOLERANCE, closed)
            return solution(motion)
