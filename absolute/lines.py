"""Lines between points of a solved motion, and how far they may be off."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from absolute.description import Corner
from absolute.estimate import SUMMED, Errors
from absolute.mechanism import Mechanism
from absolute.precision import EPS
from absolute.rounding import ARM, length
from absolute.solution import Array
from absolute.turning import Turning


@dataclass(frozen=True)
class SolvedLines:
    """Lines at N instants, mm, in the axes of the frame of the points, as they are seen from the ground.

    A line between two points of one body turns with it and is nothing but turned: it is as good as the
    body's rotation R, however far the car is from its origin, |d a| <= |turn x a| + rounding of R a. A line
    is also off by no more than its two ends are; this is less where the body may turn about the line.

    Attributes:
        rotation: (N, bodies, 3, 3). origin: (N, bodies, 3), from the middle, in units of size.
        errors: estimates for the same instants.
        turns: of the chassis, one after the other; the others are in its frame.
    """

    mechanism: Mechanism
    rotation: Array
    origin: Array
    errors: Errors
    turns: Sequence[Turning] = ()

    @property
    def corner(self) -> Corner:
        """What of the linkage is the wheel, and which way the car points."""
        return self.mechanism.model.corner

    def line(self, ends: tuple[str, str]) -> Array:
        """(N, 3) from one point to another."""
        line = self._line(ends)
        for turn in self.turns:
            line = turn.seen(line[None])[0]
        return line

    def error(self, ends: tuple[str, str]) -> Array:
        """(N, 3) how far each component of that line may be off."""
        line, off = self._line(ends), self._error(ends)
        for turn in self.turns:
            line, off = turn.seen(line[None])[0], turn.error(line[None], off[None])[0]
        return off

    def _line(self, ends: tuple[str, str]) -> Array:
        drawing, body = self.mechanism.drawing, self._body_of(ends)
        if body is None:
            return self._place(ends[1]) - self._place(ends[0])
        turned: Array = self.rotation[:, drawing.bodies[body]] @ drawing.line(*ends) * drawing.size
        return turned

    def _error(self, ends: tuple[str, str]) -> Array:
        body = self._body_of(ends)
        of_places = sum((self._place_error(end) for end in ends), np.zeros(3))
        if body is None:
            return of_places
        along = np.abs(self._line(ends))
        if body == self.mechanism.model.chassis:
            return EPS * along
        turn = self.errors.rotation[body]
        turned = np.roll(turn, -1, axis=-1) * np.roll(along, -2, axis=-1)
        turned += np.roll(turn, -2, axis=-1) * np.roll(along, -1, axis=-1)
        turned += ARM * length(along)[:, None] + EPS * along
        return np.minimum(turned, of_places)

    def _body_of(self, ends: tuple[str, str]) -> str | None:
        bodies = self.mechanism.model.bodies
        return next((body for body, points in bodies.items() if set(ends) <= set(points)), None)

    def _place(self, point: str) -> Array:
        """From the middle of the drawing, without the motion of the chassis."""
        drawing = self.mechanism.drawing
        body = next(body for body in drawing.bodies if point in self.mechanism.model.bodies[body])
        index = drawing.bodies[body]
        place: Array = self.origin[:, index] + self.rotation[:, index] @ drawing.arm(body, point)
        return place * drawing.size

    def _place_error(self, point: str) -> Array:
        return np.asarray(self.errors.position[point] + SUMMED * np.abs(self._place(point)))
