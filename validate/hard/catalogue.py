"""All hard cases in the order of their groups, by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches

from validate.errors import UsageError
from validate.hard.case import Case
from validate.hard.cases import (
    body_rates,
    branches,
    ends,
    far,
    laws,
    links,
    numbers,
    points,
    reach,
    regressions,
    turned,
)
from validate.hard.family import OF_PARTS, SUBJECTS

CASES: tuple[Case, ...] = (
    *ends.CASES,
    *turned.CASES,
    *body_rates.CASES,
    *points.NEAR,
    *far.CASES,
    *laws.CASES,
    *branches.CASES,
    *reach.CASES,
    *links.CASES,
    *numbers.CASES,
    *regressions.CASES,
    *points.BESIDE,
)

# Cases with fewer than eight values of their parameter, and why they have no more.
_WAY = "each value is a whole way up to where it locks, or through a near miss: half a second to three"
_REFUSAL = "each refusal takes half a second or more"
_SEARCH = "each value is a search from a thousand starts"
_SECOND = "the strut is tried at more values; here it is the other mechanism, or another car, that counts"
_SUFFIXES = (*(subject.suffix for subject in (*SUBJECTS[1:], *OF_PARTS)), "-turned")
_BY_REASON: Mapping[str, tuple[str, ...]] = {
    _REFUSAL: ("strut-points-near", "knuckle-foot-short", "strut-drawn-folded"),
    "each refusal takes two thousand segments": ("long-sine",),
    _SEARCH: tuple(f"assemblies-counted-{where}" for where in ("drawing", "rack", "arm", "meeting")),
    _WAY: (
        "strut-passes-flat",
        *("branches-nearly-meet", "branches-nearly-meet-beside", "branches-met", "branches-met-beside"),
        *("whole-range-arm", "whole-range-rack", "far-start-high", "far-start-rack"),
        *("reach-arm-highest", "reach-arm-lowest", "reach-rack-least", "reach-rack-greatest"),
        *("reach-slide-runs-out", "reach-upper-arm-locks", "reach-tie-rod-locks-the-arm"),
        *("start-beyond-upper-arm-locks", "start-beyond-tie-rod-locks-the-arm"),
        *("upper-arm-locks-held", "upper-arm-locks-moving", "upper-arm-locks-beyond"),
    ),
}
FEW_VALUES: Mapping[str, str] = {
    **{case.name: _SECOND for case in CASES if len(case.values) < 8 and case.name.endswith(_SUFFIXES)},
    **{name: reason for reason, names in _BY_REASON.items() for name in names},
}


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """The cases of these names in the order of the catalogue, or all without names.

    Raises:
        UsageError: a name that no case has.
    """
    known = [case.name for case in CASES]
    for name in names:
        if name not in known:
            # All names are in lower case.
            near = get_close_matches(name.lower(), known, n=3)
            hint = f"; near names: {', '.join(near)}" if near else ""
            raise UsageError(f"no hard case is called {name!r}{hint}; pointcoord hard --list names all")
    return tuple(case for case in CASES if not names or case.name in names)
