"""The formats that are known, each a table in `formats/`: a program's names of points, its axes, its unit.

A new format of a form that is read already is a new table and nothing else.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
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
TABLE = "table"
FORMS: Mapping[str, Callable[..., Contents]] = {
    "lotus_report": lotus_report.read,
    TABLE: table.read,
    "chrono_json": chrono_json.read,
}
"""How a text becomes points, by the form that a format names."""

# Characters at the beginning of a file in which its format is looked for.
HEAD = 4000


class Names(BaseModel):
    """A suspension in the words of a format.

    Attributes:
        called: what the format calls it, for people, with a pattern of each; empty if it does not say.
        names: what it calls each of our points, any of several names, beside those that the format has.
        notes: what the user should know of these points.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    called: dict[str, str] = {}
    names: dict[str, tuple[str, ...]] = {}
    notes: tuple[str, ...] = ()


class Format(BaseModel):
    """A format, as its table says it.

    Attributes:
        name: what the command line calls it. words: the same for people.
        known_by: a pattern by which the beginning of a file shows it; empty fits every file.
        axes, unit: of a file that does not say.
        side: the wheel whose points it gives, whatever their signs say; empty if it gives either.
        axes_told_by: a pattern of names that tell these axes; empty if every file of the format has them.
        refused: a pattern of files of the same program that are not read. refused_words: what they are.
        angles: for our names, a pattern of its own words for a static angle.
        not_needed: patterns of names that are known and hold nothing that moves the wheel.
        our_own_names: whether its points may have our own names, and words for a wheel before or after a
            name; where all have our own, its axes are ours as well.
        names: what it calls our points in every suspension that has them.
        suspensions: by our name of each.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    words: str
    form: str
    known_by: str
    axes: Annotated[Axes, BeforeValidator(Axes.of)]
    unit: str
    not_needed: tuple[str, ...]
    suspensions: dict[str, Names]
    names: dict[str, tuple[str, ...]] = {}
    side: str = ""
    axes_told_by: str = ""
    refused: str = ""
    refused_words: str = ""
    angles: dict[str, str] = {}
    our_own_names: bool = False

    def names_of(self, kind: str) -> dict[str, tuple[str, ...]]:
        """What it calls each point of a suspension of ours."""
        if kind not in self.suspensions:
            return {}
        shared = {ours: self.names[ours] for ours in mechanism_file(kind).points if ours in self.names}
        return shared | self.suspensions[kind].names

    def called(self, said: str) -> str | None:
        """Our type of the suspension that a file calls so; None if it is none of ours."""
        for kind, words in self.suspensions.items():
            if any(re.fullmatch(pattern, said, re.IGNORECASE) for pattern in words.called.values()):
                return kind
        return None

    @property
    def known_suspensions(self) -> str:
        """The suspensions that this format has, in its own words and ours."""
        return ", ".join(
            f"{' or '.join(words.called)} ({kind})" if words.called else kind
            for kind, words in self.suspensions.items()
        )

    def read(self, text: str, source: str, said: Mapping[str, str | int]) -> Contents:
        """What a file of this format holds.

        Args:
            said: which columns the user means, of a table.
        Raises:
            FileError: it is not written as it must be.
        """
        if said and self.form != TABLE:
            raise FileError(source, 0, f"is a {self.words}", "[table] in a file of names for tables")
        return FORMS[self.form](text, source, said) if said else FORMS[self.form](text, source)

    def holds_nothing(self, name: str) -> bool:
        """Whether a point of this name is known and not needed."""
        return any(re.fullmatch(pattern, plain(name)) for pattern in self.not_needed)


@lru_cache
def formats() -> Mapping[str, Format]:
    """Every format by name; the one that fits every file comes last."""
    found = [
        Format.model_validate({"name": path.stem} | tomllib.loads(path.read_text("utf-8")))
        for path in FORMATS.glob("*.toml")
    ]
    return {one.name: one for one in sorted(found, key=lambda one: (not one.known_by, one.name))}


def format_of(text: str, name: str | None, source: str) -> Format:
    """The format that is named, or the first that the beginning of a text shows.

    Raises:
        UnknownName: there is none of that name.
        FileError: it is a file of a known program that is not read.
    """
    known = formats()
    for one in known.values():
        if one.refused and re.search(one.refused, text):
            raise FileError(source, 0, f"is {one.refused_words}", f"a {one.words}")
    if name is None:
        return next(one for one in known.values() if re.search(one.known_by, text[:HEAD]))
    if name not in known:
        raise UnknownName("format", name, known)
    return known[name]
