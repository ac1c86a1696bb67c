"""The sections of the page, from top to bottom."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from validate.html.blocks import Block
from validate.html.run import Run
from validate.html.sections.compared import agreement, differences, machine, verdict
from validate.html.sections.cost import cost
from validate.html.sections.file import files
from validate.html.sections.hard import hard
from validate.html.sections.motion import motions
from validate.html.sections.printed import paper, published


@dataclass(frozen=True)
class Section:
    """A part of the page with a heading.

    Attributes:
        name: anchor on the page. title: heading.
        blocks: makes the blocks from a run; a section without blocks is left out of the page.
        folded: whether the section is shown only after a click.
    """

    name: str
    title: str
    blocks: Callable[[Run], Iterable[Block]]
    folded: bool = False


SECTIONS = (
    Section("verdict", "Verdict", verdict),
    Section("file", "The file compared with the car", files),
    Section("agreement", "Agreement", agreement),
    Section("motion", "The suspension in motion", motions),
    Section("cost", "Accuracy against time", cost),
    Section("differences", "Differences over time", differences, folded=True),
    Section("paper", "The paper", paper, folded=True),
    Section("hard", "Hard cases", hard, folded=True),
    Section("published", "Other programs' tables", published, folded=True),
    Section("machine", "Machine, versions, settings", machine, folded=True),
)
