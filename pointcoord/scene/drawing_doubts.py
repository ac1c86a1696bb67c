"""What looks wrong with a drawing although it can be solved: units, signs and sides mistaken, in words.

No rule here refuses anything: a car may be odd. Each says what is odd, with its value, and what it may mean.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.topology import Topology

Array = NDArray[np.float64]

SMALLEST, LARGEST = 50.0, 20_000.0  # mm: no suspension is smaller, and no car longer


def drawing_doubts(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> tuple[str, ...]:
    """What looks wrong, in the order of how much it changes.

    Args:
        topology: of a car that gives these points.
        points: hardpoints, each (3,), mm.
    """
    doubts, told = [], set()
    size = float(np.ptp(np.array(list(points.values())), axis=0).max())
    if not SMALLEST <= size <= LARGEST:
        doubts.append(f"the car is {size:.3g} mm long: points are in mm; are these in another unit?")
    inner, centre = topology.wheel_axis
    if float(axes.component(points[centre] - points[inner], "outboard")) <= 0.0:
        doubts.append(f"{inner} lies outboard of {centre}, so the spin axis points inboard")
        told.add("wheel_axis")
    for effect in EFFECTS.values():
        doubts += effect.doubts(topology, points, axes, told)
    return tuple(doubts)
