"""The report on suspected sets of coordinates: as text, as plain data, and as a table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from textwrap import wrap
from typing import Any

from validate.exit_status import ExitStatus
from validate.fitting.fit import CONFIDENCE, Fit
from validate.fitting.suspects import Suspects
from validate.fitting.words import COORDINATE, Said, cells_of, coordinates_of, moved
from validate.output.table import csv_of

SIZES = ("coordinate alone", "sets of two", "sets of three")
REFUSED = 3  # number of unsolvable sets that a warning names
WIDE = 100  # characters per line


def said_of_suspects(found: Suspects, name: str, source: str) -> Said:
    """The report on suspects; status 3 if no set explains the file and some fits did not converge."""
    surely = found.ended or found.explaining or found.drawn
    return Said(
        kind="fit-suspects",
        what="the suspects",
        status=ExitStatus.AGREE if surely else ExitStatus.NO_VERDICT,
        text="\n".join(_lines(found, name, source)),
        notes=found.notes,
        warnings=tuple(_warnings(found)),
        results=_data(found),
        table=_table(found),
    )


def _lines(found: Suspects, name: str, source: str) -> Iterator[str]:
    yield f"{name}: hardpoints that may explain {source} (a diagnosis: nothing is corrected)"
    drawn = f"{times(found.left, found.count):.3g} times the rounding of the digits"
    yield f"  residual as drawn: {drawn}, r.m.s. of {found.count} numbers"
    if not found.drawn:
        fitted = (
            f"{'each ' if size == 0 else ''}{SIZES[size]}: {some} of {every} fitted"
            for size, (some, every) in enumerate(found.tried)
        )
        yield f"  {'; '.join(fitted)}; the others explain less in the linear problem"
        if found.unseen:
            yield f"  no effect on the numbers of the file: {', '.join(found.unseen)}"
        head = "sets that explain the file" if found.explaining else "no set explains the file; nearest sets"
        where = f"{100.0 * CONFIDENCE:g} % interval"
        yield f"\n  {head}: residual in multiples of the rounding; offsets, mm, +- deviation, {where}"
        sets = found.explaining or found.nearest
        width = max((len(at) for one in sets for at in one.coordinates), default=0)
        for rank, one in enumerate(sets, 1):
            before = f"  {rank:4}. {left_of(one):8.3g}"
            for at, offset in one.coordinates.items():
                yield f"{before}  {at.ljust(width)} {moved(offset)}"
                before = " " * len(before)
        yield ""
    yield from (f"  {line}" for line in wrap(verdict(found), WIDE, break_on_hyphens=False))


def verdict(found: Suspects) -> str:
    """One sentence: which sets explain the file; sets are named by their rank."""
    if found.drawn:
        return "The car as drawn explains the file: no hardpoint is suspect."
    if (equal := len(found.equal)) > 1:
        which = "1 and 2" if equal == 2 else f"1 to {equal}"
        return f"Sets {which} explain it equally well: the file cannot tell them apart."
    if found.explaining:
        best = found.explaining[0]
        verb = "explain" if len(best.coordinates) > 1 else "explains"
        return f"{names(best)} {verb} it best; the file tells this set from every other set that was fitted."
    if not found.nearest:
        return "No set explains the file: none could be fitted."
    nearest = found.nearest[0]
    return (
        f"No set explains the file; nearest is {names(nearest)}, with a residual of {left_of(nearest):.3g} "
        "times the rounding: a column may have another unit, sign or definition, or more coordinates are off."
    )


def names(fit: Fit) -> str:
    """The names of the coordinates of a set."""
    return " and ".join(fit.coordinates)


def left_of(fit: Fit) -> float:
    """The residual of a set, r.m.s., in multiples of the rounding of the digits."""
    return times(fit.left, max(fit.freedom, 1))


def times(left: float, count: int) -> float:
    """The r.m.s. of `count` numbers from their sum of squares, in multiples of the rounding of the digits."""
    return math.sqrt(left / count)


def _warnings(found: Suspects) -> Iterator[str]:
    """The warnings on the suspects."""
    if not (found.ended or found.explaining):
        yield "some fits did not end at a minimum: one of their sets may still explain the file"
    if found.refused:
        some = "; ".join(found.refused[:REFUSED])
        yield f"{len(found.refused)} sets could not be fitted: {some}"


def _data(found: Suspects) -> dict[str, Any]:
    """The suspects as plain data."""
    equal = len(found.equal)
    return {
        "explained_as_drawn": found.drawn,
        "left_over_digits": times(found.left, found.count),
        "explaining": [_set(one, rank < equal) for rank, one in enumerate(found.explaining)],
        "nearest": [_set(one, False) for one in found.nearest],
        "tried": [{"fitted": some, "sets": every} for some, every in found.tried],
        "changes_nothing": list(found.unseen),
        "words": verdict(found),
    }


def _set(fit: Fit, equally_well: bool) -> dict[str, Any]:
    return {
        "coordinates": coordinates_of(fit),
        "equally_well": equally_well,
        "left_over_digits": left_of(fit),
        "freedom": fit.freedom,
        "converged": fit.converged,
    }


def _table(found: Suspects) -> str:
    """A row for each coordinate of each set, the best set first."""
    rows = [
        (rank, str(one in found.explaining).lower(), left_of(one), *cells_of(row))
        for rank, one in enumerate((*found.explaining, *found.nearest), 1)
        for row in coordinates_of(one)
    ]
    return csv_of(("set", "explains", "left_over_digits", *COORDINATE), rows)
