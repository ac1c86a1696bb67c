"""A table of points: a name and three numbers on each line, as spreadsheets and programs write them.

A line of titles is not needed. Where there is one, it says which columns are x, y and z, of which wheel and
in which unit, as in `Point, Left X (m), Left Y (m), Left Z (m)`; a column may say the wheel of each line.
Titles that say it otherwise are not guessed at: [table] in the file of names says which columns are meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

from validate.hardpoint_files.contents import Axle, Contents, FilePoint, place_of, plain, short, words_of
from validate.tables.cells import is_number, joined, lines_of
from validate.tables.errors import FileError
from validate.tables.units import length_called

Wheel = tuple[str, str]
"""A side and an axle; either may be empty."""
NO_WHEEL: Wheel = ("", "")
# Which wheel a word speaks of. A lonely letter is a side where it can be one.
WHEELS: Mapping[str, Wheel] = {
    **dict.fromkeys(("left", "lh", "l"), ("left", "")),
    **dict.fromkeys(("right", "rh", "r"), ("right", "")),
    **dict.fromkeys(("front", "f"), ("", "front")),
    "rear": ("", "rear"),
    **dict.fromkeys(("fl", "lf"), ("left", "front")),
    **dict.fromkeys(("fr", "rf"), ("right", "front")),
    **dict.fromkeys(("rl", "lr"), ("left", "rear")),
    "rr": ("right", "rear"),
}
# Words of titles of columns that hold wheels and names.
OF_WHEELS = words_of("corner wheel axle side")
OF_NAMES = words_of("name names point points hardpoint hardpoints node joint label description")
ROW = "a name and three numbers on a line, separated by commas, semicolons or tabs"
SAY = f'{ROW}; or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
NOWHERE = (Decimal(0), Decimal(0), Decimal(0))
Row = Sequence[str]


@dataclass(frozen=True)
class _Titles:
    """What a line of titles says.

    Attributes:
        columns: of x, y and z, by wheel. name_at, wheel_at: those of names and wheels, if any.
        unit: of lengths. row: the line itself. said: whether the user names the columns.
    """

    columns: Mapping[Wheel, Sequence[int]]
    name_at: int
    wheel_at: int | None = None
    unit: str = ""
    row: Row = ()
    said: bool = False

    def further(self, row: Row) -> list[int]:
        """Columns with numbers that are not read; what is ahead of a name may count the lines."""
        coordinates = {at for three in self.columns.values() for at in three}
        first, read = min(self.name_at, *coordinates), {self.name_at, self.wheel_at, *coordinates}
        return [at for at in range(first + 1, len(row)) if at not in read and is_number(row[at])]


def read(text: str, source: str, said: Mapping[str, str | int] | None = None) -> Contents:
    """The points of a table.

    Args:
        said: titles or numbers of the columns name, x, y and z, and corner (which wheel) if there is one.
    Raises:
        FileError: titles are not as they must be, a point has no name, or there is no point.
    """
    lines = lines_of(text)
    if lines.mixed:
        told = "has numbers with points and with commas"
        raise FileError(source, lines.mixed, told, "one sign before the decimals, none between thousands")
    rows = [(line, row if lines.mark else _named(row)) for line, row in lines.rows]
    titles = _said(rows, said, source) if said else _titles(rows, source)
    points: list[FilePoint] = []
    notes: dict[str, None] = {}
    for line, row in rows:
        if row == titles.row:
            continue
        new = [*_points_of(row, titles, source, line)]
        points += new
        if not titles.said and any(one.error is None for one in new):
            for at in titles.further(row):
                if not _cell(titles.row, at):
                    told = f"has {sum(map(is_number, row))} numbers for {short(new[0].name)}"
                    raise FileError(source, line, told, f"three, or titles such as Left X, Right X; {SAY}")
                notes[f"the column {short(titles.row[at])} is not read"] = None
    if all(one.error for one in points):
        raise next((one.error for one in points if one.error), FileError(source, 0, "has no points", SAY))
    good = tuple(one for one in points if one.error is None)
    spoilt = tuple(one for one in points if one.error)
    return Contents(good, {"": Axle(notes=tuple(notes))}, titles.unit, spoilt=spoilt)


def _named(words: Row) -> Row:
    """The cells of a line between blanks: a name of any number of words, and three others."""
    row = joined(words)
    return [" ".join(row[:-3]), *row[-3:]] if len(row) > 3 else row


def _cell(row: Row, at: int) -> str:
    """A cell of a line; empty behind its end."""
    return row[at] if at < len(row) else ""


def wheel_of(words: Iterable[str]) -> Wheel:
    """The wheel of which words speak."""
    there = [WHEELS[word] for word in sorted(words) if word in WHEELS]
    return next((side for side, _ in there if side), ""), next((part for _, part in there if part), "")


def _said(rows: Sequence[tuple[int, Row]], said: Mapping[str, str | int], source: str) -> _Titles:
    """The columns that the user names."""
    titles = {plain(one) for one in said.values() if isinstance(one, str)}
    row: Row = next((row for _, row in rows if titles and titles <= {*map(plain, row)}), [])
    if titles and not row:
        told = f"has no line with the titles {', '.join(map(str, said.values()))}"
        raise FileError(source, 0, told, "titles as they stand there, or numbers of columns from 1")
    heads = [*map(plain, row)]
    at = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    return _Titles({NO_WHEEL: (at["x"], at["y"], at["z"])}, at["name"], at.get("corner"), row=row, said=True)


def _titles(rows: Sequence[tuple[int, Row]], source: str) -> _Titles:
    """What the line of titles says, or that of a table without one: a name, x, y and z.

    Raises:
        FileError: there are several, or one is not as it must be.
    """
    heads = [(line, row) for line, row in rows if not any(map(is_number, row))]
    known = [one for one in heads if len({*"xyz"} & words_of(" ".join(one[1]))) > 1]
    if not known:
        first = next((line for line, row in rows if sum(map(is_number, row)) > 2), 0)
        for line, row in heads:
            if line < first and sum(map(bool, row)) > 3:
                raise FileError(source, line, f"has titles that are not known: {short(', '.join(row))}", SAY)
        return _Titles({NO_WHEEL: (1, 2, 3)}, 0)
    (line, row), *others = known
    if any(other != row for _, other in others):
        raise FileError(source, others[0][0], "has other titles than those above", "a file for each table")
    columns: dict[Wheel, dict[str, int]] = {}
    units, rest = set(), []
    for at, words in enumerate(map(words_of, row)):
        axes, lengths = words & {*"xyz"}, {word for word in words if length_called(word)}
        if len(axes) != 1 or len(lengths) > 1 or words - axes - lengths - WHEELS.keys():
            rest.append(at)
            continue
        (axis,) = axes
        three = columns.setdefault(wheel_of(words), {})
        if axis in three:
            told = f"has two columns of {axis} (the second is {short(row[at])})"
            raise FileError(source, line, told, f"one for each wheel; {SAY}")
        three[axis] = at
        units.add(length_called("".join(lengths)))
    for three in columns.values() or ({},):
        if missing := [axis for axis in "xyz" if axis not in three]:
            told = f"has no column of {missing[0]} in {short(', '.join(row))}"
            raise FileError(source, line, told, f"columns x, y and z, such as X (mm), Left X; {SAY}")
    if len(units) > 1:
        told = f"has lengths in {', '.join(sorted(unit or 'no unit' for unit in units))}"
        raise FileError(source, line, told, "one unit in all columns")
    wheels_at = next((at for at in rest if words_of(row[at]) and words_of(row[at]) <= OF_WHEELS), None)
    named = sorted(rest, key=lambda at: (at == wheels_at, not words_of(row[at]) & OF_NAMES, at))
    if not named or named[0] == wheels_at:
        raise FileError(source, line, "has no column of names", SAY)
    found = {wheel: [three[axis] for axis in "xyz"] for wheel, three in columns.items()}
    return _Titles(found, named[0], wheels_at, units.pop(), row)


def _points_of(row: Row, titles: _Titles, source: str, line: int) -> Iterator[FilePoint]:
    """The points of a line, each with an error if it is none."""
    name, numbers = _cell(row, titles.name_at), [*filter(is_number, row)]
    if not name or (is_number(re.split(r"\s", name)[-1]) and not titles.said):
        if len(numbers) >= 3:
            raise FileError(source, line, "has coordinates without a name, or more than three", SAY)
        return
    at = titles.wheel_at
    of_line = NO_WHEEL if at is None else wheel_of(words_of(_cell(row, at)))
    for wheel, three in titles.columns.items():
        cells = [_cell(row, at) for at in three]
        side, part = (own or of for own, of in zip(wheel, of_line, strict=True))
        point = FilePoint(name, NOWHERE, line, side, part)
        try:
            yield replace(point, place=place_of(cells, source, line, name))
        except FileError as error:
            # A line of words alone is a heading; one with numbers elsewhere is a mistake.
            if any(cells[1:]) or numbers:
                yield replace(point, error=error)
