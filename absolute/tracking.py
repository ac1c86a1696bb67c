"""Through the instants of a motion, from each pose to the next by the one follower (see `continuation`).

What is found lies a small correction from the exact pose and on its branch; `refine` takes all instants to
rounding together.
"""

from typing import NamedTuple

import numpy as np

from absolute.continue_to import continue_to
from absolute.mechanism import Mechanism
from absolute.newton import Pose
from absolute.solution import Array, Counts


class Found(NamedTuple):
    """Configurations close to the poses of N instants.

    Attributes:
        q: (N, configuration).
        corrections: (N,) spent on the way to each.
        signs: of the determinants on this branch, (groups,).
    """

    q: Array
    corrections: Counts
    signs: Array

    def part(self, of: slice) -> "Found":
        """Some of the instants."""
        return Found(self.q[of], self.corrections[of], self.signs)


class Tracking:
    """The way through all instants of a motion; begins with the assembled drawing."""

    def __init__(self, mechanism: Mechanism, drawn: Pose, spent: int) -> None:
        self.mechanism = mechanism
        self._drawn, self._spent = drawn, spent
        self.found = self._room(0)
        self.back_to(0)

    def back_to(self, instant: int) -> None:
        """Go on with this instant, from the assembled drawing."""
        self._here, self._values = self._drawn, self.mechanism.drawn_inputs.tolist()
        self._instant = instant

    def advance(self, values: list[list[float]]) -> Found:
        """Configurations for further instants, by their inputs (N, inputs).

        Raises:
            UnreachableError, SingularError: at the first instant without a pose; `found` holds the
                configurations before it.
        """
        every = self._room(len(values))
        self.found = every.part(slice(0))
        for place, goal in enumerate(values):
            self._here, spent = continue_to(self.mechanism, self._here, self._values, goal, self._instant)
            every.q[place], every.corrections[place] = self._here.q, spent + self._spent
            self._values, self._spent = goal, 0
            self._instant += 1
            self.found = every.part(slice(place + 1))
        return self.found

    def _room(self, count: int) -> Found:
        return Found(
            np.empty((count, self.mechanism.pin_model.nq)),
            np.zeros(count, dtype=np.int64),
            self._drawn.signs,
        )
