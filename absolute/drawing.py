"""The drawing without units: lengths divided by the size of the mechanism, measured from its middle."""

import numpy as np

from absolute.description import Axis, Model
from absolute.errors import DescriptionError
from absolute.solution import Array

# A direction drawn between two points has a relative error of about eps * size / distance. Below
# sqrt(eps) * size it has lost half of its digits.
SHORTEST_AXIS = float(np.sqrt(np.finfo(float).eps))


class Drawing:
    """Points, body origins and directions of a model in units of its size.

    Attributes:
        middle: mean of the drawn points, mm. Everything is measured from here, so that numbers do
            not depend on the distance of the car from its origin.
        size: largest distance of a drawn point from the middle, mm: the unit of length.
        rounding: error of a drawn coordinate, in units of size.
        bodies: body name -> index; the chassis is 0.
        origins: (bodies, 3) origin of each body frame, in units of size. Body frames are parallel
            to the frame of the points in the drawing.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        coordinates = np.array(list(model.points.values()))
        # Scaled before the mean: no overflow for any finite drawing.
        largest = float(np.abs(coordinates).max())
        unit = largest if largest > 0 else 1.0
        self.middle = (coordinates / unit).mean(axis=0) * unit
        spread = float(np.linalg.norm((coordinates - self.middle) / unit, axis=1).max())
        self.size = spread * unit
        if not spread > SHORTEST_AXIS or not np.finfo(float).tiny < self.size < np.inf:
            raise DescriptionError(
                f"the points lie within {self.size:.3g} mm at coordinates up to {largest:.3g} mm: "
                "too few digits tell them apart; draw the mechanism nearer to the origin",
                "points",
                self.size,
            )
        self.rounding = float(np.finfo(float).eps) * max(1.0, largest / self.size)
        self._points = dict(zip(model.points, (coordinates - self.middle) / self.size, strict=True))
        self.bodies = {name: index for index, name in enumerate((model.chassis, *model.moving))}
        self.origins = np.array(
            [np.mean([self._points[point] for point in model.bodies[body]], axis=0) for body in self.bodies]
        )
        self.origins[0] = 0.0

    def arm(self, body: str, point: str) -> Array:
        """From the origin of a body frame to one of its points, in units of size."""
        return np.asarray(self._points[point] - self.origins[self.bodies[body]], dtype=float)

    def direction(self, what: str, axis: Axis) -> Array:
        """Unit vector along a drawn axis; `what` names its owner in the message."""
        if isinstance(axis.toward, str):
            line = self._points[axis.toward] - self._points[axis.through]
            length = float(np.linalg.norm(line))
            if length < SHORTEST_AXIS:
                raise DescriptionError(
                    f"{what}: {axis.through!r} and {axis.toward!r} are {length * self.size:.3g} mm apart; "
                    f"an axis needs more than {SHORTEST_AXIS * self.size:.3g} mm: move one of them",
                    axis.through,
                    length * self.size,
                )
            return np.asarray(line / length, dtype=float)
        line = np.array(axis.toward, dtype=float)
        line = line / np.abs(line).max()
        return np.asarray(line / np.linalg.norm(line), dtype=float)
