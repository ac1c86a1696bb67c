"""A table of points: a name and three numbers on each line, as spreadsheets and programs write them.

Titles are not needed. Where there are, they say which columns are x, y and z, of which wheel, in which
unit, as in `Point, X (m), Y (m), Z (m)`; a line of wheels may stand over them, and a column may say the wheel
of each line. There may be several tables, and lines that hold no point. A table may lie on its side, and
three numbers may stand in one cell.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal

from validate.hardpoint_files.axes import DIRECTIONS, UNITS
from validate.hardpoint_files.contents import (
    Contents,
    FilePoint,
    HardpointFileError,
    Place,
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
    "left": ("left", ""),
    "right": ("right", ""),
    "lh": ("left", ""),
    "rh": ("right", ""),
    "front": ("", "front"),
    "rear": ("", "rear"),
    **dict.fromkeys(("fl", "lf"), ("left", "front")),
    **dict.fromkeys(("fr", "rf"), ("right", "front")),
    **dict.fromkeys(("rl", "lr"), ("left", "rear")),
    "rr": ("right", "rear"),
}
# A lonely r is right beside an l, and rear beside an f.
BESIDE = {"l": {"l": ("left", ""), "r": ("right", "")}, "f": {"f": ("", "front"), "r": ("", "rear")}}
# Titles of columns that hold wheels, names, and numbers of lines; words that say nothing of a coordinate.
OF_WHEELS = words_of("corner wheel axle side end")
OF_NAMES = words_of("name point points hardpoint hardpoints node joint label description")
OF_LINES = words_of("no nr number id index n")
IDLE = words_of("coordinate coordinates coord coords position pos location axis value")
# Words of a line that is a heading of a wheel, beside those that name it.
HEADING = words_of("suspension axle wheel corner hardpoints points side geometry coordinates")
IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
ROW = "a name and three numbers, separated by commas, semicolons or tabs"

Wheel = tuple[str, str]
"""A side and an axle; either may be empty."""

NOWHERE = (Decimal(0), Decimal(0), Decimal(0))

Row = Sequence[str]


@dataclass(frozen=True)
class _Titles:
    """What a line of titles says.

    Attributes:
        columns: of x, y and z, by wheel. name_at: the column of names. wheels_at: columns of wheels.
        unit: of lengths. directions: where x, y and z point. row: the line itself.
        wheels: the words of wheels in `wheels_at`.
    """

    columns: Mapping[Wheel, Mapping[str, int]]
    name_at: int
    wheels_at: tuple[int, ...] = ()
    unit: str = ""
    directions: tuple[str, ...] = ()
    row: Row = ()
    wheels: Mapping[str, Wheel] = field(default_factory=dict)


UNTITLED = _Titles({("", ""): {"x": 1, "y": 2, "z": 3}}, 0)


def read(text: str, source: str) -> Contents:
    """The points of a table.

    Raises:
        HardpointFileError: titles are not as they must be, a point has no name, or there is no point.
    """
    rows = _upright(_rows(text, source), source)
    points: list[FilePoint] = []
    spoilt: list[Spoilt] = []
    notes: list[str] = []
    units = {_unit_line(row) for _, row in rows} - {""}
    directions: set[tuple[str, ...]] = set()
    titles, heading = UNTITLED, ("", "")
    above: list[Row] = [[], *(row for _, row in rows)]
    found = [_titles(row, above[at], source, line) for at, (line, row) in enumerate(rows)]
    first = next((at for at, one in enumerate(found) if one), -1)
    for at, (line, row) in enumerate(rows):
        one = found[at]
        if one is not None:
            titles = replace(one, wheels=_wheels_of_lines(one, [row for _, row in rows[at + 1 :]]))
            directions.add(titles.directions)
            units |= {titles.unit} - {""}
        elif (wheel := _heading(row)) is not None:
            # The left wheel under a heading of the front axle is the front left one.
            heading = (wheel[0], wheel[1] or heading[1])
        elif (of_line := _units_only(row, titles)) is not None:
            units |= of_line
        elif at > first:
            further = _not_read(row, titles)
            unread = [titles.row[i] for i in further if i < len(titles.row) and titles.row[i]]
            if len(unread) < len(further):
                spoilt.append(_crowded(row, titles, heading, source, line))
                continue
            _require_known_titles(row, rows[at + 1 : at + 2], titles, source, line)
            new, broken = _points_of(row, titles, heading, source, line)
            points += new
            spoilt += broken
            if new:
                notes += [f"the column {short(title)} is not read" for title in unread]
    _one_decimal_sign(rows, source)
    if not points:
        crowded = any(_not_read(row, titles) for _, row in rows)
        if spoilt and (first >= 0 or crowded):
            raise spoilt[0].error
        raise HardpointFileError(source, 0, "has no points", ROW)
    spelt = {SPELLINGS.get(unit, unit) for unit in units}
    if len(spelt) > 1 or spelt - UNITS.keys():
        line = rows[max(first, 0)][0]
        allowed = f"one of {', '.join(UNITS)} in all columns"
        raise HardpointFileError(source, line, f"has lengths in {', '.join(sorted(spelt))}", allowed)
    told = directions - {()}
    if len(told) > 1:
        raise HardpointFileError(source, 0, "has tables in different axes", "a file for each")
    return Contents(
        tuple(points),
        unit=spelt.pop() if spelt else "",
        axes=next(iter(told), ()),
        turned=next((words for _, row in rows if (words := _turned(row))), ""),
        spoilt=tuple(spoilt),
        notes={"": tuple(dict.fromkeys(notes))} if notes else {},
    )


# Lines and cells.


def _rows(text: str, source: str) -> list[tuple[int, Row]]:
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
            rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
        except csv.Error as error:
            raise HardpointFileError(source, 0, f"is no table: {error}", ROW) from None
    rows = [(line, row) for line, row in rows if any(row) and not row[0].startswith("#")]
    if not rows:
        raise HardpointFileError(source, 0, "has no points", ROW)
    return rows


def _spaced(line: str) -> str:
    """A line of words and three numbers or more, with the numbers apart from the words."""
    words = line.split()
    count = next((n for n, word in enumerate(reversed(words)) if not _number(word)), len(words))
    # A fourth number may end the name, as in `LBJ 2 6.5 705 132`; more are coordinates of another wheel.
    count = 3 if count == 4 and words[-4].isdigit() else count
    if not 3 <= count < len(words):
        return line
    return "  ".join([" ".join(words[:-count]), *words[-count:]])


def _number(cell: str) -> bool:
    return re.fullmatch(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?", cell.strip("()[] ")) is not None


def _upright(rows: list[tuple[int, Row]], source: str) -> list[tuple[int, Row]]:
    """The lines of a table; of one that lies on its side, its columns."""
    firsts = [plain(next(filter(None, row))).split() for _, row in rows]
    at = [
        i
        for i in range(1, len(rows) - 2)
        if all(
            set(words) & {"x", "y", "z"} == {axis} and _numbers_in(rows[i + j][1]) >= 2
            for j, (axis, words) in enumerate(zip("xyz", firsts[i : i + 3], strict=True))
        )
    ]
    if not at:
        return rows
    if len(at) > 1:
        raise HardpointFileError(
            source,
            rows[at[1]][0],
            "has a second table that lies on its side",
            "one, or a table with a point a line",
        )
    names, three = rows[at[0] - 1][1], [rows[at[0] + j] for j in range(3)]
    wide = max(len(row) for _, row in three)
    titles = ["Point", *(next(filter(None, row)) for _, row in three)]
    skip = next(i for i, cell in enumerate(three[0][1]) if cell)
    return [
        (three[0][0], titles),
        *(
            (
                three[0][0],
                [names[i] if i < len(names) else "", *(row[i] if i < len(row) else "" for _, row in three)],
            )
            for i in range(skip + 1, wide)
        ),
    ]


def _numbers_in(row: Row) -> int:
    return sum(map(_number, row))


# Titles, and lines that are no points.


def _titles(row: Row, above: Row, source: str, line: int) -> _Titles | None:
    """What a line of titles says; None if this is none."""
    if any(map(_number, row)):
        return None
    words = _words_of_titles(row)
    axes = [[word for word in cell if word in ("x", "y", "z")] for cell in words]
    if len({axis[0] for axis in axes if len(axis) == 1}) < 2:
        return None
    # A heading stays for what follows, whatever the titles; numbers are no words over columns.
    if any(map(_number, above)) or _heading(above) is not None:
        above = []
    letters = {word for cell, axis in zip(words, axes, strict=True) if axis for word in cell}
    wheels = _with_letters(letters | {plain(cell) for cell in above})
    there = [at for at, axis in enumerate(axes) if len(axis) == 1]
    idle = {"x", "y", "z"} | IDLE | SPELLINGS.keys() | wheels.keys() | DIRECTIONS.keys()
    clean = [at for at in there if not set(words[at]) - idle]
    if {axes[at][0] for at in clean} != {"x", "y", "z"}:
        clean = there
    directions = {axes[at][0]: _direction(row[at]) for at in clean}
    over = [_wheel_of(plain(cell).split(), wheels) for cell in above]
    columns: dict[Wheel, dict[str, int]] = {}
    for at in clean:
        wheel = _wheel_of([word for word in words[at] if word != directions[axes[at][0]]], wheels)
        if wheel == ("", ""):
            wheel = next((one for one in reversed(over[: at + 1]) if one != ("", "")), wheel)
        if axes[at][0] in columns.setdefault(wheel, {}):
            told = f"has two columns of {axes[at][0]} (the second is {short(row[at])})"
            raise HardpointFileError(source, line, told, "one for each wheel")
        columns[wheel][axes[at][0]] = at
    for wheel, three in columns.items():
        missing = [axis for axis in "xyz" if axis not in three]
        if missing:
            of = f" of the {' '.join(filter(None, reversed(wheel)))} wheel" if any(wheel) else ""
            raise HardpointFileError(source, line, f"has no column of {missing[0]}{of}", "columns x, y and z")
    said = [word for word in directions.values() if word]
    if said and len(said) < 3:
        raise HardpointFileError(
            source, line, f"says where only some of its axes point ({', '.join(said)})", "all three, or none"
        )
    units = {unit for at in clean if (unit := _unit_of(row[at], words[at][-1]))}
    if len(units) > 1:
        allowed = f"one of {', '.join(UNITS)} in all columns"
        raise HardpointFileError(source, line, f"has lengths in {', '.join(sorted(units))}", allowed)
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
        raise HardpointFileError(
            source, line, "has no column of names", "a column of names before x, y and z"
        )
    return _Titles(
        columns,
        min(named)[2] if named else rest[0],
        wheels_at,
        units.pop() if units else "",
        tuple(directions[axis] for axis in "xyz") if said else (),
        row,
    )


def _words_of_titles(row: Row) -> list[list[str]]:
    """The words of each title; `XL`, `LX`, `xLeft`, `X1` and `Xmm` are x and another word.

    A letter that is written to an axis is that of a wheel where the other wheel has its own, or where no
    other title is an axis: beside x, y and z, the titles RX, RY and RZ may be turns.
    """
    cells = [plain(cell).split() for cell in row]
    axes = sum(word in ("x", "y", "z") for cell in cells for word in cell)
    parted = [[_parted(word) for word in cell] for cell in cells]
    letters = {two[1] for cell in parted for two in cell if len(two) == 2 and two[1] in ("l", "r", "f")}
    alone = len(letters) == 1 and axes > 0
    return [
        [
            part
            for word, two in zip(cell, of, strict=True)
            for part in ((word,) if alone and letters & {*two} else two)
        ]
        for cell, of in zip(cells, parted, strict=True)
    ]


def _parted(word: str) -> tuple[str, ...]:
    """An axis and what is written to it; the word itself if it is not so."""
    # Not an f before it: FX is a force.
    wheel = "|".join(sorted(WHEELS, key=len, reverse=True))
    behind = re.fullmatch(rf"([xyz])({wheel}|l|r|f|\d+|{'|'.join(SPELLINGS)})", word)
    if behind:
        return behind[1], behind[2]
    ahead = re.fullmatch(rf"({wheel}|l|r)([xyz])", word)
    return (ahead[2], ahead[1]) if ahead else (word,)


def _with_letters(words: set[str]) -> Mapping[str, Wheel]:
    """The words of wheels, with the letters that stand among these words."""
    return WHEELS | (BESIDE["f"] if "f" in words else BESIDE["l"] if "l" in words or "r" in words else {})


def _wheels_of_lines(titles: _Titles, rows: Sequence[Row]) -> Mapping[str, Wheel]:
    """The words of wheels in the columns that have them."""
    return _with_letters({plain(row[at]) for row in rows for at in titles.wheels_at if at < len(row)})


def _direction(title: str) -> str:
    """Where an axis points by its title's brackets, as in `Y (left)`."""
    found = re.search(r"[(\[]([^)\]]*)[)\]]", title)
    words = [word for word in plain(found[1]).split() if word in DIRECTIONS] if found else []
    return words[0] if len(words) == 1 else ""


def _unit_of(title: str, last: str) -> str:
    """The unit in a title, in brackets or as its last word; an unknown one as it stands there."""
    found = re.search(r"[(\[]\s*([A-Za-z]+)\s*[)\]]", title)
    if found and found[1].lower() not in (*DIRECTIONS, *WHEELS, "l", "r", "f"):
        return SPELLINGS.get(found[1].lower(), found[1].lower())
    return SPELLINGS.get(last, "")


def _wheel_of(words: Sequence[str], known: Mapping[str, Wheel]) -> Wheel:
    """The wheel of which words speak."""
    there = [known[word] for word in words if word in known]
    return next((side for side, _ in there if side), ""), next((part for _, part in there if part), "")


def _heading(row: Row) -> Wheel | None:
    """The wheel over whose points a line of words stands."""
    cells = [cell for cell in row if cell]
    words = plain(cells[0]).split() if len(cells) == 1 else []
    wheel = _wheel_of(words, WHEELS)
    return wheel if any(wheel) and not set(words) - WHEELS.keys() - HEADING else None


def _units_only(row: Row, titles: _Titles) -> set[str] | None:
    """The units of a line that holds nothing else, under titles."""
    cells = [row[at] for three in titles.columns.values() for at in three.values() if at < len(row)]
    words = [cell.strip("()[] ").lower() for cell in cells]
    return set(words) if words and all(word in SPELLINGS for word in words) else None


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
    row: Row, titles: _Titles, heading: Wheel, source: str, line: int
) -> tuple[list[FilePoint], list[Spoilt]]:
    """The points of a line, and what is said in place of one."""
    name = row[titles.name_at] if titles.name_at < len(row) else ""
    cells = {
        wheel: [row[three[axis]] if three[axis] < len(row) else "" for axis in "xyz"]
        for wheel, three in titles.columns.items()
    }
    given = {wheel: three for wheel, three in cells.items() if any(three)}
    if not name or (_number(name) and _numbers_in(row) == 3):
        error = HardpointFileError(source, line, "has coordinates without a name", ROW)
        if _numbers_in(row) >= 3:
            raise error
        return [], [Spoilt(FilePoint("", NOWHERE, line), error, "")] if _numbers_in(row) else []
    together = [triple for at, cell in enumerate(row) if at != titles.name_at and (triple := _together(cell))]
    if together and not any(_number(cell) for three in given.values() for cell in three):
        if len(together) != len(titles.columns):
            told = f"has {len(together)} places for {short(name)}"
            raise HardpointFileError(source, line, told, "one, or columns of x, y and z for each wheel")
        given = dict(zip(titles.columns, together, strict=True))
    if not given:
        # A line of words alone is a heading; one with numbers elsewhere is a mistake.
        if not any(_number(cell) for at, cell in enumerate(row) if at != titles.name_at):
            return [], []
        error = HardpointFileError(source, line, f"has no coordinates for {short(name)}", ROW)
        return [], [Spoilt(FilePoint(name, NOWHERE, line, *heading), error, _first_number(row, titles))]
    words = [word for at in titles.wheels_at if at < len(row) for word in plain(row[at]).split()]
    of_line = _wheel_of(words, titles.wheels)
    points: list[FilePoint] = []
    spoilt: list[Spoilt] = []
    for wheel, three in given.items():
        side, part = (own or of or over for own, of, over in zip(wheel, of_line, heading, strict=True))
        point = FilePoint(name, NOWHERE, line, side, part)
        try:
            points.append(replace(point, place=_place(name, three, source, line)))
        except HardpointFileError as error:
            own = next(filter(_number, three), "")
            spoilt.append(Spoilt(point, error, own or _first_number(row, titles)))
    return points, spoilt


def _not_read(row: Row, titles: _Titles) -> list[int]:
    """The columns of a line's numbers beside a point's own; what is ahead of a name may count the lines."""
    own = {at for three in titles.columns.values() for at in three.values()}
    read = own | {titles.name_at, *titles.wheels_at}
    if not all(at < len(row) and row[at] for at in next(iter(titles.columns.values())).values()):
        return []
    return [
        at
        for at, cell in enumerate(row)
        if at not in read
        and at > min(titles.name_at, *own)
        and _number(cell)
        and not (at < len(titles.row) and (said := {*plain(titles.row[at]).split()}) and not said - OF_LINES)
    ]


def _crowded(row: Row, titles: _Titles, heading: Wheel, source: str, line: int) -> Spoilt:
    """A line with numbers that no title speaks of: which of them are the point's is not known."""
    name = row[titles.name_at]
    told = f"has {_numbers_in(row)} numbers for {short(name)}, some of them in columns without a title"
    allowed = "three, or a line of titles such as Point, Left X, Left Y, Left Z, Right X, Right Y, Right Z"
    error = HardpointFileError(source, line, told, allowed)
    return Spoilt(FilePoint(name, NOWHERE, line, *heading), error, _first_number(row, titles))


def _require_known_titles(
    row: Row, below: Sequence[tuple[int, Row]], titles: _Titles, source: str, line: int
) -> None:
    """Refuse a line of words over the three numbers of a point: it says what they are, and is not read."""
    if titles.row or not below or any(map(_number, row)) or len(row) < 4 or not all(row[1:4]):
        return
    if all(at < len(below[0][1]) and _number(below[0][1][at]) for at in (1, 2, 3)):
        told = f"has titles that are not known: {short(', '.join(row[1:]))}"
        allowed = "X, Y, Z; of both wheels Left X, Left Y, Left Z, Right X, Right Y, Right Z"
        raise HardpointFileError(source, line, told, allowed)


def _first_number(row: Row, titles: _Titles) -> str:
    return next((cell for at, cell in enumerate(row) if at != titles.name_at and _number(cell)), "")


def _together(cell: str) -> list[str] | None:
    """Three numbers of one cell, as in `(-110, 257, 69)`."""
    inner = cell.strip("()[] ")
    parts = re.split(r"\s*;\s*" if ";" in inner else r"\s*,\s+|\s+|,", inner)
    return parts if len(parts) == 3 and all(map(_number, parts)) else None


def _place(name: str, cells: Sequence[str], source: str, line: int) -> Place:
    numbers = []
    for axis, cell in zip("xyz", cells, strict=True):
        bare = cell.strip("()[] ")
        # A comma separates nothing within a cell: it stands for the point of a number.
        text = bare.replace(",", ".") if re.fullmatch(r"[-+]?\d*,\d+", bare) else bare
        numbers.append(decimal_of(text, source, line, f"{axis} of {short(name)}"))
    return numbers[0], numbers[1], numbers[2]


def _one_decimal_sign(rows: Sequence[tuple[int, Row]], source: str) -> None:
    """Refuse a table in which 1,234 may be a thousand or one and some."""
    cells = [(line, cell) for line, row in rows for cell in row if _number(cell)]
    comma = next(((line, cell) for line, cell in cells if "," in cell), None)
    if comma and any("." in cell for _, cell in cells):
        told = f"has numbers with points and with commas ({short(comma[1])})"
        raise HardpointFileError(
            source, comma[0], told, "one sign before the decimals, none between thousands"
        )
