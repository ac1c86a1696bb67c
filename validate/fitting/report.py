"""The report on a fit or on suspects, as text, plain data and CSV; and the corrected scene as a file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.linalg import qr

from validate.exit_status import ExitStatus
from validate.fitting.fit import CONFIDENCE, Combination, Coordinate, Fit
from validate.fitting.suspects import Suspects
from validate.output.table import Part, Table, csv_of, text_of
from validate.plain_text import counted_as, shown
from validate.tables.units import degrees_of
from validate.toml_written import written

# Smallest printed part of a combination, relative to its largest; if exact, all that two decimals show.
SAID, SAID_EXACT = 0.2, 0.005
# Singular values below this part of the largest are zero to accuracy: the relative rounding error of slopes
# is EPS times the condition number of the pose, which reaches this only at a condition of 1e8, near a lock.
NOTHING = 2e-8
COORDINATE = ("coordinate", "drawn", "correction", "corrected", "deviation", "low", "high", "on_bound")
FIT_TABLE = (
    "coordinate",
    *("drawn [mm]", "correction [mm]", "corrected [mm]", "standard_deviation [mm]"),
    *("low_95 [mm]", "high_95 [mm]", "on_bound"),
)
MOVED = ("coordinate", "correction, mm", "standard deviation", f"{100.0 * CONFIDENCE:g} % interval")
# Residual in multiples of the rounding; above this a cause other than hardpoints is more likely.
STRANGE = 5.0
SIZES = ("each coordinate alone", "sets of two", "sets of three")
REFUSED = 3  # number of unsolvable sets that a warning names


@dataclass(frozen=True)
class Report:
    """The report on a fit or on suspects.

    Attributes:
        kind: kind of the document.
        what: name of the result, in words.
        status: NO_VERDICT if least squares did not converge and the result depends on it.
        results: the results as plain data for programs, angles in rad.
        table: the coordinates as CSV.
    """

    kind: str
    what: str
    status: ExitStatus
    text: str
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    results: Mapping[str, Any]
    table: str

    def data(self, name: str, source: str) -> dict[str, Any]:
        """The results with the names of scene and file, the confidence, notes and warnings."""
        about = {"scene": name, "data": shown(source), "confidence": CONFIDENCE}
        remarks = {"notes": [*map(shown, self.notes)], "warnings": [*map(shown, self.warnings)]}
        return {**about, **self.results, **remarks}


def report_of_fit(fit: Fit, name: str, source: str) -> Report:
    """The report on a fit."""
    problem, unseen, rms = fit.problem, _undetermined(fit), ("unit", "before", "after", "count")
    return Report(
        kind="fit",
        what="the fit",
        status=ExitStatus.AGREE if fit.converged else ExitStatus.NO_VERDICT,
        text=text_of([f"{name}: hardpoints fitted to {source}", *_parts_of_fit(fit, unseen)]),
        notes=problem.notes,
        warnings=tuple(_warnings_of_fit(fit)),
        results={
            "rms": [dict(zip(rms, (unit, *found), strict=True)) for unit, found in fit.rms.items()],
            "columns": [asdict(one) | {"column": shown(one.column)} for one in fit.columns],
            "coordinates": _coordinates(fit),
            "combinations": [asdict(one) for one in fit.combinations],
            "unique": not fit.unseen,
            "unseen": unseen,
            "left_over_digits": fit.factor,
            "freedom": fit.freedom,
            "bounds": problem.bounds,
            "prior": problem.prior,
            "converged": fit.converged,
            "solves": fit.solves,
            "failures": [*map(shown, fit.failures)],
        },
        table=csv_of(FIT_TABLE, map(_cells, _coordinates(fit))),
    )


def _parts_of_fit(fit: Fit, unseen: Sequence[str]) -> Iterator[Part]:
    for unit, (before, after, count) in fit.rms.items():
        numbers = counted_as(count, "number")
        yield f"  r.m.s. {_of(unit, before)} before, {_of(unit, after)} after ({numbers})"
    columns = (
        (shown(one.column), *(_of(one.unit, rms) for rms in (one.before, one.after, one.known_to)))
        for one in fit.columns
    )
    yield Table(("column", "r.m.s. before", "after", "standard deviation"), tuple(columns), indent=4)
    more = f"{fit.factor:.3g} times" if fit.factor > 1.0 else "no more than"
    yield f"  the residual is {more} the rounding of the digits\n"
    rows = tuple((at, *_moved(one)) for at, one in fit.coordinates.items())
    yield Table(MOVED, rows, indent=4, caption=f"  corrections, at most {fit.problem.bounds:g} mm")
    known = ", ".join(f"{one.singular_value:.3g}" for one in fit.combinations)
    yield f"\n  singular values of the scaled Jacobian, 1/mm: {known}"
    if not unseen:
        yield "\n  The data determine every combination of these coordinates: the answer is unique nearby."
        return
    yield f"\n  The answer is not unique: the data do not determine {_count(fit)} of coordinates. Along these"
    yield f"  the correction follows from the prior of {fit.problem.prior:g} mm, not from the data:"
    yield from (f"    {words}" for words in unseen)


def _warnings_of_fit(fit: Fit) -> Iterator[str]:
    if not fit.converged:
        why = f"; a design of the search could not be solved ({fit.failures[-1]})" if fit.failures else ""
        yield (
            f"least squares did not end at a minimum, {fit.solves} designs were tried{why}; take fewer "
            "coordinates, closer bounds or a smaller prior"
        )
    if fit.factor > STRANGE:
        yield (
            f"the residual is {fit.factor:.3g} times the rounding of the digits: other hardpoints may be "
            "wrong, or a column may have another unit, sign or definition; pointcoord validate SCENE "
            "--data FILE gives the difference column by column"
        )
    if fit.unseen:
        yield f"the answer is not unique: the data do not determine {_count(fit)} of coordinates"


def corrected_text(fit: Fit, name: str, source: str) -> str:
    """A scene file (TOML) of the corrected car, with the corrections in comments."""
    before = [f"# {shown(name)}, its hardpoints fitted to {shown(source)}."]
    if fit.unseen:
        before.append(f"# Not unique: the data do not determine {_count(fit)} of coordinates.")
    for at, one in fit.coordinates.items():
        known = "which is the bound" if one.on_bound else f"standard deviation {one.deviation:.2g} mm"
        before.append(f"# {at} moved by {one.correction:+z.4f} mm, {known}.")
    return "\n".join([*before, *written(fit.scene.model_dump(exclude_none=True))]) + "\n"


def report_of_suspects(found: Suspects, name: str, source: str) -> Report:
    """The report on suspects."""
    sets, equal = (*found.explaining, *found.nearest), len(found.equal)
    rows = [
        (rank, str(one.explains).lower(), one.residual, *_cells(row))
        for rank, one in enumerate(sets, 1)
        for row in _coordinates(one)
    ]
    title = f"{name}: hardpoints that may explain {source} (a diagnosis: nothing is corrected)"
    return Report(
        kind="fit-suspects",
        what="the suspects",
        status=ExitStatus.AGREE if found.certain else ExitStatus.NO_VERDICT,
        text=text_of([title, *_parts_of_suspects(found), f"  {verdict(found)}"]),
        notes=found.problem.notes,
        warnings=tuple(_warnings_of_suspects(found)),
        results={
            "explained_as_drawn": found.drawn,
            "left_over_digits": found.residual,
            "explaining": [_set(one, rank < equal) for rank, one in enumerate(found.explaining)],
            "nearest": [_set(one, False) for one in found.nearest],
            "tried": [{"fitted": some, "sets": every} for some, every in found.tried],
            "changes_nothing": list(found.unseen),
            "words": verdict(found),
        },
        table=csv_of(("set", "explains", "left_over_digits", *COORDINATE), rows),
    )


def _set(fit: Fit, equally_well: bool) -> dict[str, Any]:
    return {
        "coordinates": _coordinates(fit),
        "equally_well": equally_well,
        "left_over_digits": fit.residual,
        "freedom": fit.freedom,
        "converged": fit.converged,
    }


def _parts_of_suspects(found: Suspects) -> Iterator[Part]:
    numbers = counted_as(len(found.rest), "number")
    yield f"  residual as drawn: {found.residual:.3g} times the rounding of the digits, r.m.s. of {numbers}"
    if found.drawn:
        return
    tried = zip(SIZES, found.tried, strict=False)
    fitted = "; ".join(f"{size}: {some} of {every} fitted" for size, (some, every) in tried)
    yield f"  {fitted}; the others explain less in the linear problem"
    if found.unseen:
        yield f"  no effect on the numbers of the file: {', '.join(found.unseen)}"
    rows = (
        (f"{rank}", f"{one.residual:.3g}", at, *_moved(moved))
        for rank, one in enumerate(found.explaining or found.nearest, 1)
        for at, moved in one.coordinates.items()
    )
    caption = "sets that explain the file" if found.explaining else "no set explains the file; nearest sets"
    yield Table(("set", "times the rounding", *MOVED), tuple(rows), indent=4, caption=f"\n  {caption}")
    yield ""


def _warnings_of_suspects(found: Suspects) -> Iterator[str]:
    if not found.certain:
        yield "some fits did not end at a minimum: one of their sets may still explain the file"
    if found.refused:
        some = "; ".join(found.refused[:REFUSED])
        yield f"{counted_as(len(found.refused), 'set')} could not be fitted: {some}"


def verdict(found: Suspects) -> str:
    """One sentence: which sets explain the file; sets are named by their rank."""
    if found.drawn:
        return "The car as drawn explains the file: no hardpoint is suspect."
    if (equal := len(found.equal)) > 1:
        which = "1 and 2" if equal == 2 else f"1 to {equal}"
        return f"Sets {which} explain it equally well: the file cannot tell them apart."
    if not found.fits:
        return "No set explains the file: none could be fitted."
    best = (found.explaining or found.nearest)[0]
    names = " and ".join(best.coordinates)
    if found.explaining:
        verb = "explain" if len(best.coordinates) > 1 else "explains"
        return f"{names} {verb} it best; the file tells this set from every other set that was fitted."
    return (
        f"No set explains the file; nearest is {names}, with a residual of {best.residual:.3g} "
        "times the rounding: a column may have another unit, sign or definition, or more coordinates are off."
    )


def _moved(one: Coordinate) -> tuple[str, str, str]:
    """A correction, its standard deviation and its interval, as cells."""
    if one.on_bound:
        return f"{one.correction:+z.4f}", "-", "on its bound, and fixed there"
    return f"{one.correction:+z.4f}", f"{one.deviation:.2g}", f"{one.low:+z.4f} to {one.high:+z.4f}"


def _of(unit: str, number: float) -> str:
    factor, unit = degrees_of(unit)
    return f"{factor * number:.4g} {unit}"


def _count(fit: Fit) -> str:
    return f"{len(fit.unseen)} of {counted_as(len(fit.combinations), 'combination')}"


def _coordinates(fit: Fit) -> list[dict[str, Any]]:
    """Each coordinate, by the names of `COORDINATE`; deviation and interval are None on a bound."""
    fixed = dict.fromkeys(("deviation", "low", "high"))
    return [
        {"coordinate": name, **asdict(one), **(fixed if one.on_bound else {})}
        for name, one in fit.coordinates.items()
    ]


def _cells(row: Mapping[str, Any]) -> list[Any]:
    """A coordinate as the cells of a table; None is an empty cell."""
    return [str(cell).lower() if isinstance(cell, bool) else cell for cell in row.values()]


def _undetermined(fit: Fit) -> list[str]:
    """The combinations that the data do not determine; those without any effect in their simplest form."""
    least = NOTHING * max(one.singular_value for one in fit.combinations)
    nothing = [one for one in fit.unseen if one.singular_value <= least]
    words = [f"{_sum(parts, SAID_EXACT)}: has no effect" for parts in _simplest(nothing)]
    weak = (one for one in fit.unseen if one not in nothing)
    return words + [f"{_sum(one.parts, SAID)}: standard deviation {one.deviation:.2g} mm" for one in weak]


def _sum(parts: Mapping[str, float], least: float) -> str:
    """A combination as a sum, largest part first; parts below `least` times the largest are left out."""
    ranked = sorted(parts.items(), key=lambda one: -abs(one[1]))
    largest = ranked[0][1]
    some = [(name, part / largest) for name, part in ranked if abs(part) >= least * abs(largest)]
    words = " ".join(f"{'-' if part < 0.0 else '+'} {abs(part):.2f} {name}" for name, part in some)
    return words.removeprefix("+ ")


def _simplest(found: Sequence[Combination]) -> list[dict[str, float]]:
    """Another basis of the space of combinations, with few coordinates in each (QR with pivoting).

    Each combination has one coordinate that no other one has.
    """
    if not found:
        return []
    rows = np.array([[*one.parts.values()] for one in found])
    _, order = qr(rows, mode="r", pivoting=True)
    few = np.linalg.solve(rows[:, order[: len(rows)]], rows)
    return [dict(zip(found[0].parts, row.tolist(), strict=True)) for row in few]
