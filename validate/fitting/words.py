"""The report on a fit: as text, as plain data, and as a table; and the corrected scene as a file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, astuple, dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from validate.exit_status import ExitStatus
from validate.fitting.fit import CONFIDENCE, Combination, Coordinate, Fit
from validate.output.table import csv_of
from validate.plain_text import shown
from validate.tables.units import degrees_of
from validate.toml_written import written

Array = NDArray[np.float64]

# Smallest printed part of a combination, relative to its largest; if exact, all that two decimals show.
SAID, SAID_EXACT = 0.2, 0.005
# Singular values below this part of the largest are zero to accuracy: the relative rounding error of slopes
# is EPS times the condition number of the pose, which reaches this only at a condition of 1e8, near a lock.
NOTHING = 2e-8
COORDINATE = ("coordinate", *(one.name for one in fields(Coordinate)))
# Residual in multiples of the rounding; above this a cause other than hardpoints is more likely.
STRANGE = 5.0


@dataclass(frozen=True)
class Said:
    """The report on a fit or on suspects.

    Attributes:
        kind: kind of the document.
        what: name of the result, in words.
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
        said = {"notes": self.notes, "warnings": self.warnings}
        return {**about, **self.results, **{key: [*map(shown, words)] for key, words in said.items()}}


def said_of_fit(fit: Fit, name: str, source: str) -> Said:
    """The report on a fit; status 3 if least squares did not converge."""
    return Said(
        kind="fit",
        what="the fit",
        status=ExitStatus.AGREE if fit.converged else ExitStatus.NO_VERDICT,
        text="\n".join(lines_of(fit, name, source)),
        notes=fit.notes,
        warnings=tuple(warnings_of_fit(fit)),
        results=data_of(fit),
        table=table_of(fit),
    )


def lines_of(fit: Fit, name: str, source: str) -> Iterator[str]:
    """The lines of the text on a fit."""
    yield f"{name}: hardpoints fitted to {source}"
    for unit, (before, after, count) in fit.rms.items():
        yield f"  r.m.s. {_of(unit, before)} before, {_of(unit, after)} after ({count} numbers)"
    for one in fit.columns:
        ends = f"{_of(one.unit, one.before)} before, {_of(one.unit, one.after)} after"
        yield f"    {shown(one.column)}: {ends}; standard deviation {_of(one.unit, one.known_to)}"
    more = f"{fit.factor:.3g} times" if fit.factor > 1.0 else "no more than"
    yield f"  the residual is {more} the rounding of the digits\n"
    where = f"{100.0 * CONFIDENCE:g} % interval"
    yield f"  correction, mm, within +-{fit.bounds:g}; standard deviation; {where}"
    width = max(len(at) for at in fit.coordinates)
    yield from (f"    {at.ljust(width)} {moved(one)}" for at, one in fit.coordinates.items())
    yield "\n  singular values of the scaled Jacobian, 1/mm, and standard deviation of each combination, mm"
    for combined in fit.combinations:
        known = f"{combined.deviation:.3g}" if combined.seen else "not determined"
        yield f"    {combined.singular_value:10.3g}  {known}"
    if not fit.unseen:
        yield "\n  The data determine every combination of these coordinates: the answer is unique nearby."
        return
    unseen = f"{len(fit.unseen)} of {len(fit.combinations)} combinations of coordinates"
    yield f"\n  The answer is not unique: the data do not determine {unseen}. Along these"
    yield f"  the correction follows from the prior of {fit.prior:g} mm, not from the data. Any may be added:"
    yield from (f"    {words}" for words in unseen_words(fit))


def moved(one: Coordinate) -> str:
    """A correction, its standard deviation and its interval."""
    known = f"+- {one.deviation:.2g}   {one.low:+z.4f} to {one.high:+z.4f}"
    return f"{one.correction:+z10.4f} " + ("  on its bound, and fixed there" if one.on_bound else known)


def warnings_of_fit(fit: Fit) -> Iterator[str]:
    """The warnings on a fit."""
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
    if on := ", ".join(at for at, one in fit.coordinates.items() if one.on_bound):
        yield f"{on}: on the bound of {fit.bounds:g} mm; wider bounds may give a smaller residual"
    if fit.unseen:
        unseen = counted(len(fit.unseen))
        yield f"the answer is not unique: the data do not determine {unseen} of coordinates"


def counted(number: int) -> str:
    """A number of combinations, in words."""
    return f"{number} combination{'' if number == 1 else 's'}"


def unseen_words(fit: Fit) -> list[str]:
    """The combinations that the data do not determine; those without any effect in their simplest form."""
    least = NOTHING * max(one.singular_value for one in fit.combinations)
    nothing = [one for one in fit.unseen if one.singular_value <= least]
    said = [f"{combination(parts, SAID_EXACT)}: has no effect" for parts in simplest(nothing)]
    weak = (one for one in fit.unseen if one not in nothing)
    return said + [f"{combination(one.parts)}: standard deviation {one.deviation:.2g} mm" for one in weak]


def combination(parts: Mapping[str, float], said: float = SAID) -> str:
    """A combination as a sum, largest part first; parts below `said` times the largest are left out."""
    largest = max(abs(part) for part in parts.values())
    ranked = sorted(parts.items(), key=lambda one: -abs(one[1]))
    some = [(name, part / largest) for name, part in ranked if abs(part) >= said * largest]
    if len(some) == 1:
        return some[0][0]
    sign = math.copysign(1.0, some[0][1])
    words = " ".join(f"{'-' if sign * part < 0.0 else '+'} {abs(part):.2f} {name}" for name, part in some)
    return words.removeprefix("+ ")


def simplest(found: Sequence[Combination]) -> list[dict[str, float]]:
    """Another basis of the space of combinations, with few coordinates in each (QR with pivoting).

    Each combination has one coordinate that no other one has.
    """
    if not found:
        return []
    rows = np.array([[*one.parts.values()] for one in found])
    _, order = qr(rows, mode="r", pivoting=True)
    few = np.linalg.solve(rows[:, order[: len(rows)]], rows)
    return [dict(zip(found[0].parts, row.tolist(), strict=True)) for row in few]


def _of(unit: str, number: float) -> str:
    factor, unit = degrees_of(unit)
    return f"{factor * number:.4g} {unit}"


def data_of(fit: Fit) -> dict[str, Any]:
    """The fit as plain data."""
    rms = ("unit", "before", "after", "count")
    return {
        "rms": [dict(zip(rms, (unit, *found), strict=True)) for unit, found in fit.rms.items()],
        "columns": [asdict(one) | {"column": shown(one.column)} for one in fit.columns],
        "coordinates": coordinates_of(fit),
        "combinations": [asdict(one) for one in fit.combinations],
        "unique": not fit.unseen,
        "unseen": unseen_words(fit),
        "left_over_digits": fit.factor,
        **{key: getattr(fit, key) for key in ("freedom", "bounds", "prior", "converged", "solves")},
        "failures": [shown(failure) for failure in fit.failures],
    }


def table_of(fit: Fit) -> str:
    """A row for each coordinate."""
    names = {"deviation": "standard_deviation", "low": "low_95", "high": "high_95"}
    lengths = (f"{names.get(key, key)} [mm]" for key in COORDINATE[1:-1])
    return csv_of((COORDINATE[0], *lengths, COORDINATE[-1]), map(cells_of, coordinates_of(fit)))


def corrected_text(fit: Fit, name: str, source: str) -> str:
    """A scene file (TOML) of the corrected car, with the corrections in comments."""
    before = [f"# {shown(name)}, its hardpoints fitted to {shown(source)}."]
    before += [
        f"# r.m.s. difference {first:.4g} {unit} before, {last:.4g} {unit} after."
        for unit, (first, last, _) in fit.rms.items()
    ]
    if fit.unseen:
        before.append(f"# Not unique: the data do not determine {counted(len(fit.unseen))} of coordinates.")
    for at, one in fit.coordinates.items():
        known = "which is the bound" if one.on_bound else f"standard deviation {one.deviation:.2g} mm"
        before.append(f"# {at} moved by {one.correction:+z.4f} mm, {known}.")
    return "\n".join([*before, *written(fit.scene.model_dump(exclude_none=True))]) + "\n"


def coordinates_of(fit: Fit) -> list[dict[str, Any]]:
    """Each coordinate, by the names of `COORDINATE`; deviation and interval are None on a bound."""
    rows = [
        dict(zip(COORDINATE, (name, *astuple(one)), strict=True)) for name, one in fit.coordinates.items()
    ]
    return [r | (dict.fromkeys(("deviation", "low", "high")) if r["on_bound"] else {}) for r in rows]


def cells_of(row: Mapping[str, Any]) -> list[Any]:
    """A coordinate as the cells of a table; None is an empty cell."""
    return [str(cell).lower() if isinstance(cell, bool) else cell for cell in row.values()]
