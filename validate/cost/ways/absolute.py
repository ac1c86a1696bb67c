"""The absolute-coordinate model, without the conversion of its accuracy to error bounds.

The set-up compiles the bodies and constraints, and assembles the drawing.
"""

from __future__ import annotations

from pointcoord import Scene
from validate.arrays import Array
from validate.cost.way import Solve, Way, laws_at
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.modelled import asked_of
from validate.formulations.protocol import Numbers


def in_bodies(scene: Scene, _: float | None) -> Solve:
    """Poses of rigid bodies in Pinocchio."""
    # Imported here: Pinocchio may be missing.
    from validate.formulations.absolute_coordinates import found_of, solver_of

    solved_at, asked = solver_of(scene), asked_numbers(scene)

    def solve(instants: Array) -> Numbers:
        return asked_of(found_of(solved_at(laws_at(scene, instants)), asked), scene)

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
