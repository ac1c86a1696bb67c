"""The relative-coordinate model as a formulation. It gets a flat mechanism and inputs, and nothing solved."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import SceneError
from pointcoord.scene.scene_file import Scene
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import asked_of_the_car
from validate.formulations.modelled import Found, Problem, require_the_drawn_car
from validate.formulations.protocol import AccuracyError, FormulationError, Solution
from validate.relative.errors import InputError, PoseError, RelativeError
from validate.spanning_tree.chassis import ChassisMotion

try:
    from validate.relative.follow import Poses
    from validate.relative.model import Model, build
except ModuleNotFoundError as error:
    raise MissingPackage("relative", error) from None

Array = NDArray[np.float64]


class RelativeCoordinates:
    """Joint coordinates of a tree with loop closures, in Pinocchio."""

    name = "relative"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene.

        Raises:
            FormulationError: the model refuses the scene, or a pose is too near to a fold.
        """
        problem = Problem.of(scene)

        def solution(model: Model, poses: Poses) -> Solution:
            return problem.solution(self.name, _found(problem, model, poses))

        def partial(error: PoseError) -> Solution | None:
            try:
                return None if error.partial is None else solution(model, error.partial)
            except (RelativeError, AccuracyError):
                return None

        try:
            _require_finite(problem.laws)
            model = model_of(scene)
            require_the_drawn_car(scene, model.closing)
            return solution(model, model.poses(problem.laws, scene.instants))
        except PoseError as error:
            before = error
            raise FormulationError(self.name, error, lambda: partial(before)) from error
        except (RelativeError, SceneError, AccuracyError) as error:
            raise FormulationError(self.name, error) from error


def model_of(scene: Scene) -> Model:
    """The model of a scene's mechanism.

    Raises:
        RelativeError: its hardpoints make no mechanism, or the drawing does not close.
    """
    return build(scene.mechanism.plain(tuple(scene.inputs)))


def _found(problem: Problem, model: Model, poses: Poses) -> Found:
    """All numbers of the instants that were solved.

    Raises:
        PoseError: a pose is singular, or does not hold a row that is left out.
    """
    inputs = {name: array[: len(poses.q)] for name, array in problem.laws.items()}
    model.require_left_out(poses, inputs)
    chassis = ChassisMotion.of(problem.scene.mechanism.plain(tuple(problem.scene.inputs)), inputs)
    wanted = asked_of_the_car(problem.scene)
    numbers = model.numbers(poses, model.rates(poses, inputs), inputs, wanted)
    with np.errstate(over="ignore"):  # what is too large has no claim either
        return Found(numbers if chassis is None else chassis.moved(numbers), model.accuracy(poses))


def _require_finite(inputs: Mapping[str, Array]) -> None:
    """Refuse an input that overflows, or one of its rates.

    Raises:
        InputError: it is not finite.
    """
    for name, series in inputs.items():
        wrong = ~np.isfinite(series).all(axis=1)
        if wrong.any():
            first = int(np.argmax(wrong))
            value = series[first][~np.isfinite(series[first])][0]
            raise InputError(name, float(value), "finite values and rates", first)
