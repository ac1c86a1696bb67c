"""The absolute-coordinate model, without the conversion of its accuracy to error bounds.

The set-up compiles the bodies and constraints, and assembles the drawing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from validate.cost.way import Answer, Solve, Way, laws_at
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.modelled import asked_of

Array = NDArray[np.float64]


def in_bodies(scene: Scene, _: float | None) -> Solve:
    """Poses of rigid bodies in Pinocchio."""
    import absolute
    from validate.formulations.absolute_coordinates import effects_in, found_of

    part, asked = scene.mechanism, asked_numbers(scene)
    model = absolute.compile(part.plain(tuple(scene.inputs)))
    assembled, (effects, loads) = absolute.Assembled(model), effects_in(scene, model)
    rates = plan_effects(scene.effects).derivative > 0

    def solve(instants: Array) -> Answer:
        solved = assembled.solve(laws_at(scene, instants), rates, effects=effects, loads=loads)
        numbers = asked_of(found_of(solved, asked), scene)
        return Answer(numbers, {"newton_steps": int(solved.iterations.sum())})

    return solve


WAYS = (
    Way(
        "absolute",
        "poses of rigid bodies (absolute coordinates), with Pinocchio",
        in_bodies,
        values=(None,),
        package="pinocchio",
    ),
)
