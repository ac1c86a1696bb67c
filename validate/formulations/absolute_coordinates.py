"""The absolute-coordinate model as a formulation. It gets hardpoints and inputs, and nothing solved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import QUANTITIES
from pointcoord.errors import SceneError
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import MechanismPart, Scene
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import asked_numbers, per_second
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Accuracy, AccuracyError, FormulationError, Solution

try:
    import absolute
    from validate.formulations.absolute_accuracy import claims
except ModuleNotFoundError as error:
    raise MissingPackage("absolute", error) from None

Array = NDArray[np.float64]
Arrays = Mapping[str, Array]

SLOW = 2.0**-200  # rad/s and mm/s
LONGEST = 500  # s, as a power of two whose square is still a number
LARGEST = 1e300  # mm: four times that, and sums of ten coordinates, stay finite


class AbsoluteCoordinates:
    """Bodies with poses in Pinocchio."""

    name = "absolute"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene; what it claims of its accuracy is the model's own estimate (`absolute_accuracy`).

        Raises:
            FormulationError: the model refuses the scene, or does not know the error of a number.
        """
        part, asked = scene.mechanism, asked_numbers(scene)
        inputs = {name: rates(law, scene.instants) for name, law in scene.inputs.items()}
        chassis = chassis_motion(part, inputs)
        inputs = {name: law for name, law in inputs.items() if name not in part.topology.chassis_motion}
        unit = slow_unit(inputs, chassis)
        origin = near_origin(part)
        reading = _Reading(scene.instants, asked, unit, origin, chassis)
        try:
            model = near_model(part, tuple(scene.inputs), origin)
            _require_the_drawn_car(scene, model)
            solved = absolute.solve(
                model,
                {name: _per(unit, law) for name, law in inputs.items()},
                chassis=None if chassis is None else _per(unit, chassis),
                rates=plan_effects(scene.effects).derivative > 0,
                conditions=True,
                errors=True,
                effects=_effects(asked),
            )
        except absolute.AbsoluteError as error:
            before = partial(reading.partial, self.name, error)
            raise FormulationError(self.name, error, before) from error
        try:
            return reading.solution(self.name, solved)
        except AccuracyError as error:
            raise FormulationError(self.name, error) from error


@dataclass(frozen=True)
class _Reading:
    """How the model's answer is read as a solution.

    Attributes:
        instants: at which it was asked, (N,), s.
        asked: names by quantity.
        unit: of time in which the model was told rates, (N,), s.
        origin: from which it measures, (3,), mm.
        chassis: displacement, velocity and acceleration, (N, 3, 3), mm and s; None at rest.
    """

    instants: Array
    asked: Mapping[str, Sequence[str]]
    unit: Array
    origin: Array
    chassis: Array | None

    def solution(self, who: str, solved: absolute.Solution) -> Solution:
        """All that was asked for, at the instants that were solved.

        Raises:
            AccuracyError: the model does not know the error of a number.
        """
        count = len(solved.residual)
        unit, chassis = self.unit[:count], None if self.chassis is None else self.chassis[:count]
        numbers: dict[str, Arrays] = {}
        accuracy: dict[str, Arrays] = {}
        for quantity, names in self.asked.items():
            found, estimates = (
                _per_second(unit, quantity, arrays) for arrays in _told(solved, quantity, self.origin)
            )
            claimed = claims(quantity, found, estimates, chassis)
            numbers[quantity] = {name: found[name] for name in names if name in found}
            accuracy[quantity] = {name: claimed[name] for name in names if name in claimed}
        condition = np.ones(count) if solved.condition is None else solved.condition
        return Solution(who, self.instants[:count], numbers, Accuracy(condition, accuracy))

    def partial(self, who: str, error: absolute.AbsoluteError) -> Solution | None:
        """What was solved before an error, as far as the model knows its errors."""
        if error.partial is None:
            return None
        try:
            return self.solution(who, error.partial)
        except AccuracyError:
            return None


def chassis_motion(part: MechanismPart, inputs: Mapping[str, Array]) -> Array | None:
    """What the inputs that displace the chassis come to, (N, 3, 3), mm and s; None if there are none."""
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


def _effects(asked: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """What the scene asks for and the model calls effects, which are numbers of the whole car."""
    wanted = (name for quantity, names in asked.items() if QUANTITIES[quantity].of == "car" for name in names)
    return tuple(name for name in wanted if name in absolute.EFFECTS)


def _told(solved: absolute.Solution, quantity: str, origin: Array) -> tuple[Arrays, Arrays]:
    """The model's numbers of a quantity and what it says of their errors; none of what it does not know."""
    if QUANTITIES[quantity].of == "car":
        return solved.effects, solved.effect_errors
    # It calls the quantities of points and bodies as pointcoord does.
    numbers, errors = (getattr(solved, name, {}) for name in (quantity, f"{quantity}_error"))
    is_place = QUANTITIES[quantity].of == "point" and per_second(quantity) == 0
    return (_moved(numbers, origin) if is_place else numbers), errors


def _require_the_drawn_car(scene: Scene, model: absolute.Model) -> None:
    """Refuse a drawing that this model's own closing makes another car of, as pointcoord does with its own.

    Raises:
        SceneError: a point moves by more than is allowed.
    """
    if scene.mechanism.closure != "drawn":
        return
    movement = absolute.close_drawing(model).movement
    point = max(movement, key=lambda name: movement[name])
    limit = ALLOWED * extent(scene.mechanism)
    if movement[point] > limit:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"closing the drawing moves {point} by {movement[point]:.3g} mm: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {limit:.3g} mm; draw the points that miss where they "
            "belong",
        )


def slow_unit(inputs: Mapping[str, Array], chassis: Array | None) -> Array:
    """Unit of time in which rates are told to the model, a power of two at each instant, (N,), s.

    The model squares rates and their errors, and the square of a number below 1e-154 is lost. So where all
    inputs are slower than SLOW, time is counted in units in which they are not; elsewhere in seconds.
    """
    count = len(next(iter(inputs.values())))
    fastest, shift = np.zeros(count), np.zeros(count)
    for law in inputs.values():
        fastest = np.maximum(fastest, np.maximum(np.abs(law[:, 1]), np.sqrt(np.abs(law[:, 2]))))
    if chassis is not None:
        shift = np.abs(chassis[:, 1:]).max(axis=(1, 2))
    slow = (fastest > 0.0) & (fastest < SLOW)
    exponent = np.minimum(-np.frexp(np.where(slow, fastest, 1.0))[1], LONGEST)
    # What moves the chassis is added by the model, and must not overflow in such units.
    return np.asarray(np.where(slow & (shift < SLOW), np.ldexp(1.0, exponent), 1.0))


def _per(unit: Array, series: Array) -> Array:
    """Value, rate and acceleration, (N, 3, ...), per another unit of time."""
    if (unit == 1.0).all():
        return series
    factor = unit.reshape(-1, *(1,) * (series.ndim - 2))
    return np.stack([series[:, 0], series[:, 1] * factor, series[:, 2] * factor * factor], axis=1)


def _per_second(unit: Array, quantity: str, arrays: Arrays) -> Arrays:
    """Rates, or their errors, per second again."""
    if (unit == 1.0).all():
        return arrays
    divisor = unit ** per_second(quantity)
    return {name: array / divisor.reshape(-1, *(1,) * (array.ndim - 1)) for name, array in arrays.items()}


def _moved(position: Arrays, origin: Array) -> dict[str, Array]:
    return {name: place + origin for name, place in position.items()}


def extent(part: MechanismPart) -> float:
    """Size of the car: the longest side of the box around its points, mm."""
    corners = np.array(list(part.points.values()))
    with np.errstate(over="ignore"):
        return float((corners.max(axis=0) - corners.min(axis=0)).max())


def near_model(part: MechanismPart, driven: Sequence[str], origin: Array) -> absolute.Model:
    """The mechanism with its points measured from a place near the car, mm.

    Raises:
        absolute.DescriptionError: the model refuses its description.
    """
    plain = part.plain(driven)
    near = {name: (np.array(point) - origin).tolist() for name, point in plain["points"].items()}
    return absolute.compile({**plain, "points": near})


def near_origin(part: MechanismPart) -> Array:
    """A place near the car from which its points are measured without rounding, shape (3,), mm.

    The model returns positions, and an angle between points that were rounded far away would be off by as
    much. On a grid of powers of two above four sizes the difference is exact; 0 near the user's origin.
    """
    size = extent(part)
    if not 0.0 < size < LARGEST:
        return np.zeros(3)  # the model refuses such a car itself
    grid = 4.0 * np.ldexp(1.0, np.frexp(size)[1])
    middle = np.array(list(part.points.values())).mean(axis=0)
    return np.asarray(np.trunc(middle / grid) * grid + 0.0)
