"""Derivatives by hardpoints beside those of cars that are drawn anew, by central differences.

(-f(-3h) + 9 f(-2h) - 45 f(-h) + 45 f(h) - 9 f(2h) + f(3h)) / 60 h is exact up to degree 6 (Fornberg, 1988);
what it leaves out is less than how far it is from the one of the fourth order.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.arrays import Array

PLACES = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
"""Where the cars are drawn, in steps."""
SIXTH = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / 60.0
FOURTH = np.array([0.0, 1.0, -8.0, 8.0, -1.0, 0.0]) / 12.0
# Of the car's size: what is left out goes with its sixth power.
STEP = 1e-4
# Of numbers and places of designs, in sizes of what these are made of; of a sixth derivative most.
ROUNDED = 2e-13
# Differences that tell a derivative to so much of itself are sharp, and nearly all must be: of the
# derivatives that are no smaller than a part of what numbers change by where the car grows by its own size.
SHARP, SMALL, MOST = 1e-5, 1e-3, 0.9


def size_of(scene: Scene) -> float:
    """The largest side of a car, mm."""
    return float(np.ptp(list(scene.mechanism.points.values()), axis=0).max())


def hold_to_designs(
    numbers: Mapping[str, Mapping[str, Array]],
    derivatives: Mapping[str, Mapping[str, Array]],
    designs: Mapping[str, Mapping[str, Array]],
    size: float,
) -> None:
    """Hold derivatives along one direction, per mm, to cars that are drawn STEP * size * PLACES along it.

    Args:
        numbers: of the car as drawn, by quantity and name, (...); where there is none nothing is held.
        derivatives: likewise. designs: (PLACES, ...).
        size: of the car, mm.
    """
    step, sharp = STEP * size, list[bool]()
    for quantity, of in numbers.items():
        # Numbers are rounded like the lengths and angles of the car, and like others of their kind.
        unit = QUANTITIES[quantity].unit
        kind = max((float(np.abs(np.nan_to_num(other)).max()) for other in of.values()), default=0.0)
        scale = max(size ** (unit.startswith("mm") - unit.endswith("/mm")), kind)
        for name, number in of.items():
            ours, values = derivatives[quantity][name], designs[quantity][name]
            known = np.isfinite(number) & np.isfinite(values).all(axis=0)
            ours, sixth, fourth = (
                each[known] for each in (ours, *(np.tensordot(w, values, 1) / step for w in (SIXTH, FOURTH)))
            )
            room = np.abs(sixth - fourth) + ROUNDED * scale / step
            assert (np.abs(ours - sixth) <= room).all(), (quantity, name, ours, sixth, room)
            sharp += (room <= SHARP * np.abs(ours))[np.abs(ours) * size > SMALL * scale].tolist()
    assert np.mean(sharp) > MOST, np.mean(sharp)
