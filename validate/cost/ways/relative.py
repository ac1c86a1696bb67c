"""The relative-coordinate model, without its claims: a tree of joints whose loops Newton's method closes.

The set-up builds the tree and closes the drawing. The setting is what Newton's method may leave of the loops.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from validate.cost.way import Answer, Solve, Way, laws_at
from validate.formulations.asked_numbers import asked_of_the_car
from validate.formulations.modelled import asked_of
from validate.formulations.protocol import Numbers
from validate.spanning_tree.chassis import ChassisMotion

Array = NDArray[np.float64]


def in_joints(scene: Scene, tolerance: float) -> Solve:
    """Joint coordinates in Pinocchio."""
    from validate.formulations.relative_coordinates import model_of

    model, plain = model_of(scene), scene.mechanism.plain(tuple(scene.inputs))
    moves = plan_effects(scene.effects).derivative > 0

    def solve(instants: Array) -> Answer:
        laws = laws_at(scene, instants)
        poses = model.poses(laws, instants, tolerance)
        chassis = ChassisMotion.of(plain, laws)
        found: Numbers = {"position": model.positions(poses)}
        if scene.effects:
            rates = model.rates(poses, laws) if moves else None
            found = model.numbers(poses, rates, laws, asked_of_the_car(scene))
        found = found if chassis is None else chassis.moved(found)
        return Answer(asked_of(found, scene), {"newton_steps": poses.steps, "residuals": poses.evaluations})

    return solve


WAYS = (
    Way(
        "relative",
        "joint coordinates of a tree with loop closures (relative coordinates), with Pinocchio",
        in_joints,
        package="pinocchio",
    ),
)
