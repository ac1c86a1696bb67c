"""The axes and units of other programs, turned into the scene's: x rearward, y right, z up; mm.

Coordinates are decimal numbers as printed, and axes are turned by exchanging and negating them, so nothing is
rounded.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from validate.errors import UsageError
from validate.hardpoint_files.contents import Place
from validate.tables.units import LENGTHS

# Which of the scene's coordinates a direction is, and its sign there.
DIRECTIONS = {
    "rearward": (0, 1),
    "forward": (0, -1),
    "right": (1, 1),
    "left": (1, -1),
    "up": (2, 1),
    "down": (2, -1),
}


def vector_along(word: str) -> NDArray[np.float64]:
    """A direction by its name in the scene's axes, (3,)."""
    at, sign = DIRECTIONS[word]
    return np.asarray(sign * np.eye(3)[at])


ALLOWED = "the directions of x, y and z, such as forward,left,up, of " + ", ".join(DIRECTIONS)


@dataclass(frozen=True)
class Axes:
    """Where the x, y and z of a file point."""

    directions: tuple[str, ...]

    @classmethod
    def of(cls, words: str | Sequence[str]) -> Axes:
        """Axes from their words.

        Raises:
            UsageError: they are not three directions at right angles.
        """
        found = re.findall(r"[^\s,;]+", words.lower()) if isinstance(words, str) else list(words)
        if sorted(DIRECTIONS.get(word, (-1, 0))[0] for word in found) != [0, 1, 2]:
            text = words if isinstance(words, str) else ",".join(found)
            raise UsageError(f"axes are {text!r}; allowed: {ALLOWED}; each line of the car once")
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
    def matrix(self) -> NDArray[np.float64]:
        """The scene's coordinates from the file's, (3, 3)."""
        return np.stack([vector_along(word) for word in self.directions], axis=1)

    def to_scene(self, place: Place, unit: str) -> Place:
        """A place in the file's axes and unit as x rearward, y right, z up, mm."""
        turned = [Decimal(0)] * 3
        for word, number in zip(self.directions, place, strict=True):
            at, sign = DIRECTIONS[word]
            turned[at] = number * sign * LENGTHS[unit] + 0
        return turned[0], turned[1], turned[2]


OUR_AXES = Axes(("rearward", "right", "up"))
"""The scene's."""
