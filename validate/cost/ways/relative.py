"""The relative-coordinate model, without its claims: a tree of joints whose loops Newton's method closes.

The set-up builds the tree and closes the drawing; `solve` finds the poses and reads the points' places,
`rates` solves for the joints' rates and reads those of points and bodies; `output` reads the angles, and adds
what the chassis does. The setting is what Newton's method may leave of the loops.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import QUANTITIES
from validate.cost.way import Ready, Setting
from validate.cost.ways.inputs import chassis_motion, laws_at
from validate.cost.ways.point_coordinates import tolerance_settings
from validate.formulations.asked_numbers import asked_numbers, per_second
from validate.formulations.protocol import Numbers

if TYPE_CHECKING:
    from validate.relative.follow import Poses
    from validate.relative.model import Model

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Relative:
    """Joint coordinates in Pinocchio."""

    name: str = "relative"
    words: str = "joint coordinates of a tree with loop closures (relative coordinates), with Pinocchio"
    package: str | None = "pinocchio"
    settings: tuple[Setting, ...] = tolerance_settings()
    dense: bool = False

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Build the tree and close its loops.

        Raises:
            RelativeError: the model refuses the drawing.
        """
        from validate.formulations.relative_coordinates import model_of

        return _Ready(scene, model_of(scene.mechanism), setting.value or 0.0)


@dataclass(frozen=True)
class _Solved:
    """What is solved.

    Attributes:
        laws: of the inputs, (N, 3). poses: of the joints.
        numbers: by quantity and name, in the chassis' frame.
    """

    instants: Array
    laws: Mapping[str, Array]
    poses: Poses
    numbers: Numbers


@dataclass(frozen=True)
class _Ready:
    scene: Scene
    model: Model
    tolerance: float

    def solve(self, instants: Array) -> _Solved:
        """Find the poses, and where the points are."""
        laws = laws_at(self.scene, instants)
        poses = self.model.poses(laws, instants, self.tolerance)
        return _Solved(instants, laws, poses, {"position": self.model.positions(poses)})

    def rates(self, solved: _Solved) -> _Solved:
        """Find the joints' rates, and those of points and bodies."""
        if plan_effects(self.scene.effects).derivative == 0:
            return solved
        model, poses = self.model, solved.poses
        motion = model.rates(poses, solved.laws)
        readers = {
            "velocity": lambda: model.velocities(poses, motion),
            "acceleration": lambda: model.accelerations(poses, motion),
            "angular_velocity": lambda: model.angular_velocities(motion),
            "angular_acceleration": lambda: model.angular_accelerations(motion),
        }
        found = {
            quantity: readers[quantity]() for quantity in asked_numbers(self.scene) if quantity in readers
        }
        return replace(solved, numbers={**solved.numbers, **found})

    def output(self, solved: _Solved) -> Numbers:
        """All numbers that are asked for, with the chassis' motion."""
        chassis = chassis_motion(self.scene, solved.laws)
        told: dict[str, dict[str, Array]] = {}
        for quantity, names in asked_numbers(self.scene).items():
            of = QUANTITIES[quantity].of
            arrays = self.model.angles(solved.poses) if of == "car" else solved.numbers[quantity]
            moved = chassis[:, per_second(quantity)] if of == "point" and chassis is not None else 0.0
            told[quantity] = {name: arrays[name] + moved for name in names if name in arrays}
        return told

    def counts(self, solved: _Solved) -> Mapping[str, int]:
        """Newton's steps, each with a Jacobian and its factors, and evaluations of the loops."""
        steps, residuals = solved.poses.steps, solved.poses.evaluations
        return {"newton_steps": steps, "jacobians": steps, "factorisations": steps, "residuals": residuals}


WAYS = (Relative(),)
