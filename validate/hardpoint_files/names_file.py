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
from decimal import Decimal, DecimalException
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file, shipped
from pointcoord.mechanism.faults import fault_of
from pointcoord.toml_text import read_file
from validate.hardpoint_files.contents import FilePoint, Place, place_of
from validate.plain_text import shown
from validate.tables.errors import FileError
from validate.toml_written import value_of

FORM = '[names] with lines such as our_name = "its name", or our_name = [x, y, z]; [table] with name, x, y, z'
Column = Annotated[int, Field(strict=True, ge=1)] | str
Number = Annotated[int, Field(strict=True)] | Decimal


class TableSaid(BaseModel):
    """Titles or numbers of a table's columns."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Column
    x: Column
    y: Column
    z: Column
    corner: Column | None = None


class NamesFile(BaseModel):
    """What a file of names says: of our points the other file's name or a place, and its columns."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    names: dict[str, str | tuple[Number, Number, Number]] = {}
    table: TableSaid | None = None

    @property
    def theirs(self) -> dict[str, str]:
        """The other file's name of our points."""
        return {ours: said for ours, said in self.names.items() if isinstance(said, str)}

    def points(self, path: str) -> dict[str, FilePoint]:
        """The points that are given here."""
        given = {ours: said for ours, said in self.names.items() if not isinstance(said, str)}
        return {
            ours: FilePoint(f"given in {path}", _place(path, ours, said), 0) for ours, said in given.items()
        }

    @property
    def columns(self) -> dict[str, str | int]:
        """Titles or numbers of the columns name, x, y, z and corner, if any are said."""
        return {} if self.table is None else self.table.model_dump(exclude_none=True)


def _place(path: str, ours: str, said: tuple[int | Decimal, ...]) -> Place:
    return place_of([Decimal(number) for number in said], path, 0, ours)


def read_names(path: str) -> NamesFile:
    """Read a file of names.

    Raises:
        SceneError: it cannot be read.
        FileError: it is not written as it must be.
        UnknownName: a point is none of ours.
    """
    text = read_file(path, "a file of names, TOML")
    try:
        found = NamesFile.model_validate(tomllib.loads(text.decode("utf-8-sig"), parse_float=Decimal))
    except ValidationError as error:
        fault = fault_of(error)
        raise FileError(path, ".".join(map(str, fault.place)), fault.problem, FORM) from None
    except (ValueError, RecursionError, DecimalException) as error:
        line = re.search(r"at line (\d+)", str(error))
        raise FileError(path, int(line[1]) if line else 0, f"is not TOML: {error}", FORM) from None
    ours = tuple(dict.fromkeys(point for kind in shipped() for point in mechanism_file(kind).points))
    for name in found.names:
        if name not in ours:
            raise UnknownName(f"point of ours in {path}", name, ours)
    return found


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
