"""Reads a table of points: a name and three numbers on each line, as spreadsheets and programs write it.

A line of known titles gives the columns of x, y and z, their unit, and the column of the wheel. Without
titles, a line is a name and three numbers. Unknown titles are refused; [table] in the file of names can give
the columns. A line of words only is the heading of the points that follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validate.hardpoint_files.contents import Contents, FilePoint, place_of, plain, short
from validate.measured.reading import name_and_unit
from validate.plain_text import counted_as
from validate.tables.cells import is_number, joined, lines_of
from validate.tables.errors import FileError
from validate.tables.units import length_called

Row = Sequence[str]
SAY = 'or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
ROW = f"a name and three numbers, separated by commas, semicolons or tabs; {SAY}"
NEEDED = ("name", "x", "y", "z")


@dataclass(frozen=True)
class _Columns:
    """The columns of a table.

    Attributes:
        at: index of the columns name, x, y, z, and corner if there is one.
        unit: unit of lengths, if the titles give it.
        row: index of the row of titles; -1 if there is none.
        said: whether titles or the user give the columns.
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
        titles: possible titles of the columns. said: titles or numbers of the columns from the user.
        wheels: side and axle by the text in the column of corners or in a heading.
    Raises:
        FileError: the titles are wrong, a point has no name, or there are no points.
    """
    lines = lines_of(text)
    if lines.mixed:
        problem = "has numbers with points and with commas"
        raise FileError(source, lines.mixed, problem, "one decimal sign, and none between thousands")
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
            problem = f"has {count} numbers for {short(name)}, in columns without a title"
            raise FileError(source, line, problem, f"three, {SAY}")
        if columns.row >= 0 and any(map(is_number, row[(count := len(rows[columns.row][1])) :])):
            problem = f"has {counted_as(len(row), 'cell')} under {counted_as(count, 'title')}"
            raise FileError(source, line, problem, "a title for each number, and no comma inside a number")
        corner = columns.at.get("corner", len(row))
        side, part = wheels.get(plain(row[corner]) if corner < len(row) else over, ("", ""))
        points.append(FilePoint(name, place_of(cells, source, line, name), line, side, part, section))
    if not points:
        raise FileError(source, 0, "has no points", ROW)
    return Contents(tuple(points), unit=columns.unit, lines=tuple(others))


def _named(words: Row, titles: Mapping[str, str]) -> Row:
    """The cells of a line separated by blanks: a name, then the numbers or their titles at the end."""
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
        problem = f"has no line with the titles {', '.join(map(str, said.values()))}"
        raise FileError(source, 0, problem, "titles as in the file, or numbers of columns from 1")
    heads = [*map(plain, rows[at][1])] if titles else []
    of = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    return _Columns(of, row=at)


def _titled(rows: Sequence[tuple[int, Row]], known: Mapping[str, str], source: str) -> _Columns:
    """The columns from the first line of titles; without titles the columns are name, x, y, z."""
    ahead = [*rows[1:], (0, [""])]
    for i, (line, row) in enumerate(rows):
        if any(map(is_number, row)):
            break
        heads = [name_and_unit(cell) for cell in row]
        keys = [known.get(plain(head), "") for head, _ in heads]
        if {"x", "y", "z"}.isdisjoint(keys):
            # If cells are separated by blanks, a heading is one cell, and so is a line of unknown titles.
            over = is_number(ahead[i][1][-1]) and len(row) == 1 and len(row[0].split()) > 3
            if sum(map(bool, row)) > 3 or over:
                problem = f"has unknown titles: {short(', '.join(row))}"
                raise FileError(source, line, problem, f"Point, X, Y, Z; {SAY}")
            continue
        if wrong := next((key for key in NEEDED if keys.count(key) != 1), ""):
            problem = f"has {keys.count(wrong) or 'no'} columns of {wrong} in {short(', '.join(row))}"
            raise FileError(source, line, problem, f"one of each of Point, X, Y, Z; {SAY}")
        units = {unit for key, (_, unit) in zip(keys, heads, strict=True) if key in "xyz" and key}
        if len(units) > 1:
            raise FileError(source, line, f"has units {sorted(units)}", "one unit in all columns")
        (unit,) = units
        at = {key: column for column, key in enumerate(keys) if key}
        return _Columns(at, length_called(unit) or unit, i)
    return _Columns({key: at for at, key in enumerate(NEEDED)}, said=False)
