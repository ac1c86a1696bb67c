"""The drawing without units: lengths divided by the size of the mechanism, measured from its middle."""

import math
from collections.abc import Sequence

import numpy as np

from absolute.description import Axis, Model
from absolute.errors import DescriptionError
from absolute.solution import Array
from absolute.vectors import EPS

# Two points nearer than this to each other share half of their digits: rounding of the coordinates
# given turns the line between them by as much as half of its digits.
SHORTEST_AXIS = math.sqrt(EPS)

# Products of three lengths and of their squares stay normal numbers from here to LARGEST_COORDINATE.
SMALLEST_SIZE = 1e-100


class Drawing:
    """Points, body origins and directions of a model in units of its size.

    Coordinates as given subtract with one rounding of the difference, however close the points
    are; coordinates from the middle have been rounded before. So `line` subtracts those given, and
    the origin of a moving body is one of its points: its arms are such lines.

    Attributes:
        middle: mean of the drawn points, mm. Positions are measured from here, so that numbers do
            not depend on the distance of the car from its origin.
        size: largest distance of a drawn point from the middle, mm: the unit of length.
        bodies: body name -> index; the chassis is 0.
        origins: (bodies, 3) origin of each body frame, in units of size; the middle for the
            chassis. Body frames are parallel to the frame of the points in the drawing.
    """

    def __init__(self, model: Model) -> None:
        coordinates = np.array([model.points[name] for name in model.reported])
        largest = float(np.abs(coordinates).max())
        # Scaled before the mean and the norms: the smallest numbers have too few digits for them.
        unit = largest if largest > 0 else 1.0
        self.middle = (coordinates / unit).mean(axis=0) * unit
        spread = float(np.linalg.norm((coordinates - self.middle) / unit, axis=1).max())
        self.size = spread * unit
        if not self.size >= SMALLEST_SIZE:
            raise DescriptionError(
                f"the points lie within {self.size:.3g} mm, too near to zero for their products; a mechanism "
                f"of at least {SMALLEST_SIZE:g} mm is needed: draw it larger or in a smaller unit of length",
                "points",
                self.size,
            )
        if not spread > SHORTEST_AXIS:
            raise DescriptionError(
                f"the points lie within {self.size:.3g} mm at coordinates up to {largest:.3g} mm: "
                "too few digits tell them apart; draw the mechanism nearer to the origin",
                "points",
                self.size,
            )
        self._drawn = model.points
        self._given = {name: np.array(place) for name, place in model.points.items()}
        self.bodies = {name: index for index, name in enumerate((model.chassis, *model.moving))}
        self._anchors = {body: self._anchor(model.bodies[body]) for body in model.moving}
        self.origins = np.zeros((len(self.bodies), 3))
        for body, anchor in self._anchors.items():
            self.origins[self.bodies[body]] = self._from_middle(anchor)

    def line(self, start: str, end: str) -> Array:
        """From one drawn point to another, in units of size, with a relative error of eps."""
        return np.asarray((self._given[end] - self._given[start]) / self.size, dtype=float)

    def arm(self, body: str, point: str) -> Array:
        """From the origin of a body frame to one of its points, in units of size."""
        anchor = self._anchors.get(body)
        return self._from_middle(point) if anchor is None else self.line(anchor, point)

    def length(self, what: str, start: str, end: str) -> float:
        """Distance of two drawn points, in units of size; `what` names its owner in the message."""
        length = float(np.linalg.norm(self.line(start, end)))
        if length < SHORTEST_AXIS:
            raise DescriptionError(
                f"{what}: {start!r} and {end!r} are {length * self.size:.3g} mm apart; "
                f"an axis needs more than {SHORTEST_AXIS * self.size:.3g} mm: move one of them",
                start,
                length * self.size,
            )
        return length

    def direction(self, what: str, axis: Axis) -> Array:
        """Unit vector along a drawn axis; `what` names its owner in the message."""
        if isinstance(axis.toward, str):
            length = self.length(what, axis.through, axis.toward)
            return np.asarray(self.line(axis.through, axis.toward) / length, dtype=float)
        line = np.array(axis.toward, dtype=float)
        line = line / np.abs(line).max()
        return np.asarray(line / np.linalg.norm(line), dtype=float)

    def _from_middle(self, point: str) -> Array:
        return np.asarray((self._given[point] - self.middle) / self.size, dtype=float)

    def _anchor(self, points: Sequence[str]) -> str:
        # The point with the smallest product of distances to the others: an end of the shortest
        # lines of the body, and these are the ones that rounding would turn.
        def nearness(point: str) -> float:
            lengths = [math.dist(self._drawn[point], self._drawn[other]) for other in points]
            # A line of no length has no rounding either.
            return math.fsum(math.log(length) for length in lengths if length > 0)

        return min(points, key=nearness)
