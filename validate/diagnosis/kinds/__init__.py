"""The kinds of faults that are looked for: a file each, with one `KIND`; a new kind is a new file."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from validate.diagnosis.hypothesis import Kind


@cache
def kinds() -> tuple[Kind, ...]:
    """All of them, in the order of their files' names."""
    names = sorted(found.name for found in iter_modules(__path__))
    return tuple(import_module(f"{__name__}.{name}").KIND for name in names)
