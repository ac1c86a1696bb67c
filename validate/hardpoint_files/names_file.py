"""A file by the user with another file's names of our points, or with points that the other file lacks.

[names]
wheel_centre = "Hub centre"             # our name = the file's name
wheel_axis_inner = [0.0, 658.0, 210.0]  # or x, y and z in the file's axes and unit

[table]                                 # for a table with unknown titles
name = "Punkt"                          # the title of a column, or its number from 1
x = "Hoch"
y = "Quer"
z = "Laengs"
corner = 6                              # only if there is such a column
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.toml_text import parsed, read_file
from validate.hardpoint_files.contents import FilePoint, place_of, short
from validate.plain_text import shown
from validate.tables.errors import FileError
from validate.toml_written import value_of

COLUMNS = {"name", "x", "y", "z"}
FORM = '[names] with lines such as our_name = "its name", or our_name = [x, y, z]'


@dataclass(frozen=True)
class NamesFile:
    """The content of a file of names.

    Attributes:
        names: the other file's names by our names.
        points: points that are given in this file, by our names.
        table: titles or numbers of the columns name, x, y, z and corner.
    """

    names: Mapping[str, str]
    points: Mapping[str, FilePoint]
    table: Mapping[str, str | int]


NO_NAMES = NamesFile({}, {}, {})


def read_names(path: str) -> NamesFile:
    """Read a file of names.

    Raises:
        SceneError: the file cannot be read, or is not TOML.
        FileError: its content is wrong.
        UnknownName: a name of a point is unknown.
    """
    data = parsed(read_file(path, "a file of names, TOML"), path)
    table, given = data.get("table", {}), data.get("names", {})
    if data.keys() - {"table", "names"} or not isinstance(given, dict) or not isinstance(table, dict):
        raise FileError(path, 0, f"has {short(', '.join(data))}", FORM)
    known = COLUMNS <= table.keys() <= COLUMNS | {"corner"}
    if table and not (
        known and all(isinstance(n, str) or (type(n) is int and n > 0) for n in table.values())
    ):
        allowed = "name, x, y, z and corner, each a title or a number from 1"
        raise FileError(path, 0, f"[table] is {short(str(table))}", allowed)
    ours = tuple(dict.fromkeys(point for kind in shipped() for point in mechanism_file(kind).points))
    if wrong := next((name for name in given if name not in ours), None):
        raise UnknownName(f"point of pointcoord in {path}", wrong, ours)
    for name, value in given.items():
        if not isinstance(value, str | list):
            raise FileError(path, 0, f"{name} is {short(str(value))}", FORM)
    names = {name: value for name, value in given.items() if isinstance(value, str)}
    points = {
        n: FilePoint(f"given in {path}", place_of(v, path, 0, n)) for n, v in given.items() if n not in names
    }
    return NamesFile(names, points, table)


def names_to_fill_in(
    source: str, kind: str, needed: Iterable[str], ours: Mapping[str, FilePoint], others: Iterable[FilePoint]
) -> str:
    """The text of a file of names (TOML).

    Args:
        needed: our names of the points of a car of this kind.
        ours: recognised points of the file, by our names. others: points that are not recognised.
    """
    points = [f"#   {shown(point.source)}" for point in others]
    lines = [f"# Names in {shown(source)} of the points of a {kind}. Fill in, and remove the #."]
    lines += ["# Points of the file that are not recognised:", *points] if points else []
    lines += ["", "[names]"]
    for name in needed:
        if name in ours:
            lines.append(f"{name} = {value_of(shown(ours[name].name))}")
        else:
            lines.append(f'# {name} = "its name", or [x, y, z] in the axes and unit of the file')
    table = ('name = "Point"', 'x = "X"', 'y = "Y"', 'z = "Z"')
    lines += ["", "# [table]    # columns of a table: their titles, or their numbers from 1"]
    return "\n".join([*lines, *(f"# {line}" for line in table)]) + "\n"
