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
from validate.hardpoint_files.contents import Point, place_of, short
from validate.plain_text import shown
from validate.tables.errors import FileError
from validate.toml_written import value_of

COLUMNS = {"name", "x", "y", "z"}
FORM = (
    '[names] with our_name = "its name" or our_name = [x, y, z]; '
    "[table] with name, x, y, z and, if there is one, corner, each a title or a number from 1"
)
EMPTY_TABLE = """
# [table]    # columns of a table: their titles, or their numbers from 1
# name = "Point"
# x = "X"
# y = "Y"
# z = "Z"
"""


@dataclass(frozen=True)
class NamesFile:
    """The content of a file of names.

    Attributes:
        names: the other file's names by our names.
        points: points that are given in this file, by our names.
        table: titles or numbers of the columns name, x, y, z and corner; empty if the file does not say.
    """

    names: Mapping[str, str]
    points: Mapping[str, Point]
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
    given, table = data.get("names", {}), data.get("table", {})
    if data.keys() - {"names", "table"} or not (isinstance(given, dict) and _are_columns(table)):
        raise FileError(path, 0, f"has {short(str(data))}", FORM)
    known = tuple(dict.fromkeys(point for kind in shipped() for point in mechanism_file(kind).points))
    if wrong := next((ours for ours in given if ours not in known), None):
        raise UnknownName(f"point of pointcoord in {path}", wrong, known)
    names = {ours: value for ours, value in given.items() if isinstance(value, str)}
    places = {ours: place_of(value, path, 0, ours) for ours, value in given.items() if ours not in names}
    points = {ours: Point(ours, place, f"given in {path}") for ours, place in places.items()}
    return NamesFile(names, points, table)


def _are_columns(table: object) -> bool:
    """Whether a value of TOML gives all columns of a table, or none."""
    if not isinstance(table, dict) or not table:
        return table == {}
    numbers = [at for at in table.values() if not isinstance(at, str)]
    known = COLUMNS <= table.keys() <= COLUMNS | {"corner"}
    return known and all(type(at) is int and at > 0 for at in numbers)


def names_to_fill_in(
    source: str, kind: str, needed: Iterable[str], ours: Mapping[str, Point], others: Iterable[Point]
) -> str:
    """The text of a file of names (TOML).

    Args:
        needed: our names of the points of a car of this kind.
        ours: recognised points of the file, by our names. others: points that are not recognised.
    """
    unknown = '"its name", or [x, y, z] in the axes and unit of the file'
    lines = [
        f"# Names in {shown(source)} of the points of a {kind}. Fill in, and remove the #.",
        "# Points of the file that are not recognised:",
        *([f"#   {shown(one.source)}" for one in others] or ["#   none"]),
        "",
        "[names]",
        *(f"{n} = {value_of(shown(ours[n].name))}" if n in ours else f"# {n} = {unknown}" for n in needed),
    ]
    return "\n".join(lines) + "\n" + EMPTY_TABLE
