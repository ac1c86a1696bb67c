"""A run as one page of HTML: its sections through templates in which all text is escaped."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from validate.extras import MissingPackage
from validate.html.run import Run
from validate.html.sections import sections

TEMPLATES = Path(__file__).with_name("templates")
# What marks a page as ours, so that no other page is written over.
GENERATOR = "pointcoord report"
EXTRA = "report"
# Nothing is loaded from anywhere; styles are in the page itself.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


def require_templates() -> None:
    """Find out that no page can be made before anything is solved.

    Raises:
        MissingPackage: a package of the extra is not there.
    """
    _package("jinja2")


def _package(name: str) -> Any:
    # By its name: the extra is optional, and so are its types.
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingPackage("report", error, EXTRA) from None


def page(run: Run, files: Mapping[str, str]) -> str:
    """The page of a run.

    Args:
        files: names of the files beside it, by their kind.
    Raises:
        MissingPackage: jinja2 is not there.
    """
    jinja2 = _package("jinja2")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )
    # Our own text, in which no user has a say: the only one that goes into the page as it is.
    style = jinja2.utils.markupsafe.Markup((TEMPLATES / "page.css").read_text(encoding="utf-8"))
    made = [(section, section.blocks(run)) for section in sections()]
    text = environment.get_template("page.html").render(
        run=run,
        parts=[(section, blocks) for section, blocks in made if blocks],
        policy=POLICY,
        generator=GENERATOR,
        style=style,
        files=files,
    )
    return str(text)
