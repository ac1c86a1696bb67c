r"""What the absolute model claims of its accuracy: its own estimates, and what reporting rounds.

The model estimates the error of every point's and body's motion from what its equations are rounded from,
as four standard deviations of the counted roundings, and measures lengths from a place near the car. A
scene has thousands of numbers, of which one in 16,000 goes beyond four deviations and none beyond eight, so
twice the estimate is claimed. A rate is claimed to eps of the largest one of its kind at least: its equations
are solved at once, and rounding in one unknown is seen in all (Higham, ch. 9). To this come the sum with
that place, rounded by u of the result, and the chassis' displacement along `up`, u of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import absolute
from validate.formulations.protocol import Accuracy

Array = NDArray[np.float64]
Arrays = Mapping[str, Array]

EPS = float(np.finfo(float).eps)


def claims(
    solved: absolute.Solution,
    position: Arrays,
    chassis: Array | None,
) -> Accuracy:
    """The claims for a solution.

    Args:
        position: as reported, from the user's origin, (N, 3), mm.
        chassis: displacement, velocity and acceleration of the chassis, (N, 3, 3), mm and s; None at rest.
    Raises:
        AccuracyError: the model does not know the error of a number.
    """
    count = len(next(iter(position.values())))
    solved = _twice(solved)
    moved = np.zeros((3, count, 3)) if chassis is None else EPS * np.abs(np.moveaxis(chassis, 1, 0))
    return Accuracy(
        condition=np.ones(count) if solved.condition is None else solved.condition,
        position={
            name: error + moved[0] + EPS * np.abs(position[name])
            for name, error in solved.position_error.items()
        },
        velocity=_at_least(solved.velocity, solved.velocity_error, moved[1]),
        acceleration=_at_least(solved.acceleration, solved.acceleration_error, moved[2]),
        angular_velocity=_at_least(solved.angular_velocity, solved.angular_velocity_error),
        angular_acceleration=_at_least(solved.angular_acceleration, solved.angular_acceleration_error),
        wheel=dict(solved.effect_errors),
    )


def _at_least(rates: Arrays, errors: Arrays, added: Array | float = 0.0) -> dict[str, Array]:
    """Errors not below eps of the largest rate of all points or bodies at the instant, and what is added."""
    if not errors:
        return {}
    sizes = [np.abs(rate).max(axis=-1, keepdims=True) for rate in rates.values()]
    least = EPS * np.max(sizes, axis=0)
    return {name: np.maximum(error, least) + added for name, error in errors.items()}


def _twice(solved: absolute.Solution) -> absolute.Solution:
    """The solution with twice its estimates."""

    def twice(estimates: Arrays) -> dict[str, Array]:
        return {name: 2.0 * estimate for name, estimate in estimates.items()}

    return replace(
        solved,
        position_error=twice(solved.position_error),
        velocity_error=twice(solved.velocity_error),
        acceleration_error=twice(solved.acceleration_error),
        angular_velocity_error=twice(solved.angular_velocity_error),
        angular_acceleration_error=twice(solved.angular_acceleration_error),
        rotation_error=twice(solved.rotation_error),
        effect_errors=twice(solved.effect_errors),
    )
