"""What a file of hardpoints holds, whatever its form: points as they stand there, with their lines."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation

from validate.plain_text import shown
from validate.tables.errors import FileError

Place = tuple[Decimal, Decimal, Decimal]
"""Three coordinates with the digits that were printed: a metre is 1000 mm and not 1000.0000000000001."""

# No hardpoint is farther off, in any unit, and no number of a file is longer than this makes it.
FARTHEST = Decimal("1e9")


@dataclass(frozen=True)
class FilePoint:
    """A point as the file has it.

    Attributes:
        name: what the file calls it.
        place: its coordinates in the file's axes and unit.
        line: where it is, counted from 1; 0 where a file has no lines to speak of.
        side: the wheel that the file says it belongs to, left or right; empty if it does not say.
        part: the axle that the file says it belongs to, front or rear; empty if it does not say.
        section: the heading that it stands under; empty if there is none.
    """

    name: str
    place: Place
    line: int = 0
    side: str = ""
    part: str = ""
    section: str = ""

    def of(self, part: str, side: str) -> bool:
        """Whether it may belong to that wheel; an empty axle or side leaves it open."""
        return all(mine in ("", its) or not its for mine, its in ((self.part, part), (self.side, side)))

    @property
    def source(self) -> str:
        """Its name and its line."""
        return f"{self.name}, line {self.line}" if self.line else self.name

    @property
    def told(self) -> str:
        """The same in a sentence."""
        return short(self.name) + (f" on line {self.line}" if self.line else "")


@dataclass(frozen=True)
class SpinAxis:
    """Where a wheel's spin axis points, forward, outboard and up, and what that is taken from."""

    direction: tuple[float, float, float]
    words: str


@dataclass(frozen=True)
class Axle:
    """What a file says of an axle beside its points.

    Attributes:
        called: what it calls the suspension; empty if it does not say.
        angles: static angles that it prints, by its own words, deg, each with its line.
        spin_axis: where its wheel's spin axis points, if said without a point.
        notes: what the user should know of its points.
    """

    called: str = ""
    angles: Mapping[str, tuple[Decimal, int]] = field(default_factory=dict)
    spin_axis: SpinAxis | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Contents:
    """A file, read.

    Attributes:
        points: in the order of the file.
        axles: by part; what is said of the whole file under the empty one.
        unit: of its lengths, if it says so.
        lines: those that name something and are no points, in words.
    """

    points: tuple[FilePoint, ...]
    axles: Mapping[str, Axle] = field(default_factory=dict)
    unit: str = ""
    lines: tuple[str, ...] = ()

    def axle(self, part: str) -> Axle:
        """What is said of an axle, or else of the whole file."""
        return self.axles.get(part) or self.axles.get("", Axle())


def number_of(value: object, source: str, line: int, what: str) -> Decimal:
    """A finite number with the digits of its text.

    Raises:
        FileError: it is none, or farther off than any car.
    """
    try:
        number = Decimal(value.strip() if isinstance(value, str) else str(value))
    except InvalidOperation:
        number = Decimal("nan")
    # The exponent too: 1e-999999999 compares as small and has a billion digits.
    if not number.is_finite() or number.copy_abs() > FARTHEST or int(number.as_tuple().exponent) < -1100:
        raise FileError(source, line, f"{what} is {short(str(value))}", "a number up to 1e9")
    return number


def place_of(numbers: Sequence[object], source: str, line: int, name: str) -> Place:
    """Three coordinates with the digits of their texts.

    Raises:
        FileError: one is no number, or there are not three.
    """
    if len(numbers) != 3:
        raise FileError(source, line, f"has {len(numbers)} numbers for {short(name)}", "x, y and z")
    x, y, z = (
        number_of(number, source, line, f"{axis} of {short(name)}")
        for axis, number in zip("xyz", numbers, strict=True)
    )
    return x, y, z


def plain(name: str) -> str:
    """A name without capitals and signs: `CHAS_LowFor` and `chas lowfor` are one."""
    return " ".join(re.findall(r"[^\W_]+", name.casefold()))


def short(text: str) -> str:
    """A text of a file in at most 60 characters, in quotes."""
    return shown(repr(text if len(text) <= 60 else text[:57] + "..."))
