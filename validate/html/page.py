"""Renders a run as one HTML page, by templates that escape all text, and writes the folder of the page."""

from __future__ import annotations

import os
from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

from validate.errors import NotFinished, UsageError
from validate.extras import needed
from validate.html.blocks import Plots, Spatial
from validate.html.data import WORDS, data_files
from validate.html.run import Run
from validate.html.sections import SECTIONS
from validate.output.files import require_writable, unwritable, write_content

TEMPLATES = Path(__file__).with_name("templates")
SCRIPTS = ("grid.js", "plots.js", "spatial.js")
# Marks a page of this program, so that no other page is overwritten.
GENERATOR = "pointcoord report"
# The mark is within these first bytes of a page.
BEGINNING = 4096
PAGE = "index.html"


def page(run: Run, files: Mapping[str, str]) -> str:
    """The page of a run.

    Args:
        files: what each data file of the page contains, by name.
    Raises:
        MissingLibrary: a package of the extra `report` is not installed.
    """
    jinja2 = needed("report", "jinja2")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )
    made = [(section, blocks) for section in SECTIONS if (blocks := tuple(section.blocks(run)))]
    scripts = [_own(name) for name in SCRIPTS]
    if any(isinstance(block, Plots | Spatial) for _, blocks in made for block in blocks):
        scripts.insert(0, needed("report", "plotly.offline").get_plotlyjs())
    text = environment.get_template("page.html").render(
        run=run,
        parts=made,
        hashes=[b64encode(sha256(script.encode()).digest()).decode() for script in scripts],
        generator=GENERATOR,
        style=_own("page.css"),
        scripts=scripts,
        files=files,
    )
    return str(text)


def _own(name: str) -> str:
    return (TEMPLATES / name).read_text(encoding="utf-8")


def require_folder(folder: str) -> None:
    """Refuse a folder that cannot be used for a report, before anything is solved; no folder is made.

    Raises:
        UsageError: the folder is a file, or contains a page that this program did not write.
        NotFinished: the folder cannot be made or written.
    """
    place = Path(folder)
    if "\0" in folder:
        raise UsageError(f"{folder}: names no folder")
    if place.exists() and not place.is_dir():
        raise UsageError(f"{folder}: is a file; allowed: a folder, which is made if it does not exist")
    there = next(one for one in (place, *place.absolute().parents) if one.exists())
    if not (there.is_dir() and os.access(there, os.W_OK)):
        raise NotFinished(folder, f"cannot be written (no folder can be made in {str(there)!r})")
    old = place / PAGE
    if old.is_file() and f'content="{GENERATOR}"'.encode() not in old.read_bytes()[:BEGINNING]:
        raise UsageError(f"{old}: is not a report of this program; give another folder, or move the page")
    if place.is_dir():
        for name in (*WORDS, PAGE):
            require_writable(os.path.join(folder, name))


def make_folder(folder: str) -> None:
    """Make the folder of a report, if it does not exist.

    Raises:
        NotFinished: the folder cannot be made.
    """
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None


def write_report(folder: str, run: Run) -> None:
    """Write the data files and then the page; the page is last, so that a page never lacks its data.

    Raises:
        MissingLibrary: a package of the extra `report` is not installed.
        NotFinished: a file cannot be written.
    """
    make_folder(folder)
    data = data_files(run)
    for name, text in {**data, PAGE: page(run, {name: WORDS[name] for name in data})}.items():
        write_content(os.path.join(folder, name), text)
