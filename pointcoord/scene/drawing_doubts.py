"""What looks wrong with a drawing although it can be solved: units, signs and sides mistaken, in words.

No rule here refuses anything: a car may be odd. Each says what is odd, with its value, and what it may mean.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

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
    doubts += [*_front_behind_rear(topology, points, axes), *_racks_outboard(topology, points, axes)]
    inner, centre = topology.wheel_axis
    if float(axes.component(points[centre] - points[inner], "outboard")) <= 0.0:
        doubts.append(f"{inner} lies outboard of {centre}, so the spin axis points inboard")
        told.add("wheel_axis")
    for effect in EFFECTS.values():
        doubts += effect.doubts(topology, points, axes, told)
    return tuple(doubts)


def _front_behind_rear(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Iterator[str]:
    """A front that lies behind a rear: axes that are not right-handed, or names mistaken."""
    front, rear = topology.front_and_rear
    ahead = float(axes.component(points[front] - points[rear], "forward"))
    if ahead < 0.0:
        forward = np.round(np.cross(axes.up, axes.right), 6) + 0.0
        lengthwise = [words for effect in EFFECTS.values() for words in effect.lengthwise]
        yield (
            f"{front} is drawn {-ahead:.4g} mm behind {rear}: by up and right the car's front lies towards "
            f"{forward.tolist()}, as in right-handed axes; are these two swapped, is right turned round, or "
            f"are your axes left-handed? {' and '.join(lengthwise)} may have the wrong sign"
        )


def _racks_outboard(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Iterator[str]:
    """What is driven by a travel and lies farther out than what it pushes: two ends mistaken."""
    pushed = {drive.pushes for drive in topology.drives}
    links = (ends for constraint in topology.constraints for ends in constraint.squared_lengths)
    for inner, outer in ((one, two) for a, b in links for one, two in ((a, b), (b, a)) if one in pushed):
        out = float(axes.component(points[inner] - points[outer], "outboard"))
        if out > 0.0:
            yield f"{inner} lies {out:.4g} mm outboard of {outer}: are they swapped?"
