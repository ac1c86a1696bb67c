"""What looks wrong with a drawing although it can be solved: units, signs and sides mistaken, in words.

No rule here refuses anything: a car may be odd. Each says what is odd, with its value, and what it may mean.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects import wheel_angles as wheel

Array = NDArray[np.float64]

SMALLEST, LARGEST = (
    50.0,
    20_000.0,
)  # mm: no suspension is smaller, and no car longer
STEEPEST = 45.0  # degrees: no wheel and no steering axis leans that far
STEEPEST_BY_DEFAULT = 10.0  # of a spin axis that nobody drew


def drawing_doubts(
    points: Mapping[str, Array],
    up: Array,
    outboard: Array,
    wheel_axis: tuple[str, str],
    steering_axis: tuple[str, str],
    spin_axis_drawn: bool,
) -> tuple[str, ...]:
    """What looks wrong, in the order of how much it changes.

    Args:
        points: hardpoints, each (3,), mm.
        up, outboard: unit vectors, (3,).
        wheel_axis, steering_axis: the points that they run through, as in a topology.
        spin_axis_drawn: whether the car gives the spin axis an inner point of its own.
    """
    doubts = []
    size = float(np.ptp(np.array(list(points.values())), axis=0).max())
    if not SMALLEST <= size <= LARGEST:
        doubts.append(f"the car is {size:.3g} mm long: points are in mm; are these in another unit?")
    inner, centre = (points[name] for name in wheel_axis)
    lower, upper = (points[name] for name in steering_axis)
    if float((centre - inner) @ outboard) <= 0.0:
        doubts.append(f"{wheel_axis[0]} lies outboard of {wheel_axis[1]}, so the spin axis points inboard")
    else:
        limit = STEEPEST if spin_axis_drawn else STEEPEST_BY_DEFAULT
        doubts += _steep("camber", wheel.camber_angle(inner, centre, up, outboard), wheel_axis, limit)
    kingpin = wheel.kingpin_angle(lower, upper, up, outboard)
    doubts += _steep("kingpin angle", kingpin, steering_axis, STEEPEST)
    return tuple(doubts)


def _steep(name: str, angle: Array, line: tuple[str, str], limit: float) -> list[str]:
    degrees = float(np.degrees(angle))
    if abs(degrees) <= limit:
        return []
    ends = " to ".join(line)
    return [f"the drawn {name} is {degrees:.4g} deg, that of the line from {ends}: is one of them misdrawn?"]
