"""The suspension as a spanning tree with loop closures: in Pinocchio, MuJoCo and Exudyn (extra `peers`).

The set-up makes the model of the program, closes its drawing and moves it to the scene's start. The setting
is the size of the last Newton correction of the loop closures, in rad and in car sizes.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import plan_effects
from validate.arrays import Array
from validate.cost.way import Solve, Way, laws_at
from validate.errors import NoAnswer
from validate.formulations.asked_numbers import asked_of_the_car
from validate.formulations.modelled import asked_of
from validate.formulations.protocol import Numbers
from validate.formulations.registry import OUTSIDE, WORDS, program_of
from validate.formulations.trees import closed_in
from validate.peers.motion import numbers


def in_program(name: str, scene: Scene, tolerance: float) -> Solve:
    """Solve the car in a peer program.

    Args:
        name: the formulation of the program.
        tolerance: size of the last Newton correction.
    """
    program, closed = closed_in(program_of(name), scene, tolerance)
    tree = program.tree
    first = tree.series(laws_at(scene, np.array([scene.time.start])))
    start = program.motion(first, tolerance, closed, moves=False)
    moves = plan_effects(scene.effects).derivative > 0

    def solve(instants: Array) -> Numbers:
        laws = laws_at(scene, instants)
        series = tree.series(laws)
        try:
            motion = program.motion(series, tolerance, start, moves)
        except NoAnswer as error:
            if error.instant is None:
                raise
            what = f"at t = {instants[error.instant]:.6g} s, {error.what}"
            raise NoAnswer(what, error.problem, error.allowed, instant=error.instant) from None
        return asked_of(numbers(tree, laws, motion, asked_of_the_car(scene)), scene)

    return solve


PACKAGES = {"relative": "pinocchio"}
WAYS = tuple(
    Way(
        name, WORDS[name], partial(in_program, name), setting="last step {}", package=PACKAGES.get(name, name)
    )
    for name in ("relative", *OUTSIDE)
)
