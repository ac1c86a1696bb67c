"""Other people's programs as formulations: outside witnesses, which share no mechanics with any of ours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, SceneError
from validate.formulations.asked_numbers import asked_of_the_car
from validate.formulations.modelled import Found, Problem, require_the_drawn_car
from validate.formulations.protocol import AccuracyError, FormulationError, Solution
from validate.peers.errors import PeerError
from validate.peers.linkage import Linkage, linkage_of
from validate.peers.motion import Poses, Rates
from validate.peers.motion import numbers as numbers_of

Array = NDArray[np.float64]

# Rad and car sizes: far above rounding, and its square far below. A correction that small leaves none.
TOLERANCE = 1e-10


class Engine(Protocol):
    """A linkage in somebody's program."""

    def closed(self, tolerance: float) -> Poses:
        """The drawing, closed: one pose."""
        ...

    def poses(self, driven: Array, tolerance: float, start: Poses) -> Poses:
        """Poses at driven coordinates, (N, drives), each solved from the one before."""
        ...

    def rates(self, poses: Poses, rate: Array, bend: Array) -> Rates:
        """Their rates, from those of what is driven, each (N, drives)."""
        ...


def linkage_in(scene: Scene) -> Linkage:
    """The car of a scene.

    Raises:
        PeerError: its points make no linkage.
    """
    return linkage_of(scene.mechanism.plain(tuple(scene.inputs)))


@dataclass(frozen=True)
class OutsideProgram:
    """A program as a formulation.

    Attributes:
        name: as a formulation.
        engine: makes a linkage one of the program's own models.
    """

    name: str
    engine: Callable[[Linkage], Engine]

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: a pose is not reached, or the drawing is no such car.
        """
        problem = Problem.of(scene)
        try:
            return problem.solution(self.name, self._found(problem))
        except (PeerError, SceneError, AccuracyError) as error:
            raise FormulationError(self.name, error) from error

    def _found(self, problem: Problem) -> Found:
        linkage = linkage_in(problem.scene)
        inputs = linkage.inputs(problem.laws)
        engine = self.engine(linkage)
        value, rate, bend = inputs.driven.swapaxes(0, 1)
        closed = engine.closed(TOLERANCE)
        require_the_drawn_car(problem.scene, linkage.moved(closed.places))
        poses = engine.poses(value, TOLERANCE, closed)
        wanted = asked_of_the_car(problem.scene)
        found = numbers_of(linkage, inputs, poses, engine.rates(poses, rate, bend), wanted)
        return Found(found, linkage.accuracy(poses.last_step))
