"""All hard cases, the cases of a group together."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches

from validate.errors import UsageError
from validate.hard.case import Case
from validate.hard.cases import branches, drawings, ends, links, motions, numbers
from validate.plain_text import gathered

MODULES = (ends, motions, drawings, branches, links, numbers)
CASES: tuple[Case, ...] = tuple(
    case
    for group in gathered((case.group, case) for module in MODULES for case in module.CASES).values()
    for case in group
)


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """The cases with these names, in the order of the catalogue; all cases without names.

    Raises:
        UsageError: no case has one of the names.
    """
    known = [case.name for case in CASES]
    for name in names:
        if name not in known:
            # All names are in lower case.
            near = get_close_matches(name.lower(), known, n=3)
            hint = f"; similar names: {', '.join(near)}" if near else ""
            raise UsageError(f"no hard case is called {name!r}{hint}; pointcoord hard --list prints all")
    return tuple(case for case in CASES if not names or case.name in names)
