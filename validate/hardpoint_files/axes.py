"""The axes and units of other programs, turned into the scene's: x rearward, y right, z up; mm.

Coordinates are decimal numbers as printed, and axes are turned by exchanging and negating them, so nothing is
rounded.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

from validate.hardpoint_files.contents import Place

# Which of the scene's coordinates a direction is, and its sign there.
DIRECTIONS = {
    "rearward": (0, 1),
    "forward": (0, -1),
    "right": (1, 1),
    "left": (1, -1),
    "up": (2, 1),
    "down": (2, -1),
}
UNITS = {
    "mm": Decimal(1),
    "cm": Decimal(10),
    "m": Decimal(1000),
    "in": Decimal("25.4"),
    "ft": Decimal("304.8"),
}
"""mm in a unit."""
ALLOWED = "the directions of x, y and z, such as forward,left,up, of " + ", ".join(DIRECTIONS)


class UnknownAxes(ValueError):
    """Words that are not the directions of three axes.

    Args:
        text: what was given.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        super().__init__(f"axes are {text!r}; allowed: {ALLOWED}; each line of the car once")


@dataclass(frozen=True)
class Axes:
    """Where the x, y and z of a file point."""

    directions: tuple[str, str, str]

    @classmethod
    def of(cls, words: str | Sequence[str]) -> Axes:
        """Axes from their words.

        Raises:
            UnknownAxes: they are not three directions at right angles.
        """
        found = re.findall(r"[^\s,;]+", words.lower()) if isinstance(words, str) else list(words)
        if sorted(DIRECTIONS.get(word, (-1, 0))[0] for word in found) != [0, 1, 2]:
            raise UnknownAxes(words if isinstance(words, str) else ",".join(found))
        x, y, z = found
        return cls((x, y, z))

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
        places = [DIRECTIONS[word] for word in self.directions]
        order = [place for place, _ in places]
        swaps = sum(order[i] > order[j] for i in range(3) for j in range(i + 1, 3))
        sign = -1 if swaps % 2 else 1
        for _, own in places:
            sign *= own
        return sign > 0

    def to_scene(self, place: Place, unit: str) -> Place:
        """A place in the file's axes and unit as x rearward, y right, z up, mm."""
        turned = [Decimal(0)] * 3
        for word, number in zip(self.directions, place, strict=True):
            at, sign = DIRECTIONS[word]
            turned[at] = number * sign * UNITS[unit] + 0
        return turned[0], turned[1], turned[2]


def axes_seen(forward: Place, outboard: Place, upward: Place) -> Axes | None:
    """The right-handed axes of a file in which a car's own directions are these; None if that is not plain.

    Each direction is that of its largest coordinate. Which way is left follows from the other two.

    Args:
        forward, outboard, upward: differences of points in the file's axes that point mostly so.
    """
    main = [max(range(3), key=lambda i: abs(vector[i])) for vector in (forward, outboard, upward)]
    if sorted(main) != [0, 1, 2]:
        return None
    words = ["", "", ""]
    words[main[0]] = "forward" if forward[main[0]] > 0 else "rearward"
    words[main[2]] = "up" if upward[main[2]] > 0 else "down"
    words[main[1]] = "left"
    left = Axes.of(words)
    if not left.right_handed:
        words[main[1]] = "right"
    return Axes.of(words)
