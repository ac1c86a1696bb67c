"""The relative-coordinate model as a formulation. It gets a flat mechanism and inputs, and nothing solved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.errors import SceneError
from pointcoord.numerics.rounding import EPS
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import Scene
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import asked_numbers, per_second
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Accuracy, AccuracyError, FormulationError, Solution
from validate.relative.errors import InputError, PoseError, RelativeError
from validate.spanning_tree.chassis import ChassisMotion

try:
    from validate.relative.follow import Poses
    from validate.relative.model import Model, build
except ModuleNotFoundError as error:
    raise MissingPackage("relative", error) from None

Array = NDArray[np.float64]
Arrays = Mapping[str, Array]


class RelativeCoordinates:
    """Joint coordinates of a tree with loop closures, in Pinocchio."""

    name = "relative"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene; what it claims of its accuracy is the model's own estimate (`relative.accuracy`).

        Raises:
            FormulationError: the model refuses the scene, or does not know the error of a number.
        """
        inputs = {name: rates(law, scene.instants) for name, law in scene.inputs.items()}
        try:
            _require_finite(inputs)
            model = model_of(scene)
            require_the_drawn_car(scene, model)
            reading = _Reading(scene, model, inputs)
            try:
                return reading.solution(model.poses(inputs, scene.instants))
            except PoseError as error:
                raise FormulationError(self.name, error, partial(reading.partial, error)) from error
        except (RelativeError, SceneError, AccuracyError) as error:
            raise FormulationError(self.name, error) from error


def model_of(scene: Scene) -> Model:
    """The model of a scene's mechanism.

    Raises:
        RelativeError: its hardpoints make no mechanism, or the drawing does not close.
    """
    return build(scene.mechanism.plain(tuple(scene.inputs)))


def require_the_drawn_car(scene: Scene, model: Model) -> None:
    """Refuse a drawing that this model's own closing makes another car of, as the other models do.

    Raises:
        SceneError: a point moves by more than is allowed.
    """
    if scene.mechanism.closure != "drawn":
        return
    corners = np.array(list(scene.mechanism.points.values()))
    movement = model.closing
    point = max(movement, key=lambda name: movement[name])
    limit = ALLOWED * float(np.ptp(corners, axis=0).max())
    if movement[point] > limit:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"closing the drawing moves {point} by {movement[point]:.3g} mm: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {limit:.3g} mm; draw the points that miss where they "
            "belong",
        )


@dataclass(frozen=True)
class _Reading:
    """How the model's answer is read as a solution.

    Attributes:
        inputs: value, rate and acceleration by name, (N, 3).
    """

    scene: Scene
    model: Model
    inputs: Mapping[str, Array]

    def solution(self, poses: Poses) -> Solution:
        """All that was asked for, at the instants that were solved.

        Raises:
            PoseError: a pose is too near to a fold.
            AccuracyError: the model does not know the error of a number.
        """
        model, count = self.model, len(poses.q)
        inputs = {name: array[:count] for name, array in self.inputs.items()}
        motion = model.rates(poses, inputs)
        known = model.deviations(poses, motion)
        chassis = ChassisMotion.of(self.scene.mechanism.plain(tuple(self.scene.inputs)), inputs)
        turn = None if chassis is None else chassis.turn[0]
        numbers, claims = model.numbers(poses, motion, turn), model.claims(poses, motion, known, turn)
        if chassis is not None:
            with np.errstate(over="ignore"):  # what is too large has no claim either
                numbers, claims = chassis.moved(numbers), chassis.bounds(numbers, claims)
        asked = asked_numbers(self.scene)
        found, accuracy = {}, {}
        for quantity, names in asked.items():
            found[quantity] = _of(names, numbers[quantity])
            accuracy[quantity] = _at_least(quantity, found[quantity], _of(names, claims[quantity]))
        return Solution(
            RelativeCoordinates.name,
            self.scene.instants[:count],
            found,
            Accuracy(known.condition, accuracy),
        )

    def partial(self, error: PoseError) -> Solution | None:
        """What was solved before an error, as far as the model knows its errors."""
        if error.partial is None:
            return None
        try:
            return self.solution(error.partial)
        except (RelativeError, AccuracyError):
            return None


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


def _of(names: Sequence[str], arrays: Arrays) -> dict[str, Array]:
    return {name: arrays[name] for name in names if name in arrays}


def _at_least(quantity: str, numbers: Arrays, claims: Arrays) -> Arrays:
    """Claims; of rates of points or bodies EPS of the largest one of its kind at least.

    Rounding in one unknown of a system of equations is seen in all (Higham, ch. 9).
    """
    if QUANTITIES[quantity].of == "car" or per_second(quantity) == 0 or not numbers:
        return claims
    least = EPS * np.max([np.abs(rate).max(axis=-1, keepdims=True) for rate in numbers.values()], axis=0)
    return {name: np.maximum(claim, least) for name, claim in claims.items()}
