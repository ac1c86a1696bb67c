"""The axes and units of other programs, turned into the scene's: x rearward, y right, z up; mm.

Coordinates are decimal numbers as printed, and axes are turned by exchanging and negating them, so nothing is
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
"""In the scene's axes."""
ALLOWED = "the directions of x, y and z, such as forward,left,up, of " + ", ".join(DIRECTIONS)


@dataclass(frozen=True)
class Axes:
    """Where the x, y and z of a file point."""

    directions: tuple[str, ...]

    @classmethod
    def of(cls, words: str) -> Axes:
        """Axes from their words.

        Raises:
            UsageError: they are not three directions at right angles.
        """
        found = re.findall(r"[^\s,;]+", words.lower())
        ways = [DIRECTIONS.get(word, (0, 0, 0)) for word in found]
        if len(ways) != 3 or not np.linalg.det(ways):
            raise UsageError(f"axes are {words!r}; allowed: {ALLOWED}; each line of the car once")
        return cls(tuple(found))

    @property
    def words(self) -> str:
        """The axes in words."""
        return ", ".join(f"{axis} {word}" for axis, word in zip("xyz", self.directions, strict=True))

    @property
    def option(self) -> str:
        """The axes as the command line takes them."""
        return ",".join(self.directions)

    @property
    def right_handed(self) -> bool:
        """Whether x, y and z are right-handed, as the scene's are."""
        return bool(np.linalg.det(self.matrix) > 0.0)

    @property
    def matrix(self) -> NDArray[np.int_]:
        """The scene's coordinates from the file's, (3, 3)."""
        return np.array([DIRECTIONS[word] for word in self.directions]).T

    def to_scene(self, place: Place, unit: str) -> Place:
        """A place in the file's axes and unit as x rearward, y right, z up, mm."""
        x, y, z = self.matrix.astype(object) @ place * LENGTHS[unit] + 0
        return x, y, z


OUR_AXES = Axes(("rearward", "right", "up"))
"""The scene's."""
