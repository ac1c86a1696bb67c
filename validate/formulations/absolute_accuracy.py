r"""What the absolute model claims of its accuracy: its own estimates, and what reporting rounds.

The model estimates the error of every number that it gives from what its equations are rounded from, as four
standard deviations of the counted roundings, and measures lengths from a place near the car. A scene has
thousands of numbers, of which one in 16,000 goes beyond four deviations and none beyond eight, so twice the
estimate is claimed. A rate of points or bodies is claimed to eps of the largest one of its kind at least: its
equations are solved at once, and rounding in one unknown is seen in all (Higham, ch. 9). To this come
the sum of a position with that place, rounded by u of the result, and u of what the chassis does to a point.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.formulations.asked_numbers import per_second

Array = NDArray[np.float64]
Arrays = Mapping[str, Array]


def claims(quantity: str, numbers: Arrays, estimates: Arrays, chassis: Array | None) -> dict[str, Array]:
    """How far each number of a quantity may be off.

    Args:
        numbers: as reported, of every point or body that the model has, (N, 3), or of the car, (N,).
        estimates: the model's own, likewise.
        chassis: its displacement, velocity and acceleration, (N, 3, 3), mm and s; None at rest.
    """
    order, of = per_second(quantity), QUANTITIES[quantity].of
    twice = {name: 2.0 * estimate for name, estimate in estimates.items()}
    if of == "car":
        return twice
    least: Array | float = 0.0
    if order > 0:
        sizes = [np.abs(rate).max(axis=-1, keepdims=True) for rate in numbers.values()]
        least = EPS * np.max(sizes, axis=0)
    added: Array | float = 0.0
    if of == "point" and chassis is not None:
        added = EPS * np.abs(chassis[:, order])
    found = {name: np.maximum(error, least) + added for name, error in twice.items()}
    if of == "point" and order == 0:
        return {name: error + EPS * np.abs(numbers[name]) for name, error in found.items()}
    return found
