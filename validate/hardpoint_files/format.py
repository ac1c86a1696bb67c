"""The formats that are known, each a table in `formats/`: a program's names of points, its axes, its unit.

A new format of a form that is read already is a new table and nothing else.
"""

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
from validate.hardpoint_files.axes import Axes
from validate.hardpoint_files.contents import Contents, plain
from validate.tables.errors import FileError

FORMATS = Path(__file__).parent / "formats"
READERS = {"lotus_report": lotus_report.read, "chrono_json": chrono_json.read}
"""How a text becomes points, by the form that a format names; of a table it is said below."""
TABLE = "table"
MJCF = "mjcf"
"""The form of files that are whole mechanisms and no points."""

# Characters at the beginning of a file in which its format is looked for.
HEAD = 4000


class Format(BaseModel):
    """A format, as its table says it.

    Attributes:
        name: what the command line calls it. words: the same for people.
        known_by: a pattern by which the beginning of a file shows it; empty fits every file.
        axes: of a file, by a pattern of names that tell them; empty if every file has them.
        unit: of a file that does not say.
        angles: for our names, a pattern of its own words for a static angle.
        names: what it calls our points in every suspension that has them.
        suspensions: the same by our type of suspension. called: our type, by a pattern of its own words for
            it. notes: what the user should know of the points of each.
        titles: of a table, what its columns are called. wheels: side and axle, by what names begin or end
            with.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    words: str
    form: str
    known_by: str
    axes: dict[str, Annotated[Axes, BeforeValidator(Axes.of)]]
    unit: str
    suspensions: dict[str, dict[str, tuple[str, ...]]] = {}
    called: dict[str, str] = {}
    notes: dict[str, str] = {}
    names: dict[str, tuple[str, ...]] = {}
    angles: dict[str, str] = {}
    titles: dict[str, tuple[str, ...]] = {}
    wheels: dict[str, tuple[str, str]] = {}

    def names_of(self, kind: str) -> dict[str, tuple[str, ...]]:
        """What it calls each point of a suspension of ours; in a table our own names will do."""
        points = mechanism_file(kind).points
        shared = {ours: self.names[ours] for ours in points if ours in self.names}
        found = shared | self.suspensions.get(kind, {})
        return {ours: (*found.get(ours, ()), ours) for ours in points} if self.form == TABLE else found

    def ours(self, name: str, known: Mapping[str, str]) -> tuple[str, tuple[str, str]] | None:
        """Our name of a point and its wheel, side and axle; None if it is none of ours.

        Args:
            known: our names, by plain ones of the file.
        """
        whole = plain(name)
        if whole in known:
            return known[whole], ("", "")
        for words, wheel in self.wheels.items():
            for base in (whole.removesuffix(f" {words}"), whole.removeprefix(f"{words} ")):
                if base != whole and base in known:
                    return known[base], wheel
        return None

    def kind_called(self, said: str) -> str | None:
        """Our type of the suspension that a file calls so; None if it is none of ours."""
        found = (k for pattern, k in self.called.items() if re.fullmatch(pattern, said, re.IGNORECASE))
        return next(found, None)

    def read(self, text: str, source: str, said: Mapping[str, str | int]) -> Contents:
        """What a file of this format holds.

        Args:
            said: which columns the user means, of a table.
        Raises:
            FileError: it is not written as it must be.
        """
        if self.form == TABLE:
            return table.read(text, source, self.titles, said, self.wheels)
        if said:
            raise FileError(source, 0, f"is a {self.words}", "[table] in a file of names for tables")
        return READERS[self.form](text, source)


@lru_cache
def formats() -> Mapping[str, Format]:
    """Every format by name; the one that fits every file comes last."""
    found = [
        Format.model_validate({"name": path.stem} | tomllib.loads(path.read_text("utf-8")))
        for path in FORMATS.glob("*.toml")
    ]
    return {one.name: one for one in sorted(found, key=lambda one: (not one.known_by, one.name))}


def format_of(text: str, name: str | None) -> Format:
    """The format that is named, or the first that the beginning of a text shows.

    Raises:
        UnknownName: there is none of that name.
    """
    known = formats()
    if name is not None and name not in known:
        raise UnknownName("format", name, known)
    return known[name] if name else next(f for f in known.values() if re.search(f.known_by, text[:HEAD]))
