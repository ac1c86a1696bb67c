"""A table of points: a name and three numbers on each line, as spreadsheets and programs write them.

A line of titles that the format knows says which columns are x, y and z, in which unit, and of which wheel a
line is. Without one a line is a name and three numbers. Titles that are not known are not guessed at: a table
[table] in the file of names says which columns are meant. Words alone on a line are the heading of the points
that follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validate.hardpoint_files.contents import Contents, FilePoint, place_of, plain, short
from validate.measured.reading import name_and_unit
from validate.tables.cells import is_number, joined, lines_of
from validate.tables.errors import FileError
from validate.tables.units import length_called

Row = Sequence[str]
SAY = 'or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
ROW = f"a name and three numbers, separated by commas, semicolons or tabs; {SAY}"
NEEDED = ("name", "x", "y", "z")


@dataclass(frozen=True)
class _Columns:
    """Which columns a table has.

    Attributes:
        at: by name, x, y, z, and corner if there is one. unit: of lengths, if titles say it.
        row: of the titles; -1 if there is none. said: whether somebody says them.
    """

    at: Mapping[str, int]
    unit: str = ""
    row: int = -1
    said: bool = True


def read(
    text: str,
    source: str,
    titles: Mapping[str, Sequence[str]],
    said: Mapping[str, str | int],
    wheels: Mapping[str, tuple[str, str]],
) -> Contents:
    """The points of a table.

    Args:
        titles: what columns are called. said: titles or numbers of the columns that the user means.
        wheels: side and axle, by what a column of corners or a heading over the points says of them.
    Raises:
        FileError: titles are not as they must be, a point has no name, or there is no point.
    """
    lines = lines_of(text)
    if lines.mixed:
        told = "has numbers with points and with commas"
        raise FileError(source, lines.mixed, told, "one sign before the decimals, none between thousands")
    known = {plain(title): key for key, some in titles.items() for title in some}
    rows = [(line, row if lines.mark else _named(row, known)) for line, row in lines.rows]
    columns = _said(rows, said, source) if said else _titled(rows, known, source)
    points, others, section = list[FilePoint](), list[str](), ""
    ahead = (plain(row[0]) for _, row in reversed(rows[: max(columns.row, 0)]))
    over = next((words for words in ahead if words in wheels), "")
    for line, row in rows[columns.row + 1 :]:
        name, *cells = (row[at] if at < len(row) else "" for at in (columns.at[key] for key in NEEDED))
        if (not name or is_number(name)) and all(map(is_number, filter(None, row))):
            raise FileError(source, line, "has coordinates without a name", ROW)
        if not all(map(is_number, cells)):
            if not any(cells):
                section, over = ("", plain(name)) if plain(name) in wheels else (name, over)
            others += [f"{short(name)} on line {line}"] if name and any(cells) else []
            continue
        if not columns.said and (count := sum(map(is_number, row))) > 3:
            told = f"has {count} numbers for {short(name)}, in columns without a title"
            raise FileError(source, line, told, f"three, {SAY}")
        corner = columns.at.get("corner", len(row))
        side, part = wheels.get(plain(row[corner]) if corner < len(row) else over, ("", ""))
        points.append(FilePoint(name, place_of(cells, source, line, name), line, side, part, section))
    if not points:
        raise FileError(source, 0, "has no points", ROW)
    return Contents(tuple(points), unit=columns.unit, lines=tuple(others))


def _named(words: Row, titles: Mapping[str, str]) -> Row:
    """The cells of a line between blanks: numbers at its end, or their titles, and a name before."""
    count = next((n for n, word in enumerate(reversed(words)) if not is_number(word)), len(words))
    if not count:
        words = joined(words)
        places = [titles.get(plain(name_and_unit(word)[0]), "") in ("x", "y", "z") for word in words]
        count = len(words) - places.index(True) if any(places) else 0
    return [" ".join(words[: len(words) - count]), *words[len(words) - count :]]


def _said(rows: Sequence[tuple[int, Row]], said: Mapping[str, str | int], source: str) -> _Columns:
    """The columns that the user names."""
    titles = {plain(one) for one in said.values() if isinstance(one, str)}
    at = next((i for i, (_, row) in enumerate(rows) if titles and titles <= {*map(plain, row)}), -1)
    if titles and at < 0:
        told = f"has no line with the titles {', '.join(map(str, said.values()))}"
        raise FileError(source, 0, told, "titles as they stand there, or numbers of columns from 1")
    heads = [*map(plain, rows[at][1])] if titles else []
    of = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    return _Columns(of, row=at)


def _titled(rows: Sequence[tuple[int, Row]], known: Mapping[str, str], source: str) -> _Columns:
    """The columns that the first line of titles names; without one the name comes first, and then x, y, z."""
    ahead = [*rows[1:], (0, [""])]
    for i, (line, row) in enumerate(rows):
        if any(map(is_number, row)):
            break
        heads = [name_and_unit(cell) for cell in row]
        keys = [known.get(plain(head), "") for head, _ in heads]
        if {"x", "y", "z"}.isdisjoint(keys):
            # Between blanks a title of a table is one cell, and so is a line of titles that are not known.
            over = is_number(ahead[i][1][-1]) and len(row) == 1 and len(row[0].split()) > 3
            if sum(map(bool, row)) > 3 or over:
                told = f"has titles that are not known: {short(', '.join(row))}"
                raise FileError(source, line, told, f"Point, X, Y, Z; {SAY}")
            continue
        if wrong := next((key for key in NEEDED if keys.count(key) != 1), ""):
            told = f"has {keys.count(wrong) or 'no'} columns of {wrong} in {short(', '.join(row))}"
            raise FileError(source, line, told, f"one of each of Point, X, Y, Z; {SAY}")
        units = {unit for key, (_, unit) in zip(keys, heads, strict=True) if key in "xyz" and key}
        if len(units) > 1:
            raise FileError(source, line, f"says units {sorted(units)}", "one unit in all columns")
        (unit,) = units
        at = {key: column for column, key in enumerate(keys) if key}
        return _Columns(at, length_called(unit) or unit, i)
    return _Columns({key: at for at, key in enumerate(NEEDED)}, said=False)
