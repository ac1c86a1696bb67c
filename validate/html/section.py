"""A section of a report as data: what it is called, where it stands, and what it is made of.

A section is a file in `sections/` with one `SECTION`; a new one is a new file, and nothing else knows it. It
makes blocks of a run; a block is plain data and knows the template that draws it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar, Protocol

from validate.html.run import FIRST, FURTHER, Run

# The script that the package plotly brings.
PLOTLY = "plotly"


class Block(Protocol):
    """A piece of a page.

    Attributes:
        template: file in `templates/` that draws it, as `block`.
        scripts: what it needs to run, in this order: files in `templates/`, or PLOTLY.
    """

    template: ClassVar[str]
    scripts: ClassVar[tuple[str, ...]]


@dataclass(frozen=True)
class Paragraph:
    """Text, and what kind of verdict it tells, if any, with small print below it."""

    template: ClassVar[str] = "paragraph.html"
    scripts: ClassVar[tuple[str, ...]] = ()
    text: str
    verdict: str = ""
    detail: str = ""


@dataclass(frozen=True)
class Section:
    """A part of the page with a heading.

    Attributes:
        name: anchor on the page. title: heading.
        place: sections stand in the order of these numbers.
        folded: whether it is seen only by who opens it.
        blocks: what it is made of; a section that has nothing to show of a run makes none and is left out.
    """

    name: str
    title: str
    place: int
    blocks: Callable[[Run], Iterable[Block]]
    folded: bool = False


def which(run: Run) -> list[Block]:
    """Which scenes are drawn, where these are not all."""
    drawn, compared = len(run.drawn), sum(bool(one.outcomes) for one in run.record.examined)
    if drawn == compared or run.record.files:
        # Of a file's scene no motion is solved, which the page says in a place of its own.
        return []
    return [
        Paragraph(
            f"Drawn are {drawn} of {compared} scenes: the first {FIRST}, and the first {FURTHER} further "
            "ones that do not agree. The tables and the data beside this page have all."
        )
    ]
