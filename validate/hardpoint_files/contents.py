"""The contents of a file of hardpoints in any format: points as given, with their lines, and their axes.

Coordinates are decimal numbers as printed. Axes are converted by permutations and signs to those of the
scene (x rearward, y right, z up; mm), so nothing is rounded.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation

import numpy as np
from numpy.typing import NDArray

from validate.errors import UsageError
from validate.plain_text import shown
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

Place = tuple[Decimal, Decimal, Decimal]
"""Three coordinates with the printed digits: a metre is 1000 mm and not 1000.0000000000001."""

# Largest coordinate in any unit. It also limits the length of numbers.
FARTHEST = Decimal("1e9")
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
class Point:
    """A point of a file, or of the scene that is made of it.

    Attributes:
        name: its name in the file; our name in a scene.
        place: its coordinates in the file's axes and unit; in a scene x rearward, y right, z up, mm.
        source: where it comes from, in words: for a point of a file its name and line.
        side: its wheel according to the file, left or right; empty if the file does not say.
        part: its axle according to the file, front or rear; empty if the file does not say.
        section: the heading above it; empty if there is none.
    """

    name: str
    place: Place
    source: str
    side: str = ""
    part: str = ""
    section: str = ""

    @property
    def written(self) -> str:
        """The position as TOML, with its digits."""
        return f"[{', '.join(f'{number.normalize() + 0:f}' for number in self.place)}]"


@dataclass(frozen=True)
class Contents:
    """The contents of a file.

    Attributes:
        points: in the order of the file.
        others: lines with a name and something else than three numbers, in words.
        unit: unit of lengths, if the file gives it.
        called: the file's name of the suspension type, by axle; here and below the empty name is for a file
            that does not distinguish axles.
        angles: printed static angles by axle and by their names in the file, deg, each with its line.
    """

    points: Sequence[Point]
    others: Sequence[str] = ()
    unit: str = ""
    called: Mapping[str, str] = field(default_factory=dict)
    angles: Mapping[str, Mapping[str, tuple[Decimal, int]]] = field(default_factory=dict)


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
    def matrix(self) -> NDArray[np.int_]:
        """The matrix from the file's coordinates to the scene's, (3, 3)."""
        return np.array([DIRECTIONS[word] for word in self.directions]).T

    def to_scene(self, place: Place, unit: str) -> Place:
        """A position in the file's axes and unit, converted to x rearward, y right, z up, mm."""
        x, y, z = self.matrix.astype(object) @ place * LENGTHS[unit] + 0
        return x, y, z


OUR_AXES = Axes(("rearward", "right", "up"))
"""The axes of a scene."""


def number_of(value: object, source: str, line: int, what: str) -> Decimal:
    """A finite number with the digits of its text.

    Raises:
        FileError: the text is not a number, or the number is too large.
    """
    try:
        number = Decimal(str(value).strip())
    except InvalidOperation:
        number = Decimal("nan")
    # The exponent is limited too: 1e-999999999 is small but has a billion digits.
    if not number.is_finite() or number.copy_abs() > FARTHEST or int(number.as_tuple().exponent) < -1100:
        raise FileError(source, line, f"{what} is {short(str(value))}", "a number up to 1e9")
    return number


def place_of(numbers: object, source: str, line: int, name: str) -> Place:
    """Three coordinates with the digits of their texts.

    Raises:
        FileError: these are not three numbers.
    """
    if not isinstance(numbers, list) or len(numbers) != 3:
        raise FileError(source, line, f"{short(name)} has {short(str(numbers))}", "three numbers: x, y and z")
    named = zip("xyz", numbers, strict=True)
    x, y, z = (number_of(value, source, line, f"{axis} of {short(name)}") for axis, value in named)
    return x, y, z


def plain(name: str) -> str:
    """A name without capitals and punctuation: `CHAS_LowFor` and `chas lowfor` are equal."""
    return " ".join(re.findall(r"[^\W_]+", name.casefold()))


def short(text: str) -> str:
    """A text of a file in quotes, shortened to 60 characters."""
    return shown(repr(text if len(text) <= 60 else text[:57] + "..."))
