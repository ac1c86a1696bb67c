"""Other people's programs in the race: the suspension in MuJoCo and in Exudyn, which the extra brings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from validate.cost.way import Setting
from validate.formulations.outside_programs import Engine, asked_of, linkage_in, require_the_drawn_car
from validate.formulations.protocol import Numbers
from validate.formulations.registry import WORDS, engine_of
from validate.peers.linkage import Inputs, Linkage
from validate.peers.motion import Poses, Rates, numbers

Array = NDArray[np.float64]
# A law is told by its Taylor coefficients: value, rate and half the acceleration.
FACTORIALS = np.array([1.0, 1.0, 2.0])
DIAL = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)


@dataclass(frozen=True)
class PeerWay:
    """A program by its formulation's name; Newton's method ends with a correction below the setting.

    Attributes:
        package: the program's, imported when a scene is prepared.
    """

    name: str
    package: str
    dense: bool = False

    @property
    def words(self) -> str:
        """What it is, in a line."""
        return WORDS[self.name]

    @property
    def settings(self) -> tuple[Setting, ...]:
        """The last correction of Newton's method, rad and sizes of the car."""
        return tuple(Setting(f"last step {value:.0e}", value) for value in DIAL)

    def prepare(self, scene: Scene, setting: Setting) -> ReadyPeer:
        """The program's model, its drawing closed and brought to where the scene starts.

        Raises:
            MissingPackage: the program is not installed.
            PeerError: the drawing cannot be closed, or the scene's start is not reached.
            SceneError: closing the drawing makes another car of it.
        """
        linkage = linkage_in(scene)
        engine = engine_of(self.name)(linkage)
        tolerance = DIAL[-1] if setting.value is None else setting.value
        closed = engine.closed(tolerance)
        require_the_drawn_car(scene, linkage, closed)
        first = linkage.inputs(_laws(scene, np.array([scene.time.start]))).driven[:, 0]
        start = engine.poses(first, tolerance, closed)
        return ReadyPeer(scene, linkage, engine, start, tolerance, plan_effects(scene.effects).derivative > 0)


@dataclass(frozen=True)
class Solved:
    """A motion as far as it is solved."""

    inputs: Inputs
    poses: Poses
    rates: Rates | None = None


@dataclass(frozen=True)
class ReadyPeer:
    """A program's model of a scene's car.

    Attributes:
        start: where the scene starts.
        moves: whether the scene asks for rates.
    """

    scene: Scene
    linkage: Linkage
    engine: Engine
    start: Poses
    tolerance: float
    moves: bool

    def solve(self, instants: Array) -> Solved:
        """Poses, each from the one before.

        Raises:
            PeerError: a pose is not reached, or is one of another assembly.
        """
        inputs = self.linkage.inputs(_laws(self.scene, instants))
        return Solved(inputs, self.engine.poses(inputs.driven[:, 0], self.tolerance, self.start))

    def rates(self, solved: Solved) -> Solved:
        """Velocities and accelerations of everything, where the scene asks for any."""
        if not self.moves:
            return solved
        _, rate, bend = solved.inputs.driven.swapaxes(0, 1)
        return replace(solved, rates=self.engine.rates(solved.poses, rate, bend))

    def output(self, solved: Solved) -> Numbers:
        """What the scene asks for, of what was solved."""
        found = numbers(self.linkage, solved.inputs.chassis, solved.poses, solved.rates)
        return asked_of(found, self.scene)

    def counts(self, solved: Solved) -> Mapping[str, int]:
        """Newton's steps, each with a Jacobian and a factorisation, and the evaluations of the loops."""
        return solved.poses.counts


def _laws(scene: Scene, instants: Array) -> dict[str, Array]:
    """Every input's value, rate and acceleration, (N, 3)."""
    return {name: f.series(instants, 2) * FACTORIALS for name, f in scene.functions.items()}


WAYS = (PeerWay("mujoco", "mujoco"), PeerWay("exudyn", "exudyn"))
