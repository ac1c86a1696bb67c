"""The absolute-coordinate model as a formulation. It gets hardpoints and inputs, and nothing solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import SceneError
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import MechanismPart, Scene
from validate.extras import MissingPackage
from validate.formulations.input_rates import rates
from validate.formulations.protocol import AccuracyError, FormulationError, Solution

try:
    import absolute
    from validate.formulations.absolute_accuracy import claims
except ModuleNotFoundError as error:
    raise MissingPackage("absolute", error) from None

Array = NDArray[np.float64]

# What the scene's effect `wheel_angles` stands for.
WHEEL_ANGLES = ("camber", "kingpin")

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
        part, times, wanted = scene.mechanism, scene.instants, scene.effects
        inputs = {name: rates(law, times) for name, law in scene.inputs.items()}
        heave = inputs.pop("heave", None)
        with np.errstate(invalid="ignore"):  # the model refuses what is not finite
            chassis = None if heave is None else heave[:, :, None] * np.array(part.up)
        unit = slow_unit(inputs, chassis)
        inputs = {name: _per(unit, law) for name, law in inputs.items()}
        needs_rates = any(effect in wanted for effect in ("velocity", "acceleration", "knuckle_rates"))
        origin = near_origin(part)
        near = {name: (np.array(point) - origin).tolist() for name, point in part.points.items()}
        try:
            model = absolute.macpherson(
                near, up=part.up, right=part.right, side=part.side, closure=part.closure
            )
            _require_the_drawn_car(scene, model)
            solved = absolute.solve(
                model,
                inputs,
                chassis=None if chassis is None else _per(unit, chassis),
                rates=needs_rates,
                conditions=True,
                errors=True,
                effects=WHEEL_ANGLES,
            )
        except absolute.AbsoluteError as error:
            if isinstance(error.partial, absolute.Solution):
                error.partial = replace(error.partial, position=_moved(error.partial.position, origin))
            raise FormulationError(self.name, error) from error
        solved, position = _per_second(unit, solved), _moved(solved.position, origin)
        try:
            accuracy = claims(solved, position, chassis)
        except AccuracyError as error:
            raise FormulationError(self.name, error) from error
        return Solution(
            formulation=self.name,
            times=times,
            position=position,
            velocity=solved.velocity if "velocity" in wanted else {},
            acceleration=solved.acceleration if "acceleration" in wanted else {},
            angular_velocity=_knuckle(solved.angular_velocity, wanted),
            angular_acceleration=_knuckle(solved.angular_acceleration, wanted),
            wheel=solved.effects if "wheel_angles" in wanted else {},
            accuracy=accuracy,
        )


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
            f"at most {ALLOWED:.0%} of the car's size, {limit:.3g} mm; draw strut_rod_end on the strut axis "
            "and tie_rod_inner on the line of the rack",
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


def _per_second(unit: Array, solved: absolute.Solution) -> absolute.Solution:
    """Rates and their errors per second again."""
    if (unit == 1.0).all():
        return solved
    once = unit[:, None]
    twice = once * once

    def divided(arrays: Mapping[str, Array], divisor: Array) -> dict[str, Array]:
        return {name: array / divisor for name, array in arrays.items()}

    return replace(
        solved,
        velocity=divided(solved.velocity, once),
        velocity_error=divided(solved.velocity_error, once),
        angular_velocity=divided(solved.angular_velocity, once),
        angular_velocity_error=divided(solved.angular_velocity_error, once),
        acceleration=divided(solved.acceleration, twice),
        acceleration_error=divided(solved.acceleration_error, twice),
        angular_acceleration=divided(solved.angular_acceleration, twice),
        angular_acceleration_error=divided(solved.angular_acceleration_error, twice),
    )


def _moved(position: Mapping[str, Array], origin: Array) -> dict[str, Array]:
    return {name: place + origin for name, place in position.items()}


def _knuckle(rates_of_bodies: Mapping[str, Array], wanted: tuple[str, ...]) -> dict[str, Array]:
    return {"knuckle": rates_of_bodies["knuckle"]} if "knuckle_rates" in wanted else {}


def extent(part: MechanismPart) -> float:
    """Size of the car: the longest side of the box around its points, mm."""
    corners = np.array(list(part.points.values()))
    with np.errstate(over="ignore"):
        return float((corners.max(axis=0) - corners.min(axis=0)).max())


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
