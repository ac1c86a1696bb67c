"""A table of points: a name and three numbers on each line, as spreadsheets and programs write them.

Titles are not needed. Where there are, they say which columns are x, y and z, of which wheel, in which unit
and where they point, as in `Point, Left X (m), Left Y (m), Left Z (m)`; a column may say the wheel of each
line, and a line of words such as `REAR SUSPENSION` that of the lines below it. Titles that say it otherwise
are not guessed at: a table [table] in the file of names says which columns are meant.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

from validate.hardpoint_files.axes import DIRECTIONS
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
# Words of titles of columns that hold wheels, names and numbers of lines; words beside x, y and z that say
# nothing; words of a line over the points of a wheel.
OF_WHEELS = words_of("corner wheel axle side end")
OF_NAMES = words_of("name names point points hardpoint hardpoints node joint label description")
OF_LINES = words_of("no nr number id index n")
IDLE = words_of("coordinate coordinates coord coords position pos location axis value")
HEADING = words_of("suspension axle wheel corner hardpoints points side geometry coordinates")
ROW = "a name and three numbers, separated by commas, semicolons or tabs"
SAY = (
    'a point a line, or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
)
NOWHERE = (Decimal(0), Decimal(0), Decimal(0))
Row = Sequence[str]


@dataclass(frozen=True)
class _Titles:
    """What a line of titles says.

    Attributes:
        columns: of x, y and z, by wheel. name_at, wheel_at: those of names and wheels, if any.
        unit: of lengths. directions: where x, y and z point. row: the line itself.
        said: whether the user says it.
    """

    columns: Mapping[Wheel, Sequence[int]]
    name_at: int
    wheel_at: int | None = None
    unit: str = ""
    directions: tuple[str, ...] = ()
    row: Row = ()
    said: bool = False

    @property
    def own(self) -> set[int]:
        """The columns of coordinates."""
        return {at for three in self.columns.values() for at in three}

    def title(self, at: int) -> str:
        """A column's title; empty if it has none."""
        return _cell(self.row, at)

    def further(self, row: Row) -> list[int]:
        """Columns with numbers that are not read; what is ahead of a name may count the lines."""
        read = {self.name_at, self.wheel_at, *self.own}
        return [
            at
            for at in range(min(self.name_at, *self.own) + 1, len(row))
            if at not in read and is_number(row[at]) and not _counts_lines(_words(self.title(at)))
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
    rows = [(line, row if lines.mark else _named(row)) for line, row in lines.rows]
    if lines.mixed:
        told = "has numbers with points and with commas"
        raise FileError(source, lines.mixed, told, "one sign before the decimals, none between thousands")
    titles, heading, words = _said(rows, said, source) if said else UNTITLED, NO_WHEEL, ("", 0, 0)
    every: list[FilePoint] = []
    notes: dict[str, None] = {}
    tables = [titles]
    for line, row in rows:
        if titles.said and row == titles.row:
            continue
        if not titles.said and (found := _titles(row, source, line)) is not None:
            tables.append(titles := found)
        elif unit := _unit_line(row, titles):
            tables.append(titles := replace(titles, unit=unit))
        elif (wheel := _heading(row)) is not None:
            # The left wheel under a heading of the front axle is the front left one.
            heading = wheel[0], wheel[1] or heading[1]
        else:
            if not any(map(is_number, row)):
                words = ", ".join(row[1:]), line, sum(map(bool, row))
            elif titles is UNTITLED and words[2] > 3 and not any(one.error is None for one in every):
                told = f"has titles that are not known: {short(words[0])}"
                allowed = f"X, Y, Z; of both wheels Left X, Left Y, Left Z, Right X; {SAY}"
                raise FileError(source, words[1], told, allowed)
            new = _points_of(row, titles, heading, source, line)
            every += new
            if any(one.error is None for one in new):
                notes |= {
                    f"the column {short(titles.title(at))} is not read": None for at in titles.further(row)
                }
    points, spoilt = ([p for p in every if (p.error is None) is good] for good in (True, False))
    if not points:
        wrong = next((one.error for one in spoilt if one.value), None)
        raise wrong or FileError(source, 0, "has no points", f"{ROW}; {SAY}")
    units, directions = ({getattr(one, key) for one in tables} - {"", ()} for key in ("unit", "directions"))
    for what, found_of in (("units", units), ("axes", directions)):
        if len(found_of) > 1:
            raise FileError(source, 0, f"has tables in different {what}", "a file for each")
    axles = {"": Axle(notes=tuple(notes))}
    unit, axes = next(iter(units), ""), next(iter(directions), ())
    return Contents(tuple(points), axles, unit, axes, tuple(spoilt))


def _named(words: Row) -> Row:
    """The cells of a line between blanks: the numbers at its end, or titles from x on, and a name before."""
    count = next((n for n, word in enumerate(reversed(words)) if not is_number(word)), len(words))
    titled = joined(words)
    first = next((at for at, title in enumerate(titled) if _words(title) & {*"xyz"}), len(titled))
    if count < 3 and first < len(titled):
        return [" ".join(titled[:first]), *titled[first:]]
    return [" ".join(words[: len(words) - count]), *words[len(words) - count :]]


def _cell(row: Row, at: int) -> str:
    """A cell of a line; empty behind its end."""
    return row[at] if at < len(row) else ""


def _counts_lines(words: set[str]) -> bool:
    return bool(words) and words <= OF_LINES


def _words(title: str) -> set[str]:
    return {*plain(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", title)).split()}


# Titles, and lines that are no points.


def _said(rows: Sequence[tuple[int, Row]], said: Mapping[str, str | int], source: str) -> _Titles:
    """The columns that the user names."""
    titles = {plain(one) for one in said.values() if isinstance(one, str)}
    row: Row = next((row for _, row in rows if titles and titles <= {*map(plain, row)}), [])
    if titles and not row:
        told = f"has no line with the titles {', '.join(str(one) for one in said.values())}"
        raise FileError(source, 0, told, "titles as they stand there, or numbers of columns from 1")
    heads = [*map(plain, row)]
    at = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    return _Titles({NO_WHEEL: (at["x"], at["y"], at["z"])}, at["name"], at.get("corner"), row=row, said=True)


def _titles(row: Row, source: str, line: int) -> _Titles | None:
    """What a line of titles says; None if this is none."""
    words = [_words(cell) for cell in row]
    there = [at for at, some in enumerate(words) if len(some & {*"xyz"}) == 1]
    if any(map(is_number, row)) or len({*"xyz"} & {word for at in there for word in words[at]}) < 2:
        return None
    columns: dict[Wheel, dict[str, int]] = {}
    units, directions = set(), {}
    for at in there:
        (axis,) = words[at] & {*"xyz"}
        rest = words[at] - IDLE - {axis}
        unit = "".join(filter(length_called, rest))
        bracketed = re.search(r"[(\[]([^)\]]*)[)\]]", row[at])
        way = next(iter(_words(bracketed[1]) & DIRECTIONS.keys()), "") if bracketed else ""
        of_wheels = rest - {unit, way}
        if of_wheels - WHEELS.keys():
            continue
        wheel = wheel_of(of_wheels)
        if axis in columns.setdefault(wheel, {}):
            told = f"has two columns of {axis} (the second is {short(row[at])})"
            raise FileError(source, line, told, f"one for each wheel; {SAY}")
        columns[wheel][axis] = at
        units.add(length_called(unit))
        directions[axis] = way
    for wheel, three in (columns or {NO_WHEEL: {}}).items():
        if missing := [axis for axis in "xyz" if axis not in three]:
            of = f" of the {' '.join(filter(None, reversed(wheel)))} wheel" if any(wheel) else ""
            told = f"has no column of {missing[0]}{of} in {short(', '.join(row))}"
            raise FileError(source, line, told, f"columns x, y and z, such as X (mm), Left X; {SAY}")
    if len(units) > 1:
        told = f"has lengths in {', '.join(sorted(unit or 'no unit' for unit in units))}"
        raise FileError(source, line, told, "one unit in all columns")
    ways = [way for way in directions.values() if way]
    if len(ways) not in (0, 3):
        told = f"says where only some of its axes point ({', '.join(ways)})"
        raise FileError(source, line, told, "all three, or none")
    others = [at for at in range(len(row)) if at not in there]
    wheels_at = [at for at in others if words[at] and not words[at] - OF_WHEELS]
    rest_at = [at for at in others if at not in wheels_at and not _counts_lines(words[at])]
    named = sorted(rest_at, key=lambda at: (not words[at] & {"name", "names"}, not words[at] & OF_NAMES, at))
    if not named:
        raise FileError(source, line, "has no column of names", f"a column of names before x, y and z; {SAY}")
    return _Titles(
        {wheel: [three[axis] for axis in "xyz"] for wheel, three in columns.items()},
        named[0],
        wheels_at[0] if wheels_at else None,
        units.pop(),
        tuple(directions[axis] for axis in "xyz") if ways else (),
        row,
    )


def wheel_of(words: Sequence[str] | set[str]) -> Wheel:
    """The wheel of which words speak."""
    there = [WHEELS[word] for word in sorted(words) if word in WHEELS]
    return next((side for side, _ in there if side), ""), next((part for _, part in there if part), "")


def _unit_line(row: Row, titles: _Titles) -> str:
    """The unit that a line below the titles gives all coordinates; empty if it is no such line."""
    cells = [_cell(row, at).strip("()[] ") for at in sorted(titles.own)]
    units = {*map(length_called, cells)}
    return units.pop() if len(units) == 1 else ""


def _heading(row: Row) -> Wheel | None:
    """The wheel over whose points a line of words stands."""
    cells = [cell for cell in row if cell]
    words = _words(cells[0]) if len(cells) == 1 else set()
    wheel = wheel_of(words)
    return wheel if any(wheel) and not words - WHEELS.keys() - HEADING else None


# Points.


def _points_of(row: Row, titles: _Titles, heading: Wheel, source: str, line: int) -> list[FilePoint]:
    """The points of a line, or what is said in place of one."""
    name = _cell(row, titles.name_at)
    numbers = [cell for cell in row if is_number(cell)]
    if not name or (is_number(name) and not titles.said):
        if len(numbers) >= 3:
            raise FileError(source, line, "has coordinates without a name", ROW)
        return []
    value = next((cell for cell in numbers if cell != name), "")
    if not titles.said and (untitled := [at for at in titles.further(row) if not titles.title(at)]):
        told = f"has {len(numbers)} numbers for {short(name)}, some of them in columns without a title"
        allowed = f"three, or a line of titles such as Point, Left X, Left Y, Left Z, Right X; {SAY}"
        error = FileError(source, line, told, allowed)
        return [FilePoint(name, NOWHERE, line, *heading, error, row[untitled[0]])]
    at = titles.wheel_at
    of_line = NO_WHEEL if at is None else wheel_of(plain(_cell(row, at)).split())
    found: list[FilePoint] = []
    for wheel, three in titles.columns.items():
        cells = [_cell(row, at) for at in three]
        side, part = (own or of or over for own, of, over in zip(wheel, of_line, heading, strict=True))
        point = FilePoint(name, NOWHERE, line, side, part)
        try:
            found.append(replace(point, place=place_of(cells, source, line, name)))
        except FileError as error:
            # A line of words alone is a heading; one with numbers elsewhere is a mistake.
            if any(cells) or value:
                found.append(replace(point, error=error, value=next(filter(is_number, cells), value)))
    return found
