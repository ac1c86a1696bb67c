"""A run as one page of HTML: its sections through templates in which all text is escaped."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

from validate.extras import needed
from validate.html.run import Run
from validate.html.section import PLOTLY
from validate.html.sections import sections

TEMPLATES = Path(__file__).with_name("templates")
# What marks a page as ours, so that no other page is written over.
GENERATOR = "pointcoord report"
# Nothing is loaded from anywhere: styles are in the page itself, pictures are what plotly makes of its own
# plots, and the only scripts that run are those with these hashes.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; "
    "form-action 'none'; script-src {}"
)


def page(run: Run, files: Mapping[str, str]) -> str:
    """The page of a run.

    Args:
        files: beside it, by name, and what each holds.
    Raises:
        MissingPackage: a package of the extra is not there.
    """
    jinja2 = needed("report", "jinja2", "report")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )
    # Our own text and plotly's, in which no user has a say: all that goes into the page as it is.
    as_it_is = jinja2.utils.markupsafe.Markup
    made = [(section, blocks) for section in sections() if (blocks := section.blocks(run))]
    names = dict.fromkeys(name for _, blocks in made for block in blocks for name in block.scripts)
    scripts = [_script(name) for name in names]
    hashes = (b64encode(sha256(script.encode()).digest()).decode() for script in scripts)
    text = environment.get_template("page.html").render(
        run=run,
        parts=made,
        policy=POLICY.format(" ".join(f"'sha256-{one}'" for one in hashes) or "'none'"),
        generator=GENERATOR,
        style=as_it_is(_own("page.css")),
        scripts=[as_it_is(script) for script in scripts],
        files=files,
    )
    return str(text)


def _script(name: str) -> str:
    return str(needed("report", "plotly.offline", "report").get_plotlyjs()) if name == PLOTLY else _own(name)


def _own(name: str) -> str:
    return (TEMPLATES / name).read_text(encoding="utf-8")
