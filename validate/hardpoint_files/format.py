"""The known formats, each a table in `formats/`: names of points, axes and unit of a program."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file
from validate.hardpoint_files import chrono_json, lotus_report, table
from validate.hardpoint_files.contents import Axes, Contents
from validate.tables.errors import FileError

FORMATS = Path(__file__).parent / "formats"
READERS = {"lotus": lotus_report.read, "chrono": chrono_json.read}
"""The function that reads each format, except tables; see `Format.read`."""
TABLE = "csv"
MJCF = "mjcf"
"""The format of files that contain a whole mechanism, not hardpoints."""

# Number of characters at the beginning of a file in which its format is looked for.
HEAD = 4000


class Format(BaseModel):
    """A format, from its table.

    Attributes:
        name: on the command line. words: its name in messages.
        known_by: a pattern that the beginning of a file contains; the empty pattern fits every file.
        axes: axes by a pattern of point names that use them; the empty pattern fits every file.
        unit: unit of a file that does not give one.
        suspensions: our types of suspension that a file may contain without saying which.
        called: our type of suspension by a pattern of its name in the file.
        names: names in the file of each of our points, for all suspensions.
        notes: remarks for the user on the points of each type; under the empty name on those of all types.
        angles: for each of our angles, a pattern of its name in the file.
        titles: for a table, the possible titles of each column.
        wheels: side and axle by the beginning or end of a name.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    words: str
    known_by: str
    axes: dict[str, Annotated[Axes, BeforeValidator(Axes.of)]]
    unit: str
    suspensions: tuple[str, ...] = ()
    called: dict[str, str] = {}
    names: dict[str, tuple[str, ...]] = {}
    notes: dict[str, tuple[str, ...]] = {}
    angles: dict[str, str] = {}
    titles: dict[str, tuple[str, ...]] = {}
    wheels: dict[str, tuple[str, str]] = {}

    def names_of(self, kind: str) -> dict[str, tuple[str, ...]]:
        """Names in the file of each point of a suspension; our own names are among them."""
        return {ours: (*self.names.get(ours, ()), ours) for ours in mechanism_file(kind).points}

    def read(self, text: str, source: str, said: Mapping[str, str | int]) -> Contents:
        """Read a file of this format.

        Args:
            said: for a table, the columns that the user names.
        Raises:
            FileError: the file does not have this format.
        """
        if self.name == TABLE:
            return table.read(text, source, self.titles, said, self.wheels)
        if said:
            raise FileError(source, 0, f"is a {self.words}", "[table] in a file of names for tables")
        return READERS[self.name](text, source)


@lru_cache
def formats() -> Mapping[str, Format]:
    """All formats by name; the format that fits every file is last."""
    tables = {path.stem: tomllib.loads(path.read_text("utf-8")) for path in FORMATS.glob("*.toml")}
    found = [Format.model_validate({"name": name, **content}) for name, content in tables.items()]
    return {one.name: one for one in sorted(found, key=lambda one: (not one.known_by, one.name))}


def format_of(text: str, name: str | None) -> Format:
    """The named format, or the first format that fits the beginning of a text.

    Raises:
        UnknownName: there is no format of this name.
    """
    known = formats()
    if name is not None and name not in known:
        raise UnknownName("format", name, known)
    return known[name] if name else next(f for f in known.values() if re.search(f.known_by, text[:HEAD]))
