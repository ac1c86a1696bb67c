"""The formats that are known, each a table in `formats/`: a program's names of points, its axes, its unit.

A new format of a form that is read already is a new table and nothing else.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict

from pointcoord.errors import UnknownName
from pointcoord.mechanism import mechanism_file
from validate.hardpoint_files import chrono_json, columns, lotus_report
from validate.hardpoint_files.axes import Axes
from validate.hardpoint_files.contents import Contents, plain, words_of
from validate.tables.errors import FileError

FORMATS = Path(__file__).parent / "formats"
FORMS: Mapping[str, Callable[..., Contents]] = {
    "lotus_report": lotus_report.read,
    "columns": columns.read,
    "chrono_json": chrono_json.read,
}
"""How a text becomes points, by the form that a format names."""

MJCF = "mjcf"
"""The form of files that are whole mechanisms and no points."""

# Characters at the beginning of a file in which its format is looked for.
HEAD = 4000


class Format(BaseModel):
    """A format, as its table says it.

    Attributes:
        name: what the command line calls it. words: the same for people.
        known_by: a pattern by which the beginning of a file shows it; empty fits every file.
        axes: of a file that does not say, by a pattern of names that tell them; empty if every file has them.
        unit: of a file that does not say.
        side: the wheel whose points it gives, whatever their signs say; empty if it gives either.
        vocabulary: by words of its names, others for these; words that say nothing are others for the empty
            text. None at all if names are as they are listed.
        angles: for our names, a pattern of its own words for a static angle.
        our_own_names: whether its points may have our own names, and words for a wheel before or after a
            name; where all have our own, its axes are ours as well.
        names: what it calls our points in every suspension that has them.
        suspensions: the same by our type of suspension. called: our type, by a pattern of its own words for
            it. notes: what the user should know of the points of each.
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
    side: str = ""
    vocabulary: dict[str, tuple[str, ...]] = {}
    angles: dict[str, str] = {}
    our_own_names: bool = False

    def names_of(self, kind: str) -> dict[str, tuple[str, ...]]:
        """What it calls each point of a suspension of ours."""
        if kind not in self.suspensions:
            return {}
        shared = {ours: self.names[ours] for ours in mechanism_file(kind).points if ours in self.names}
        return shared | self.suspensions[kind]

    @cached_property
    def _phrases(self) -> dict[tuple[str, ...], tuple[str, ...]]:
        """Words of the vocabulary for others, each a few."""
        return {
            tuple(plain(theirs).split()): tuple(ours.split())
            for ours, others in self.vocabulary.items()
            for theirs in others
        }

    def in_our_words(self, name: str) -> tuple[str, ...]:
        """A name in few words: `LCA_IN_FRONT` and `Lower wishbone, front pivot` are one point.

        They are in the order of the alphabet; numbers count where there is nothing else. Two names are one if
        these are the same: a word too many, such as that of a damper, is another point, and so is one said
        twice, as in `Rear upper rear pivot`.
        """
        left, found = words_of(name), list[str]()
        longest = max(map(len, self._phrases), default=1)
        while left:
            phrases = (tuple(left[:size]) for size in range(longest, 0, -1))
            known = next((phrase for phrase in phrases if phrase in self._phrases), None)
            found += left[:1] if known is None else self._phrases[known]
            left = left[1 if known is None else len(known) :]
        return tuple(sorted([word for word in found if not word.isdigit()] or found))

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
        if said and self.form != "columns":
            raise FileError(source, 0, f"is a {self.words}", "[table] in a file of names for tables")
        return FORMS[self.form](text, source, *([said] if said else []))


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
