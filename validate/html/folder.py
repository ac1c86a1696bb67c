"""The folder of a report: the page, and its data as JSON and CSV."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from validate.errors import UsageError
from validate.html.data import OF_COST, WORDS, data_files
from validate.html.page import GENERATOR, page
from validate.html.run import Run
from validate.output.files import require_writable, unwritable, write_content

PAGE = "index.html"
# The mark of our pages is near their beginning.
BEGINNING = 4096


def require_folder(folder: str) -> None:
    """Refuse a folder that cannot take a report, before anything is solved.

    One that is not there is made and taken away again: a run that is stopped leaves nothing.

    Raises:
        UsageError: it is a file, or holds a page that this program did not make.
        OutputError: it cannot be made or written.
    """
    place = Path(folder)
    made: list[Path] = []
    try:
        if place.exists() and not place.is_dir():
            raise UsageError(f"{folder}: is a file; allowed: a folder, which is made if it is not there")
        made = [one for one in (place, *place.parents) if not one.exists()]
        place.mkdir(parents=True, exist_ok=True)
        old = place / PAGE
        if old.is_file():
            with old.open("rb") as stream:
                ours = f'content="{GENERATOR}"'.encode() in stream.read(BEGINNING)
            if not ours:
                raise UsageError(f"{old}: is no report of this program; give another folder, or move it away")
    except OSError as error:
        raise unwritable(folder, error) from None
    except ValueError as error:
        # A path with a zero byte in it.
        raise UsageError(f"{folder}: names no folder ({error})") from None
    try:
        for name in (*WORDS, PAGE):
            require_writable(os.path.join(folder, name))
    finally:
        for one in made:
            # Somebody may have put something there meanwhile, or have taken it away.
            with suppress(OSError):
                one.rmdir()


def make_folder(folder: str) -> None:
    """Make the folder of a report, if it is not there.

    Raises:
        OutputError: it cannot be made.
    """
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None


def write_report(folder: str, run: Run) -> None:
    """Write the page and its data; the page is last, so that where it is, its data are.

    Raises:
        MissingPackage: a package of the extra is not there.
        OutputError: one cannot be written.
    """
    make_folder(folder)
    data = data_files(run)
    links = OF_COST if run.head.kind == "cost" else {name: WORDS[name] for name in data}
    for name, text in {**data, PAGE: page(run, links)}.items():
        write_content(os.path.join(folder, name), text)
