"""Converts axes and units of other programs to those of the scene: x rearward, y right, z up; mm.

Coordinates are decimal numbers as printed. Axes are converted by permutations and signs, so nothing is
rounded.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.errors import UsageError
from validate.hardpoint_files.contents import Place
from validate.tables.units import LENGTHS

DIRECTIONS = {
    "rearward": (1, 0, 0),
    "forward": (-1, 0, 0),
    "right": (0, 1, 0),
    "left": (0, -1, 0),
    "up": (0, 0, 1),
    "down": (0, 0, -1),
}
"""The directions of the car in the scene's axes."""
ALLOWED = "the directions of x, y and z, such as forward,left,up, of " + ", ".join(DIRECTIONS)


@dataclass(frozen=True)
class Axes:
    """The directions of a file's x, y and z."""

    directions: tuple[str, ...]

    @classmethod
    def of(cls, words: str) -> Axes:
        """Axes from text, such as `forward,left,up`.

        Raises:
            UsageError: the text does not give three directions at right angles.
        """
        found = re.findall(r"[^\s,;]+", words.lower())
        ways = [DIRECTIONS.get(word, (0, 0, 0)) for word in found]
        if len(ways) != 3 or not np.linalg.det(ways):
            raise UsageError(f"axes are {words!r}; allowed: {ALLOWED}; each axis of the car once")
        return cls(tuple(found))

    @property
    def words(self) -> str:
        """The axes in words."""
        return ", ".join(f"{axis} {word}" for axis, word in zip("xyz", self.directions, strict=True))

    @property
    def option(self) -> str:
        """The axes as the value of --axes."""
        return ",".join(self.directions)

    @property
    def right_handed(self) -> bool:
        """Whether x, y and z are right-handed."""
        return bool(np.linalg.det(self.matrix) > 0.0)

    @property
    def matrix(self) -> NDArray[np.int_]:
        """The matrix from the file's coordinates to the scene's, (3, 3)."""
        return np.array([DIRECTIONS[word] for word in self.directions]).T

    def to_scene(self, place: Place, unit: str) -> Place:
        """A position in the file's axes and unit, converted to x rearward, y right, z up, mm."""
        x, y, z = self.matrix.astype(object) @ place * LENGTHS[unit] + 0
        return x, y, z


OUR_AXES = Axes(("rearward", "right", "up"))
"""The axes of a scene."""
