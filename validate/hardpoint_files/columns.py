"""A table of points: a name and three numbers on each line, as spreadsheets and programs write them.

Titles are not needed. Where there are, they say which columns are x, y and z, of which wheel, in which unit
and where they point, as in `Point, Left X (m), Left Y (m), Left Z (m)`; a column may say the wheel of each
line, and a line of words such as `REAR SUSPENSION` that of the lines below it. Other lines of words, such as
`LOWER A-ARM`, are headings of the points below them: `Front inboard`. Titles that say it otherwise are not
guessed at: a table [table] in the file of names says which columns are meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from validate.hardpoint_files.axes import DIRECTIONS
from validate.hardpoint_files.contents import (
    Axle,
    Contents,
    FilePoint,
    place_of,
    plain,
    short,
    words_of,
)
from validate.tables.cells import is_number, joined, lines_of
from validate.tables.errors import FileError
from validate.tables.units import length_called

Wheel = tuple[str, str]
"""A side and an axle; either may be empty."""
NO_WHEEL: Wheel = ("", "")
# Which wheel a word speaks of; a lonely letter is a side where it can be one. `hpl` and `hpr` are Adams'.
WHEELS: Mapping[str, Wheel] = {
    **dict.fromkeys(("left", "lh", "l", "hpl"), ("left", "")),
    **dict.fromkeys(("right", "rh", "r", "hpr"), ("right", "")),
    **dict.fromkeys(("front", "f"), ("", "front")),
    "rear": ("", "rear"),
    **dict.fromkeys(("fl", "lf"), ("left", "front")),
    **dict.fromkeys(("fr", "rf"), ("right", "front")),
    **dict.fromkeys(("rl", "lr"), ("left", "rear")),
    "rr": ("right", "rear"),
}
# Words of titles of columns that hold wheels, names and numbers of lines; words beside x, y and z that say
# nothing; words of a line over the points of a wheel.
OF_WHEELS = {*words_of("corner wheel axle side end")}
OF_NAMES = {*words_of("name names point points hardpoint hardpoints node joint label description")}
OF_LINES = {*words_of("no nr number id index n")}
IDLE = {*words_of("coordinate coordinates coord coords position pos location axis value")}
HEADING = {*words_of("suspension axle wheel corner hardpoints points side geometry coordinates")}
ROW = "a name and three numbers, separated by commas, semicolons or tabs"
SAY = (
    'a point a line, or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
)
Row = Sequence[str]


@dataclass(frozen=True)
class _Titles:
    """Which columns a table has.

    Attributes:
        columns: of x, y and z, by wheel. name_at, wheel_at: those of names and wheels, if any.
        unit: of lengths. axes: where x, y and z point. row: the line of titles itself, if there is one.
    """

    columns: Mapping[Wheel, Sequence[int]]
    name_at: int
    wheel_at: int | None = None
    unit: str = ""
    axes: tuple[str, ...] = ()
    row: Row = ()

    @property
    def unread(self) -> list[str]:
        """Titles of columns that are not read, but for numbers of lines."""
        read = {self.name_at, self.wheel_at, *(at for three in self.columns.values() for at in three)}
        return [
            title
            for at, title in enumerate(self.row)
            if title and at not in read and not {*words_of(title)} <= OF_LINES
        ]


UNTITLED = _Titles({NO_WHEEL: (1, 2, 3)}, 0)


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
    titles = _said([row for _, row in rows], said, source) if said else UNTITLED
    heading, section, unknown = NO_WHEEL, "", (0, "")
    points: list[FilePoint] = []
    others: list[str] = []
    tables = [titles]
    for line, row in rows:
        count, words = sum(map(is_number, row)), [cell for cell in row if cell]
        if said and row == titles.row:
            continue
        if not said and not count and (found := _titles(row, source, line)) is not None:
            tables.append(titles := found)
        elif len(words) == 1 and not count:
            # The left wheel under a heading of the front axle is the front left one.
            wheel = wheel_of(words_of(words[0]))
            speaks = any(wheel) and not {*words_of(words[0])} - WHEELS.keys() - HEADING
            heading, section = ((wheel[0], wheel[1] or heading[1]), "") if speaks else (heading, words[0])
        elif titles is UNTITLED and not count:
            unknown = (line, ", ".join(row[1:])) if len(words) > 3 else unknown
        else:
            if titles is UNTITLED and unknown[0] and count >= 3 and not points:
                told = f"has titles that are not known: {short(unknown[1])}"
                allowed = f"X, Y, Z; of both wheels Left X, Left Y, Left Z, Right X; {SAY}"
                raise FileError(source, unknown[0], told, allowed)
            new = _points_of(row, titles, heading, section, source, line)
            points += new
            if not new and (name := _cell(row, titles.name_at)):
                others.append(f"{short(name)} on line {line}")
    if not points:
        raise FileError(source, 0, "has no points", f"{ROW}; {SAY}")
    units, ways = {one.unit for one in tables} - {""}, {one.axes for one in tables} - {()}
    for what, several in (("units", len(units) > 1), ("axes", len(ways) > 1)):
        if several:
            raise FileError(source, 0, f"has tables in different {what}", "a file for each")
    notes = dict.fromkeys(f"the column {short(one)} is not read" for table in tables for one in table.unread)
    axles = {"": Axle(notes=tuple(notes))}
    return Contents(tuple(points), axles, "".join(units), next(iter(ways), ()), tuple(others))


def _named(words: Row) -> Row:
    """The cells of a line between blanks: the numbers at its end, or titles from x on, and a name before."""
    count = next((n for n, word in enumerate(reversed(words)) if not is_number(word)), len(words))
    titled = joined(words)
    first = next((at for at, title in enumerate(titled) if {*words_of(title)} & {*"xyz"}), len(titled))
    if count < 3 and first < len(titled):
        return [" ".join(titled[:first]), *titled[first:]]
    return [" ".join(words[: len(words) - count]), *words[len(words) - count :]]


def _cell(row: Row, at: int) -> str:
    """A cell of a line; empty behind its end."""
    return row[at] if at < len(row) else ""


def _said(rows: Sequence[Row], said: Mapping[str, str | int], source: str) -> _Titles:
    """The columns that the user names."""
    titles = {plain(one) for one in said.values() if isinstance(one, str)}
    row: Row = next((row for row in rows if titles and titles <= {*map(plain, row)}), [])
    if titles and not row:
        told = f"has no line with the titles {', '.join(map(str, said.values()))}"
        raise FileError(source, 0, told, "titles as they stand there, or numbers of columns from 1")
    heads = [*map(plain, row)]
    at = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    return _Titles({NO_WHEEL: (at["x"], at["y"], at["z"])}, at["name"], at.get("corner"))


def _titles(row: Row, source: str, line: int) -> _Titles | None:
    """What a line of titles says; None if this is none."""
    words = [{*words_of(cell)} for cell in row]
    there = [at for at, some in enumerate(words) if len(some & {*"xyz"}) == 1]
    if len({*"xyz"} & {word for at in there for word in words[at]}) < 2:
        return None
    columns: dict[Wheel, dict[str, int]] = {}
    units, ways = set[str](), dict[str, str]()
    for at in there:
        (axis,) = words[at] & {*"xyz"}
        unit = "".join(filter(length_called, words[at] - IDLE))
        bracketed = re.search(r"[(\[]([^)\]]*)[)\]]", row[at])
        way = next(iter({*words_of(bracketed[1])} & DIRECTIONS.keys()), "") if bracketed else ""
        of_wheels = words[at] - IDLE - {axis, unit, way}
        if of_wheels - WHEELS.keys():
            continue
        if axis in columns.setdefault(wheel_of(of_wheels), {}):
            told = f"has two columns of {axis} (the second is {short(row[at])})"
            raise FileError(source, line, told, f"one for each wheel; {SAY}")
        columns[wheel_of(of_wheels)][axis] = at
        units.add(length_called(unit))
        ways |= {axis: way} if way else {}
    for three in columns.values() or [{}]:
        if missing := [axis for axis in "xyz" if axis not in three]:
            told = f"has no column of {missing[0]} in {short(', '.join(row))}"
            raise FileError(source, line, told, f"columns x, y and z, such as X (mm), Left X; {SAY}")
    if len(units) > 1 or len(ways) not in (0, 3):
        told = f"says units {sorted(units)} and directions {[*ways.values()]}"
        raise FileError(source, line, told, "one unit in all columns, and directions of all three or none")
    others = [at for at in range(len(row)) if at not in there]
    of_wheel = next((at for at in others if words[at] and words[at] <= OF_WHEELS), None)
    names = [at for at in others if at != of_wheel and not (words[at] and words[at] <= OF_LINES)]
    if not names:
        raise FileError(source, line, "has no column of names", f"a column of names before x, y and z; {SAY}")
    name_at = min(names, key=lambda at: (not words[at] & OF_NAMES, at))
    by_wheel = {wheel: [three[axis] for axis in "xyz"] for wheel, three in columns.items()}
    return _Titles(by_wheel, name_at, of_wheel, units.pop(), tuple(ways[axis] for axis in "xyz" if ways), row)


def wheel_of(words: Iterable[str]) -> Wheel:
    """The wheel of which words speak."""
    there = [WHEELS[word] for word in sorted(words) if word in WHEELS]
    return next((side for side, _ in there if side), ""), next((part for _, part in there if part), "")


def _points_of(
    row: Row, titles: _Titles, heading: Wheel, section: str, source: str, line: int
) -> list[FilePoint]:
    """The points of a line, one for each wheel; none where it has no three numbers for one."""
    name = _cell(row, titles.name_at)
    count = sum(map(is_number, row))
    said = titles is not UNTITLED and not titles.row
    if not said and (not name or is_number(name)) and count >= 3:
        raise FileError(source, line, "has coordinates without a name", ROW)
    of_line = NO_WHEEL if titles.wheel_at is None else wheel_of(words_of(_cell(row, titles.wheel_at)))
    found: list[FilePoint] = []
    for wheel, three in titles.columns.items():
        cells = [_cell(row, at) for at in three]
        if not name or not all(map(is_number, cells)):
            continue
        if titles is UNTITLED and count > 3:
            told = f"has {count} numbers for {short(name)}, some of them in columns without a title"
            allowed = f"three, or a line of titles such as Point, Left X, Left Y, Left Z, Right X; {SAY}"
            raise FileError(source, line, told, allowed)
        side, part = (own or of or over for own, of, over in zip(wheel, of_line, heading, strict=True))
        found.append(FilePoint(name, place_of(cells, source, line, name), line, side, part, section))
    return found
