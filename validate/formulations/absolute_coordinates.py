"""The absolute-coordinate model as a formulation. It gets hardpoints and inputs, and nothing solved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.plan import plan_effects
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import QUANTITIES
from pointcoord.errors import SceneError
from pointcoord.scene.scene_file import MechanismPart, Scene
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import asked_numbers, asked_of_the_car, is_force
from validate.formulations.modelled import Found, Problem, require_the_drawn_car
from validate.formulations.protocol import AccuracyError, FormulationError, Numbers, Solution

try:
    import absolute
except ModuleNotFoundError as error:
    raise MissingPackage("absolute", error) from None

Array = NDArray[np.float64]


class AbsoluteCoordinates:
    """Bodies with poses in Pinocchio."""

    name = "absolute"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene.

        Raises:
            FormulationError: the model refuses the scene, or a pose is too near to a fold.
        """
        problem, asked = Problem.of(scene), asked_numbers(scene)
        part = scene.mechanism

        def partial(solved: absolute.Solution | None) -> Solution | None:
            try:
                return None if solved is None else problem.solution(self.name, found_of(solved, asked))
            except AccuracyError:
                return None

        try:
            model = absolute.compile(part.plain(tuple(scene.inputs)))
            if part.closure == "drawn":
                require_the_drawn_car(scene, absolute.close_drawing(model).movement)
            effects, loads = effects_in(scene, model)
            solved = absolute.solve(
                model,
                driving(model, part, problem.laws),
                chassis=chassis_motion(part, problem.laws),
                rates=plan_effects(scene.effects).derivative > 0,
                effects=effects,
                loads=loads,
            )
            return problem.solution(self.name, found_of(solved, asked))
        except absolute.AbsoluteError as error:
            before = error.partial
            raise FormulationError(self.name, error, lambda: partial(before)) from error
        except (SceneError, AccuracyError) as error:
            raise FormulationError(self.name, error) from error


def found_of(solved: absolute.Solution, asked: Mapping[str, Sequence[str]]) -> Found:
    """The model's numbers; it calls the quantities of points and bodies as pointcoord does."""
    numbers: Numbers = {
        quantity: getattr(solved, quantity, solved.effects if QUANTITIES[quantity].of == "car" else {})
        for quantity in asked
    }
    states = {n: of for n, of in zip(STATES, solved.derivatives, strict=False) if n in ("position", *asked)}
    return Found({**numbers, **states}, solved.accuracy)


def driving(model: absolute.Model, part: MechanismPart, laws: Mapping[str, Array]) -> dict[str, Array]:
    """The laws that the model itself takes: of a displacement of the chassis where heights hang on it."""
    moves = part.topology.chassis_motion.keys() - {*model.values}
    return {name: law for name, law in laws.items() if name not in moves}


def chassis_motion(part: MechanismPart, inputs: Mapping[str, Array]) -> Array | None:
    """What the inputs that displace the chassis come to, (N, orders, 3), mm and s; None if there are none."""
    up, right = np.array(part.up), np.array(part.right)
    forward = np.cross(up, right)
    directions = {
        "up": up,
        "right": right,
        "forward": forward,
        "down": -up,
        "left": -right,
        "rearward": -forward,
    }
    with np.errstate(invalid="ignore"):  # the model refuses what is not finite
        moves = [
            inputs[name][:, :, None] * directions[direction]
            for name, direction in part.topology.chassis_motion.items()
            if name in inputs
        ]
        return np.asarray(sum(moves[1:], moves[0])) if moves else None


def effects_in(scene: Scene, model: absolute.Model) -> tuple[list[str], bool]:
    """Which of a scene's numbers of the car are effects of the model, and whether it asks for forces."""
    known = absolute.effect_names(model)
    effects = [name for name in asked_of_the_car(scene) if name in known]
    return effects, any(map(is_force, asked_numbers(scene)))
