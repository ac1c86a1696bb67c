"""The folder of a report: the page, and its data as JSON and CSV."""

from __future__ import annotations

import os
from pathlib import Path

from validate.errors import UsageError
from validate.html.data import OF_COST, WORDS, data_files
from validate.html.page import GENERATOR, page
from validate.html.run import Run
from validate.output.files import OutputError, require_writable, unwritable, write_content

PAGE = "index.html"
# The mark of our pages is near their beginning.
BEGINNING = 4096


def require_folder(folder: str) -> None:
    """Refuse a folder that cannot take a report, before anything is solved; nothing is made.

    Raises:
        UsageError: it is a file, or holds a page that this program did not make.
        OutputError: it cannot be made or written.
    """
    place = Path(folder)
    if "\0" in folder:
        raise UsageError(f"{folder}: names no folder")
    if place.exists() and not place.is_dir():
        raise UsageError(f"{folder}: is a file; allowed: a folder, which is made if it is not there")
    there = next(one for one in (place, *place.absolute().parents) if one.exists())
    if not (there.is_dir() and os.access(there, os.W_OK)):
        raise OutputError(folder, f"cannot be written (there is no folder that takes it in {str(there)!r})")
    old = place / PAGE
    if old.is_file() and f'content="{GENERATOR}"'.encode() not in old.read_bytes()[:BEGINNING]:
        raise UsageError(f"{old}: is no report of this program; give another folder, or move it away")
    if place.is_dir():
        for name in (*WORDS, PAGE):
            require_writable(os.path.join(folder, name))


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
