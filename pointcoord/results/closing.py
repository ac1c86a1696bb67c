"""Closing a drawing: how far its points move when it is solved at its own inputs.

If the drawn points satisfy all constraints, no point moves, up to rounding. Otherwise the solved car differs
from the drawn car by the movement of its points. The user reads how far they move, which point moves most,
and which constraints the drawing violates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot

import numpy as np

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import lengths
from pointcoord.results.read_only import ReadOnly

NOTICED = 0.1  # mm: hardpoints are drawn to a tenth of a millimetre, so a larger movement is not rounding
NOTICED_SHARE = 2e-4  # of the size: that tenth for a size of half a metre, for cars in other units than mm
ROUNDING = 1e-11  # of the size: a hundred roundings, enlarged 500 times where the pose is badly conditioned
ALLOWED = 0.01  # of the car's size: beyond this the closed drawing is another car
ANOTHER_CAR = "closing the drawing makes another car of it"


@dataclass(frozen=True)
class Closing(ReadOnly):
    """Movements of the points as a drawing closes.

    Attributes:
        movements: distance that each solved or carried point moves, by name, mm.
        misses: distance of each point from the line that it slides on, as drawn, by "POINT on the LINE", mm;
            only those above rounding.
        size: longest side of the box around the points, mm.
    """

    movements: Mapping[str, float]
    misses: Mapping[str, float]
    size: float

    @property
    def point(self) -> str:
        """The point that moves most."""
        return max(self.movements, key=lambda name: self.movements[name])

    @property
    def largest(self) -> float:
        """Largest movement of a point, mm."""
        return self.movements[self.point]

    @property
    def noticeable(self) -> bool:
        """Whether the user should be warned."""
        return self.largest > min(NOTICED, NOTICED_SHARE * self.size)

    @property
    def moves(self) -> bool:
        """Whether a point moves by more than rounding."""
        return self.largest > ROUNDING * self.size

    @property
    def changes_the_car(self) -> bool:
        """Whether the closed car counts as another car than the drawn one."""
        return self.largest > ALLOWED * self.size

    @property
    def words(self) -> str:
        """Largest movement, its point, and the constraints that the drawing violates, in one line."""
        if not self.moves:
            return f"the drawing closes: no point moves by more than {self.largest:.1g} mm"
        off = [(*name.split(" on the ", 1), miss) for name, miss in self.misses.items()]
        why = ", ".join(f"{point} lies {miss:.3g} mm off the {line}" for point, line, miss in off)
        missed = f"; as drawn, {why}" if why else ""
        return f"closing the drawing moves {self.point} by {self.largest:.3g} mm{missed}"


def closing(mechanism: Mechanism, closed: Array) -> Closing:
    """How far the points of one car's closed drawing are from where they are drawn.

    Args:
        closed: coordinates of the closed drawing, shape (size,).
    """
    topology, unit = mechanism.topology, float(mechanism.unit)
    residual = mechanism.map.residual(mechanism.drawn).tolist()
    misses = {}
    for constraint, rows in zip(topology.constraints, topology.rows_of, strict=True):
        miss = hypot(*(residual[row] for row in rows))
        # Rows are sums of a few products of coordinates below 1, hence the limit of rounding. The rows of a
        # slide are a distance only if no component is left out.
        if constraint.slide and len(rows) == len(constraint.labels) and miss > 64 * EPS:
            misses[constraint.name] = unit * miss
    moved = {name: float(far) for name, far in movements(mechanism, closed).items()}
    return Closing(moved, misses, float(car_size(mechanism)))


def movements(mechanism: Mechanism, closed: Array) -> dict[str, Array]:
    """Distance that each solved or carried point of one car or of many cars moves, by name, (...,), mm.

    Args:
        closed: coordinates of the closed drawings, shape (..., size).
    """
    topology, drawn = mechanism.topology, mechanism.drawing.vectors
    places, names = mechanism.places(closed), (*topology.moving, *topology.carried)
    moved = np.stack([places[name] - drawn[name] for name in names], axis=-2)
    far = np.asarray(mechanism.unit)[..., None] * lengths(moved)
    return {name: far[..., i] for i, name in enumerate(names)}


def car_size(mechanism: Mechanism) -> Array:
    """Longest side of the box around the drawn points, (...,), mm."""
    stack = mechanism.drawing.stacked(mechanism.topology.points)
    return np.asarray(mechanism.unit * np.ptp(stack, axis=-2).max(axis=-1))
