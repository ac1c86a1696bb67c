"""`--report DIR`: the page of a run, in a folder with its data."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from validate.errors import UsageError
from validate.extras import needed
from validate.output.console import Console
from validate.plain_text import shown

# What a page is made of is imported where one is made: most runs make none.
if TYPE_CHECKING:
    from validate.html.run import Drawings, Run


def add_report(parser: argparse.ArgumentParser) -> None:
    """The option of a command whose results make a page."""
    parser.add_argument(
        "--report",
        metavar="DIR",
        help="write a page of HTML that needs no network, with its data, into a folder",
    )


# What pages hold, and the command that makes one with it; those of a kind of run hold that.
OF_A_KIND = {
    "validate": ("scenes in motion, compared by two formulations", "pointcoord report DIR SCENE"),
    "hard": ("hard cases", "pointcoord hard --report DIR"),
    "cost": ("accuracy against time", "pointcoord cost --report DIR"),
}
OF_THE_PAPER = ("the paper's figures, tables and errata", "pointcoord report DIR")
OF_OTHERS = ("other programs' tables", "pointcoord report DIR")


def _nothing_more(run: Run) -> Run:
    """The run as it is, which names what else pages hold."""
    # Of a file's scene no motion is solved and no other model.
    kind = "" if run.record.files else run.head.kind
    rows = [row for name, row in OF_A_KIND.items() if name != kind]
    rows += [
        row for row, there in ((OF_THE_PAPER, run.record.paper), (OF_OTHERS, run.published)) if not there
    ]
    return replace(run, left_out=tuple(rows))


@dataclass(frozen=True)
class Page:
    """Where a page goes, and what it holds beside the run that it is of.

    Attributes:
        with_more: adds to a run what else is computed for its page.
        option: that names the folder, with a space behind it.
    """

    folder: str
    with_more: Callable[[Run], Run] = _nothing_more
    option: str = "--report "

    @property
    def place(self) -> str:
        """The page itself, for people."""
        from validate.html.folder import PAGE

        return shown(os.path.join(self.folder, PAGE))

    def drawings(self, count: int) -> Drawings:
        """What keeps those of so many scenes that the page draws."""
        from validate.html.run import Drawings

        return Drawings(count)

    def require(self) -> None:
        """Find out that there can be no page, before anything is solved.

        Raises:
            MissingPackage: a page needs the extra `report`.
            UsageError: the folder has no name, or cannot be a report's.
            OutputError: it cannot be written.
        """
        from validate.html.folder import require_folder

        if not self.folder.strip():
            raise UsageError(
                f"{self.option}{self.folder!r} names no folder; give the path of one, which is made if needed"
            )
        for package in ("jinja2", "plotly.offline"):
            needed("report", package, "report")
        require_folder(self.folder)

    def write(self, run: Run, console: Console) -> Run:
        """Write the page of a run.

        Returns:
            The run with what the page holds beside it.
        Raises:
            OutputError: it cannot be written.
        """
        from validate.html.folder import write_report

        whole = self.with_more(run)
        write_report(self.folder, whole)
        console.written.append(f"{self.place} holds the report")
        return whole


def page_of(options: argparse.Namespace) -> Page | None:
    """The page that `--report` asks for."""
    return None if options.report is None else Page(options.report)
