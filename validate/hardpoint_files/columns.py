"""A table of points: a name and three numbers on each line, as spreadsheets and programs write them.

Titles are not needed. Where there are, they say which columns are x, y and z, of which wheel, in which
unit, as in `Point, X (m), Y (m), Z (m)`; a line of wheels may stand over them, and a column may say the wheel
of each line. There may be several tables, and lines that hold no point. Titles that say it otherwise are not
guessed at: a table [table] in the file of names says which columns are meant.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import partial
from itertools import pairwise

from validate.hardpoint_files.axes import DIRECTIONS, UNITS
from validate.hardpoint_files.contents import (
    Contents,
    FilePoint,
    HardpointFileError,
    Spoilt,
    decimal_of,
    plain,
    short,
    words_of,
)

SEPARATORS = ("\t", ";", ",")
SPELLINGS = {
    **{unit: unit for unit in UNITS},
    **dict.fromkeys(("inch", "inches"), "in"),
    **dict.fromkeys(("metre", "meter", "metres", "meters"), "m"),
    **dict.fromkeys(("millimetre", "millimeter", "millimetres", "millimeters"), "mm"),
    **dict.fromkeys(("centimetre", "centimeter", "centimetres", "centimeters"), "cm"),
    **dict.fromkeys(("foot", "feet"), "ft"),
}
# Which wheel a word speaks of: its side and its axle.
WHEELS = {
    **dict.fromkeys(("left", "lh"), ("left", "")),
    **dict.fromkeys(("right", "rh"), ("right", "")),
    "front": ("", "front"),
    "rear": ("", "rear"),
    **dict.fromkeys(("fl", "lf"), ("left", "front")),
    **dict.fromkeys(("fr", "rf"), ("right", "front")),
    **dict.fromkeys(("rl", "lr"), ("left", "rear")),
    "rr": ("right", "rear"),
}
# Titles of columns that hold wheels, names, and numbers of lines; words that say nothing of a coordinate.
OF_WHEELS = words_of("corner wheel axle side end")
OF_NAMES = words_of("name names point points hardpoint hardpoints node joint label description")
OF_LINES = words_of("no nr number id index n")
IDLE = words_of("coordinate coordinates coord coords position pos location axis value")
# Words of a line that is a heading of a wheel, beside those that name it.
HEADING = words_of("suspension axle wheel corner hardpoints points side geometry coordinates")
IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
ROW = "a name and three numbers, separated by commas, semicolons or tabs"
SAY = (
    'a point a line, or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
)

Wheel = tuple[str, str]
"""A side and an axle; either may be empty."""
NOWHERE = (Decimal(0), Decimal(0), Decimal(0))
Row = Sequence[str]
Refused = Callable[[int, str, str], HardpointFileError]


@dataclass(frozen=True)
class _Titles:
    """What a line of titles says.

    Attributes:
        columns: of x, y and z, by wheel. name_at: the column of names. wheels_at: columns of wheels.
        unit: of lengths. directions: where x, y and z point. row: the line itself.
    """

    columns: Mapping[Wheel, Sequence[int]]
    name_at: int
    wheels_at: tuple[int, ...] = ()
    unit: str = ""
    directions: tuple[str, ...] = ()
    row: Row = ()

    def words_at(self, at: int) -> set[str]:
        """The words of a column's title."""
        return {*plain(self.row[at]).split()} if at < len(self.row) else set()


UNTITLED = _Titles({("", ""): (1, 2, 3)}, 0)


def read(text: str, source: str, said: Mapping[str, str | int] | None = None) -> Contents:
    """The points of a table.

    Args:
        said: titles or numbers of the columns name, x, y and z, and corner (which wheel) if there is one.
    Raises:
        HardpointFileError: titles are not as they must be, a point has no name, or there is no point.
    """
    refused = partial(HardpointFileError, source)
    rows = _rows(text, refused)
    if said:
        given = _said(rows, said, refused)
        found = [given if row == given.row else None for _, row in rows]
        titles = given
    else:
        found = [_titles(row, above, refused, line) for (_, above), (line, row) in pairwise([(0, []), *rows])]
        titles = UNTITLED
    first = next((at for at, one in enumerate(found) if one), -1)
    heading: Wheel = ("", "")
    points: list[FilePoint] = []
    spoilt: list[Spoilt] = []
    crowded: list[Spoilt] = []
    notes: dict[str, None] = {}
    units = {_unit_line(row) for _, row in rows} | {one.unit for one in found if one}
    for at, (line, row) in enumerate(rows):
        own = {i for three in titles.columns.values() for i in three}
        if (one := found[at]) is not None:
            titles = one
        elif (wheel := _heading(row)) is not None:
            # The left wheel under a heading of the front axle is the front left one.
            heading = (wheel[0], wheel[1] or heading[1])
        elif cells := [cell for i, cell in enumerate(row) if i in own and _spelt(cell)]:
            units |= {*map(_spelt, cells)}
        elif at > first:
            if not titles.row and not said:
                _require_known_titles(row, rows[at + 1 : at + 2], refused, line)
            further = _further(row, titles, own)
            if said or all(titles.words_at(i) for i in further):
                new, broken = _points_of(row, titles, heading, refused, line)
                points += new
                for i in further if new else ():
                    which = short(titles.row[i]) if titles.words_at(i) else f"number {i + 1}"
                    notes[f"the column {which} is not read"] = None
                spoilt += broken
                continue
            name, numbers = row[titles.name_at], sum(map(_number, row))
            told = f"has {numbers} numbers for {short(name)}, some of them in columns without a title"
            allowed = f"three, or a line of titles such as Point, Left X, Left Y, Left Z, Right X; {SAY}"
            point = FilePoint(name, NOWHERE, line, *heading)
            spoilt.append(Spoilt(point, refused(line, told, allowed), next(filter(_number, row))))
            crowded = crowded or spoilt[-1:]
    _one_decimal_sign(rows, refused)
    if not points:
        wrong = crowded or (spoilt if first >= 0 else [])
        raise wrong[0].error if wrong else refused(0, "has no points", f"{ROW}; {SAY}")
    units.discard("")
    directions = {one.directions for one in found if one and one.directions}
    if len(units) > 1 or units - UNITS.keys():
        told = f"has lengths in {', '.join(sorted(units))}"
        raise refused(rows[max(first, 0)][0], told, f"one of {', '.join(UNITS)} in all columns")
    if len(directions) > 1:
        raise refused(0, "has tables in different axes", "a file for each")
    return Contents(
        tuple(points),
        unit=units.pop() if units else "",
        axes=next(iter(directions), ()),
        turned=next((words for _, row in rows if (words := _turned(row))), ""),
        spoilt=tuple(spoilt),
        notes={"": tuple(notes)} if notes else {},
    )


# Lines and cells.


def _rows(text: str, refused: Refused) -> list[tuple[int, Row]]:
    """The lines that hold something, with their numbers, as cells."""
    lines = [re.sub(r"\([^()]*\)|\[[^\[\]]*\]", "", line) for line in text.splitlines() if line.strip()]
    # What stands three times on most lines, not in brackets; numbers may have commas, so they come last.
    often = {mark: sum(line.count(mark) >= 3 for line in lines) for mark in SEPARATORS}
    separator = max(SEPARATORS, key=lambda mark: (often[mark], any(mark in line for line in lines)))
    rows: list[tuple[int, Row]]
    if not any(mark in text for mark in SEPARATORS):
        rows = [
            (at, re.split(r"\s{2,}", _spaced(line.strip()))) for at, line in enumerate(text.splitlines(), 1)
        ]
    else:
        try:
            reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True)
            rows = [(reader.line_num, [part for cell in row for part in _parts(cell)]) for row in reader]
        except csv.Error as error:
            raise refused(0, f"is no table: {error}", ROW) from None
    rows = [(line, row) for line, row in rows if any(row) and not row[0].startswith("#")]
    if not rows:
        raise refused(0, "has no points", ROW)
    return rows


def _spaced(line: str) -> str:
    """A line of words and three numbers or more, with the numbers apart from the words."""
    words = line.split()
    count = next((n for n, word in enumerate(reversed(words)) if not _number(word)), len(words))
    # A fourth number may end the name, as in `LBJ 2 6.5 705 132`; more are coordinates of another wheel.
    count = 3 if count == 4 and words[-4].isdigit() else count
    return "  ".join([" ".join(words[:-count]), *words[-count:]]) if 3 <= count < len(words) else line


def _parts(cell: str) -> list[str]:
    """A cell; of three numbers in brackets, as in `(-110, 257, 69)`, each by itself."""
    inner = cell.strip("()[] ")
    parts = re.split(r"\s*;\s*" if ";" in inner else r"\s*,\s+|\s+|,", inner)
    return parts if len(parts) == 3 and all(map(_number, parts)) else [cell.strip()]


def _number(cell: str) -> bool:
    return re.fullmatch(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?", cell.strip("()[] ")) is not None


def _spelt(cell: str) -> str:
    """The unit that a cell holds and nothing else."""
    return SPELLINGS.get(cell.strip("()[] ").lower(), "")


# Titles, and lines that are no points.


def _said(rows: Sequence[tuple[int, Row]], said: Mapping[str, str | int], refused: Refused) -> _Titles:
    """The columns that the user names."""
    titles = {plain(one) for one in said.values() if isinstance(one, str)}
    row: Row = next((row for _, row in rows if titles and titles <= {*map(plain, row)}), [])
    if titles and not row:
        told = f"has no line with the titles {', '.join(str(one) for one in said.values())}"
        raise refused(0, told, "titles as they stand there, or numbers of columns from 1")
    heads = [*map(plain, row)]
    at = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    wheels = (at["corner"],) if "corner" in at else ()
    return _Titles({("", ""): (at["x"], at["y"], at["z"])}, at["name"], wheels, row=row)


def _titles(row: Row, above: Row, refused: Refused, line: int) -> _Titles | None:
    """What a line of titles says; None if this is none."""
    words = [plain(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", cell)).split() for cell in row]
    axes = [[word for word in cell if word in ("x", "y", "z")] for cell in words]
    there = [at for at, axis in enumerate(axes) if len(axis) == 1]
    if any(map(_number, row)) or len({axes[at][0] for at in there}) < 2:
        return None
    # A heading stays for what follows, whatever the titles; numbers are no words over columns.
    if any(map(_number, above)) or _heading(above) is not None:
        above = []
    idle = {"x", "y", "z"} | IDLE | SPELLINGS.keys() | WHEELS.keys() | DIRECTIONS.keys()
    clean = [at for at in there if not set(words[at]) - idle]
    if {axes[at][0] for at in clean} != {"x", "y", "z"}:
        clean = there
    directions = {axes[at][0]: _direction(row[at]) for at in clean}
    over = [_wheel_of(plain(cell).split()) for cell in above]
    columns: dict[Wheel, dict[str, int]] = {}
    for at in clean:
        axis = axes[at][0]
        wheel = _wheel_of([word for word in words[at] if word != directions[axis]])
        if not any(wheel):
            wheel = next((one for one in reversed(over[: at + 1]) if any(one)), wheel)
        if axis in columns.setdefault(wheel, {}):
            told = f"has two columns of {axis} (the second is {short(row[at])})"
            raise refused(line, told, f"one for each wheel; {SAY}")
        columns[wheel][axis] = at
    for wheel, three in columns.items():
        if missing := [axis for axis in "xyz" if axis not in three]:
            of = f" of the {' '.join(filter(None, reversed(wheel)))} wheel" if any(wheel) else ""
            raise refused(line, f"has no column of {missing[0]}{of}", f"columns x, y and z; {SAY}")
    said = [word for word in directions.values() if word]
    if said and len(said) < 3:
        told = f"says where only some of its axes point ({', '.join(said)})"
        raise refused(line, told, "all three, or none")
    units = {unit for at in clean if (unit := _unit_of(row[at], words[at][-1]))}
    if len(units) > 1:
        told = f"has lengths in {', '.join(sorted(units))}"
        raise refused(line, told, f"one of {', '.join(UNITS)} in all columns")
    others = [at for at in range(len(row)) if at not in there]
    wheels_at = tuple(at for at in others if words[at] and not set(words[at]) - OF_WHEELS)
    # A column of names may have its title a line higher.
    named = [
        (not {"name", "names"} & {*said_so}, bool({*said_so} - OF_NAMES), at)
        for titled in (row, above)
        for at in others
        if at < len(titled) and at not in wheels_at
        for said_so in [plain(titled[at]).split()]
        if OF_NAMES & {*said_so}
    ]
    rest = [at for at in others if at not in wheels_at and not (words[at] and not set(words[at]) - OF_LINES)]
    if not named and not rest:
        raise refused(line, "has no column of names", f"a column of names before x, y and z; {SAY}")
    return _Titles(
        {wheel: [three[axis] for axis in "xyz"] for wheel, three in columns.items()},
        min(named)[2] if named else rest[0],
        wheels_at,
        units.pop() if units else "",
        tuple(directions[axis] for axis in "xyz") if said else (),
        row,
    )


def _require_known_titles(row: Row, below: Sequence[tuple[int, Row]], refused: Refused, line: int) -> None:
    """Refuse a line of words over the three numbers of a point: it says what they are, and is not read."""
    if not below or any(map(_number, row)) or len(row) < 4 or not all(row[1:4]):
        return
    if len(below[0][1]) > 3 and all(map(_number, below[0][1][1:4])):
        told = f"has titles that are not known: {short(', '.join(row[1:]))}"
        raise refused(line, told, f"X, Y, Z; of both wheels Left X, Left Y, Left Z, Right X; {SAY}")


def _direction(title: str) -> str:
    """Where an axis points by its title's brackets, as in `Y (left)`."""
    found = re.search(r"[(\[]([^)\]]*)[)\]]", title)
    words = [word for word in plain(found[1]).split() if word in DIRECTIONS] if found else []
    return words[0] if len(words) == 1 else ""


def _unit_of(title: str, last: str) -> str:
    """The unit in a title, in brackets or as its last word; an unknown one as it stands there."""
    found = re.search(r"[(\[]\s*([A-Za-z]+)\s*[)\]]", title)
    if found and found[1].lower() not in (*DIRECTIONS, *WHEELS):
        return SPELLINGS.get(found[1].lower(), found[1].lower())
    return SPELLINGS.get(last, "")


def _wheel_of(words: Sequence[str]) -> Wheel:
    """The wheel of which words speak."""
    there = [WHEELS[word] for word in words if word in WHEELS]
    return next((side for side, _ in there if side), ""), next((part for _, part in there if part), "")


def _heading(row: Row) -> Wheel | None:
    """The wheel over whose points a line of words stands."""
    cells = [cell for cell in row if cell]
    words = plain(cells[0]).split() if len(cells) == 1 else []
    wheel = _wheel_of(words)
    return wheel if any(wheel) and not set(words) - WHEELS.keys() - HEADING else None


def _unit_line(row: Row) -> str:
    """The unit of lengths that a line of settings gives, as in `Length, millimetre, mm`."""
    cells = [cell.lower() for cell in row if cell]
    at = cells.index("length") + 1 if "length" in cells else len(cells)
    return next((SPELLINGS[cell] for cell in cells[at : at + 2] if cell in SPELLINGS), "")


def _turned(row: Row) -> str:
    """A coordinate system that a line of settings gives and that is not its program's own."""
    for at, cell in enumerate(row[:-1]):
        if plain(cell) == "coordinate system":
            # A spreadsheet writes the end of a line in a cell as _x000D_.
            numbers = re.findall(r"[-+]?\d+(?:\.\d*)?", re.sub(r"_x[0-9A-Fa-f]{4}_", " ", row[at + 1]))
            return f"{cell} {' '.join(numbers)}" if numbers and list(map(float, numbers)) != IDENTITY else ""
    return ""


# Points.


def _points_of(
    row: Row, titles: _Titles, heading: Wheel, refused: Refused, line: int
) -> tuple[list[FilePoint], list[Spoilt]]:
    """The points of a line, and what is said in place of one."""
    name = row[titles.name_at] if titles.name_at < len(row) else ""
    numbers = [cell for at, cell in enumerate(row) if at != titles.name_at and _number(cell)]
    if not name or (_number(name) and len(numbers) == 2):
        error = refused(line, "has coordinates without a name", ROW)
        if len(numbers) + _number(name) >= 3:
            raise error
        return [], [Spoilt(FilePoint("", NOWHERE, line), error, "")] if numbers else []
    value = next(iter(numbers), "")
    cells = {
        wheel: [row[at] if at < len(row) else "" for at in three] for wheel, three in titles.columns.items()
    }
    if not any(any(three) for three in cells.values()):
        # A line of words alone is a heading; one with numbers elsewhere is a mistake.
        error = refused(line, f"has no coordinates for {short(name)}", ROW)
        return [], [Spoilt(FilePoint(name, NOWHERE, line, *heading), error, value)] if numbers else []
    of_line = _wheel_of([word for at in titles.wheels_at if at < len(row) for word in plain(row[at]).split()])
    points: list[FilePoint] = []
    spoilt: list[Spoilt] = []
    for wheel, three in cells.items():
        side, part = (own or of or over for own, of, over in zip(wheel, of_line, heading, strict=True))
        point = FilePoint(name, NOWHERE, line, side, part)
        try:
            x, y, z = (
                _coordinate(cell, f"{axis} of {short(name)}", refused, line)
                for axis, cell in zip("xyz", three, strict=True)
            )
            points.append(replace(point, place=(x, y, z)))
        except HardpointFileError as error:
            if any(three):
                spoilt.append(Spoilt(point, error, next(filter(_number, three), value)))
    return points, spoilt


def _further(row: Row, titles: _Titles, own: set[int]) -> list[int]:
    """The columns of a line's numbers beside a point's own; what is ahead of a name may count the lines."""
    if not all(at < len(row) and row[at] for at in next(iter(titles.columns.values()))):
        return []
    read = own | {titles.name_at, *titles.wheels_at}
    return [
        at
        for at, cell in enumerate(row)
        if at not in read
        and at > min(titles.name_at, *own)
        and _number(cell)
        and not (titles.words_at(at) and not titles.words_at(at) - OF_LINES)
    ]


def _coordinate(cell: str, what: str, refused: Refused, line: int) -> Decimal:
    bare = cell.strip("()[] ")
    # A comma separates nothing within a cell: it stands for the point of a number.
    text = bare.replace(",", ".") if re.fullmatch(r"[-+]?\d*,\d+", bare) else bare
    return decimal_of(text, refused(line, "", "").source, line, what)


def _one_decimal_sign(rows: Sequence[tuple[int, Row]], refused: Refused) -> None:
    """Refuse a table in which 1,234 may be a thousand or one and some."""
    cells = [(line, cell) for line, row in rows for cell in row if _number(cell)]
    comma = next(((line, cell) for line, cell in cells if "," in cell), None)
    if comma and any("." in cell for _, cell in cells):
        told = f"has numbers with points and with commas ({short(comma[1])})"
        raise refused(comma[0], told, "one sign before the decimals, none between thousands")
