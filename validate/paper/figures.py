"""What the paper's Figures 5 to 8 are of, from its own equations, and the printed tables' points in them.

Figures 5 and 6 are of the bouncing motion of Table 2, Figures 7 and 8 of the steering motion of Table 3: the
kingpin and camber angles in degrees, and the height of the wheel centre, over time. The tables print the
wheel centre; they print no angle, so that Figures 5 and 7 have no printed points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from validate.paper.tables import TABLE_2, TABLE_3, PrintedRow

Array = NDArray[np.float64]

INSTANTS = 131


@dataclass(frozen=True)
class Figure:
    """A figure of the paper.

    Attributes:
        number: as the paper counts. words: what it shows. unit: of its curves.
        times: s, (N,). curves: as computed, by name, (N,).
        printed: times and values of the printed table, (2, M); None where no table prints what is shown.
    """

    number: int
    words: str
    unit: str
    times: Array
    curves: Mapping[str, Array]
    printed: Array | None


def figures() -> tuple[Figure, ...]:
    """Figures 5 to 8, from the built-in scenes `bounce` and `steer`."""
    return (*_pair(5, "bounce", "S = 0", TABLE_2), *_pair(7, "steer", "theta = 90 degrees", TABLE_3))


def _pair(number: int, name: str, held: str, table: tuple[PrintedRow, ...]) -> tuple[Figure, Figure]:
    scene = Scene.load(name)
    times = np.linspace(scene.time.start, scene.time.stop, INSTANTS)
    at = simulate(scene).at(times)
    angles = {angle: np.degrees(at.wheel[angle]) for angle in ("kingpin", "camber")}
    height = at.position["wheel_centre"][:, 2]
    printed = np.array([(row.time, row.wheel_centre[2]) for row in table]).T
    return (
        Figure(number, f"kingpin and camber angles for {held}", "deg", times, angles, None),
        Figure(number + 1, f"height of the wheel centre for {held}", "mm", times, {"z10": height}, printed),
    )
