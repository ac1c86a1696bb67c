"""Reads a table of points: a name and three numbers on each line, as spreadsheets and programs write it.

A line of known titles gives the columns of x, y and z, their unit, and the column of the wheel. Without
titles, a line is a name and three numbers. Unknown titles are refused; [table] in the file of names can give
the columns. A line of words only is the heading of the points that follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from validate.hardpoint_files.contents import Contents, Point, place_of, plain, short
from validate.measured.reading import name_and_unit
from validate.tables.cells import is_number, joined, lines_of
from validate.tables.errors import FileError
from validate.tables.units import length_called

Rows = Sequence[tuple[int, Sequence[str]]]
"""Lines of a table: their numbers and their cells."""
Columns = Mapping[str, int]
"""Indices of the columns name, x, y, z, and corner if there is one."""

NEEDED = ("name", "x", "y", "z")
UNTITLED: Columns = {key: column for column, key in enumerate(NEEDED)}
SAY = 'or [table] in a file of names (--names) with name, x, y, z = "title" or number of column'
ROW = f"a name and three numbers, separated by commas, semicolons or tabs; {SAY}"


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
    head, columns, unit = _said(rows, said, source) if said else _titled(rows, known, source)
    # Without titles no number may follow the three; numbers of columns from the user say which they are.
    width = len(rows[head][1]) if head >= 0 else len(NEEDED) if not said else None
    points, others, section, over = list[Point](), list[str](), "", ""
    # Of the lines above the titles only headings are read.
    above = [(line, row) for line, row in rows[: max(head, 0)] if len([*filter(None, row)]) == 1]
    for line, row in (*above, *rows[head + 1 :]):
        filled = [cell for cell in row if cell]
        name, *cells = (row[at] if at < len(row) else "" for at in map(columns.__getitem__, NEEDED))
        if filled and all(map(is_number, filled)):
            raise FileError(source, line, "has coordinates without a name", ROW)
        if len(filled) == 1:
            # An axle, or the first words of the names below.
            section, over = ("", plain(filled[0])) if plain(filled[0]) in wheels else (filled[0], over)
        elif not all(map(is_number, cells)):
            others += [f"{name}, line {line}"] if name and any(cells) else []
        elif width is not None and any(map(is_number, row[width:])):
            problem = f"has a number for {short(name)} in a column without a title"
            raise FileError(source, line, problem, f"one title for each, no comma inside a number; {SAY}")
        else:
            corner = columns.get("corner", len(row))
            side, part = wheels.get(plain(row[corner]) if corner < len(row) else over, ("", ""))
            place = place_of(cells, source, line, name)
            points.append(Point(name, place, f"{name}, line {line}", side, part, section))
    if not points:
        raise FileError(source, 0, "has no points", ROW)
    return Contents(points, others, unit)


def _named(words: Sequence[str], titles: Mapping[str, str]) -> Sequence[str]:
    """The cells of a line separated by blanks: a name, then the numbers or their titles at the end."""
    count = next((n for n, word in enumerate(reversed(words)) if not is_number(word)), len(words))
    if not count:
        words = joined(words)
        places = [titles.get(plain(name_and_unit(word)[0]), "") in ("x", "y", "z") for word in words]
        count = len(words) - places.index(True) if any(places) else 0
    return [" ".join(words[: len(words) - count]), *words[len(words) - count :]]


def _said(rows: Rows, said: Mapping[str, str | int], source: str) -> tuple[int, Columns, str]:
    """The row of titles that the user names, -1 for numbers of columns only; the columns; no unit."""
    titles = {plain(one) for one in said.values() if isinstance(one, str)}
    head = next((i for i, (_, row) in enumerate(rows) if titles and titles <= {*map(plain, row)}), -1)
    if titles and head < 0:
        problem = f"has no line with the titles {', '.join(map(str, said.values()))}"
        raise FileError(source, 0, problem, "titles as in the file, or numbers of columns from 1")
    heads = [*map(plain, rows[head][1])] if titles else []
    at = {key: heads.index(plain(one)) if isinstance(one, str) else one - 1 for key, one in said.items()}
    return head, at, ""


def _titled(rows: Rows, known: Mapping[str, str], source: str) -> tuple[int, Columns, str]:
    """The row of titles, -1 if there is none; the columns; the unit in the titles, if they give one."""
    ahead = [*rows[1:], (0, [""])]
    for i, (line, row) in enumerate(rows):
        if any(map(is_number, row)):
            break
        heads = [name_and_unit(cell) for cell in row]
        keys = [known.get(plain(head), "") for head, _ in heads]
        # If cells are separated by blanks, a heading is one cell, and so is a line of unknown titles.
        over = is_number(ahead[i][1][-1]) and len(row) == 1 and len(row[0].split()) > 3
        if {"x", "y", "z"}.isdisjoint(keys) and sum(map(bool, row)) <= 3 and not over:
            continue
        if any(keys.count(key) != 1 for key in NEEDED):
            problem = f"has titles {short(', '.join(row))}, which are not name, x, y and z"
            raise FileError(source, line, problem, f"one of each of Point, X, Y, Z; {SAY}")
        units = {unit for key, (_, unit) in zip(keys, heads, strict=True) if key in ("x", "y", "z")}
        if len(units) > 1:
            raise FileError(source, line, f"has units {sorted(units)}", "one unit in all columns")
        (unit,) = units
        return i, {key: column for column, key in enumerate(keys) if key}, length_called(unit) or unit
    return -1, UNTITLED, ""
