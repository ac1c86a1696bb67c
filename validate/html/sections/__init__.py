"""The sections of a report: a file each, with one `SECTION`; a new section is a new file."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from validate.html.section import Section


@cache
def sections() -> tuple[Section, ...]:
    """All of them, from the top of the page to its end."""
    found = [import_module(f"{__name__}.{module.name}").SECTION for module in iter_modules(__path__)]
    return tuple(sorted(found, key=lambda section: (section.place, section.name)))
