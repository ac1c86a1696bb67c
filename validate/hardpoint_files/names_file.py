"""A file of one's own that says what another file calls our points, or gives points that it does not have.

[names]
wheel_centre = "Hub centre"             # our name = the file's name
wheel_axis_inner = [0.0, 658.0, 210.0]  # or x, y and z in the file's own axes and unit

[table]                                 # of a table whose titles are not understood
name = "Punkt"                          # the title of a column, or its number from 1
x = "Hoch"
y = "Quer"
z = "Laengs"
corner = 6                              # only if there is one
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal, DecimalException
from typing import Any

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.toml_text import read_file
from validate.hardpoint_files.contents import FilePoint, finite, short
from validate.plain_text import shown
from validate.tables.errors import FileError
from validate.toml_written import value_of

COLUMNS = ("name", "x", "y", "z")
FORM = '[names] with lines such as our_name = "its name", or our_name = [x, y, z]'


@dataclass(frozen=True)
class NamesFile:
    """What a file of names says.

    Attributes:
        names: the other file's name of our points. points: those that are given here.
        table: titles or numbers of the columns name, x, y, z and corner.
    """

    names: Mapping[str, str]
    points: Mapping[str, FilePoint]
    table: Mapping[str, str | int]


NO_NAMES = NamesFile({}, {}, {})


def read_names(path: str) -> NamesFile:
    """Read a file of names.

    Raises:
        SceneError: it cannot be read.
        FileError: it is not written as it must be.
        UnknownName: a point is none of ours.
    """
    try:
        data = tomllib.loads(
            read_file(path, "a file of names, TOML").decode("utf-8-sig"), parse_float=Decimal
        )
    except (ValueError, RecursionError, DecimalException) as error:
        found = re.search(r"at line (\d+)", str(error))
        raise FileError(path, int(found[1]) if found else 0, f"is not TOML: {error}", FORM) from None
    columns, table = data.pop("table", {}), data.pop("names", None)
    if data or not isinstance(table, dict | None) or (table is None and not columns):
        told = f"has the key {short(next(iter(data)))}" if data else "has no table [names]"
        raise FileError(path, 0, told, FORM)
    if columns and (
        not isinstance(columns, dict)
        or not {*COLUMNS} <= columns.keys() <= {*COLUMNS, "corner"}
        or not all(isinstance(one, str) or (type(one) is int and one > 0) for one in columns.values())
    ):
        told = f"[table] is {short(str(columns))}"
        raise FileError(path, 0, told, "name, x, y, z and corner, each a title or a number from 1")
    ours = tuple(dict.fromkeys(point for kind in shipped() for point in mechanism_file(kind).points))
    names: dict[str, str] = {}
    points: dict[str, FilePoint] = {}
    for name, value in (table or {}).items():
        if name not in ours:
            raise UnknownName(f"point of ours in {path}", name, ours)
        if isinstance(value, str):
            names[name] = value
        else:
            points[name] = FilePoint(f"given in {path}", _place(value, path, name), 0)
    return NamesFile(names, points, columns)


def _place(value: Any, path: str, name: str) -> tuple[Decimal, Decimal, Decimal]:
    numbers = value if isinstance(value, list) else []
    if len(numbers) != 3 or any(isinstance(n, bool) or not isinstance(n, int | Decimal) for n in numbers):
        raise FileError(path, 0, f"{name} is {short(str(value))}", FORM)
    x, y, z = (
        finite(Decimal(n), path, 0, f"{axis} of {name}") for axis, n in zip("xyz", numbers, strict=True)
    )
    return x, y, z


def names_to_fill_in(
    source: str, kind: str, needed: Iterable[str], ours: Mapping[str, FilePoint], others: Iterable[FilePoint]
) -> str:
    """The text of a file of names (TOML).

    Args:
        needed: our names of the points that a car of this kind has.
        ours: the points of the file that are known. others: those that are not.
    """
    points = [f"#   {shown(p.name)}, line {p.line}" for p in others]
    lines = [f"# Which points of {shown(source)} are which of a {kind}. Fill in, and take the # away."]
    lines += ["# Points of the file that are not known:", *points] if points else []
    lines += ["", "[names]"]
    for name in needed:
        if name in ours:
            lines.append(f"{name} = {value_of(shown(ours[name].name))}")
        else:
            lines.append(f'# {name} = "its name", or [x, y, z] in the axes and unit of the file')
    table = ('name = "Point"', 'x = "X"', 'y = "Y"', 'z = "Z"')
    lines += ["", "# [table]    # columns of a table: their titles, or their numbers from 1"]
    return "\n".join([*lines, *(f"# {line}" for line in table)]) + "\n"
