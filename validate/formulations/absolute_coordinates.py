"""The absolute-coordinate model as a formulation. It gets hardpoints and inputs, but no solved numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import QUANTITIES, plan_effects
from pointcoord.errors import SceneError
from pointcoord.scene.scene_file import Scene
from validate.arrays import Array
from validate.extras import needing
from validate.formulations.asked_numbers import asked_numbers, asked_of_the_car, is_force
from validate.formulations.modelled import Problem, require_the_drawn_car
from validate.formulations.protocol import AccuracyError, Numbers, Solution, refusing

with needing("absolute"):
    import absolute


class AbsoluteCoordinates:
    """Rigid bodies with poses, in Pinocchio."""

    name = "absolute"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene.

        Raises:
            FormulationError: the model refuses the scene, or a pose is too near a fold.
        """
        problem, asked = Problem.of(scene), asked_numbers(scene)

        def solution(solved: absolute.Solution) -> Solution:
            return problem.solution(self.name, found_of(solved, asked), solved.accuracy)

        with refusing(self.name, absolute.AbsoluteError, SceneError, AccuracyError, partial=solution):
            return solution(solver_of(scene)(problem.laws))


def solver_of(scene: Scene) -> Callable[[Mapping[str, Array]], absolute.Solution]:
    """The function that solves a scene's mechanism for inputs, (N, orders); the drawing is assembled once.

    It computes the effects that the scene asks for, as far as the model has them.

    Raises:
        AbsoluteError: the mechanism cannot be compiled or assembled.
        SceneError: the drawing becomes a different car when it is closed.
    """
    part = scene.mechanism
    model = absolute.compile(part.plain(tuple(scene.inputs)))
    if part.closure == "drawn":
        require_the_drawn_car(scene, absolute.close_drawing(model).movement)
    known = absolute.effects_in(model)
    return partial(
        absolute.Assembled(model).solve,
        rates=plan_effects(scene.effects).derivative > 0,
        effects=[name for name in asked_of_the_car(scene) if name in known],
        loads=any(map(is_force, asked_numbers(scene))),
    )


def found_of(solved: absolute.Solution, asked: Mapping[str, Sequence[str]]) -> Numbers:
    """The model's numbers by quantity; its names for quantities of points and bodies are pointcoord's."""
    numbers: Numbers = {
        quantity: getattr(solved, quantity, solved.effects if QUANTITIES[quantity].of == "car" else {})
        for quantity in asked
    }
    states = {n: of for n, of in zip(STATES, solved.derivatives, strict=False) if n in ("position", *asked)}
    return {**numbers, **states}
