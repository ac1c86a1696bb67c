"""Compares a file of results with the car of a scene: the verdict on every number, and explanations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pointcoord import MissingLibrary, Scene
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from validate.arrays import Array, Indices
from validate.comparison.compare import Comparison, Outcome, Verdict
from validate.comparison.pair import SMALLEST
from validate.diagnosis import Explanation, explain_evidence
from validate.diagnosis.evidence import Evidence, Row, Solved
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import Accuracy, Solution
from validate.measured.mapping import Measured
from validate.measured.poses import Driven, row_by_row
from validate.measured.tolerances import NO_NUMBERS, OURS, Held, held_of, rounded
from validate.plain_text import shown

TOO_COARSE = (
    "the independent column is rounded so coarsely that any value would agree, even that of a constant curve"
)
FEWEST = 5  # least number of rows for which other cars are solved
MOST = 200  # largest number over several columns: a motion that turns at many rows takes minutes to solve


@dataclass(frozen=True)
class DataOutcome:
    """The comparison of a file.

    Attributes:
        outcome: the comparison, in the form of that of two solutions. Its instants are values of the
            independent column, in s, rad or mm, or indices of rows if there are several independent columns.
        over: name of the independent column with its unit, or `row`.
        accuracy: error of the file's numbers in addition to their rounding, in the units of their columns.
        absent: quantities that the scene asks for and the file does not give, in words. They have no rows in
            the outcome, so that it agrees if all given numbers agree.
        columns: the columns with our numbers. rows: names of the rows.
    """

    outcome: Outcome
    over: str
    absent: tuple[str, ...]
    accuracy: float = 0.0
    columns: tuple[Held, ...] = ()
    rows: tuple[str, ...] = ()

    @property
    def at(self) -> Array:
        """Values of the independent column, or indices of rows, (N,)."""
        return self.outcome.solutions[0].times

    def columns_of(self, row: Comparison) -> tuple[Held, ...]:
        """The columns that belong to a row of the outcome."""
        return tuple(held for held in self.columns if held.series.meaning.row == (row.quantity, row.name))


def compare_results(
    measured: Measured, scene: Scene, name: str, accuracy: float | None = None, factor: float = 1.0
) -> DataOutcome:
    """Compare a file with the scene's car, at the file's own values.

    Args:
        name: name of the scene.
        accuracy: error of the file's numbers in addition to their rounding, each in its column's unit; the
            map may give another one for a column. None: not stated, see `tolerances`.
        factor: multiple of the tolerance that is allowed.
    Raises:
        FileError: no row can be reached.
        MissingLibrary: the extra `validate` is not installed.
        PointcoordError: the scene cannot be solved.
    """
    driven = Driven.of(scene, measured)
    held, ours, notes = held_of(measured, driven, accuracy)
    # A number that neither has in any row, such as Ackermann of wheels that are not steered, is left out.
    there = [h for h in held if np.isfinite(h.series.values).any() or np.isfinite(h.ours).any() or h.unknown]
    by_row: dict[Row, list[Held]] = {}
    for h in sorted(there or held, key=lambda h: [*QUANTITIES].index(h.series.meaning.quantity)):
        by_row.setdefault(Row(*h.series.meaning.row), []).append(h)
    rows = tuple(_judged(name, measured, row, columns, factor) for row, columns in by_row.items())
    lacking, absent = _lacking(scene, measured)
    compared = int(np.any([np.isfinite(h.share) for h in held], axis=0).sum())
    faults = _too_few(held, compared)
    coarse = ", ".join(row.name for row in rows if row.why == TOO_COARSE)
    notes = (*notes, *([f"{coarse} is not tested: {TOO_COARSE}"] if coarse else []), *faults)
    solutions = _solution(measured, by_row), ours
    outcome = Outcome(name, rows, solutions, notes, lacking, compared, factor, faults=faults)
    if wrong := [row for row, one in zip(by_row, rows, strict=True) if one.verdict == "disagrees"]:
        found = _explained(driven, measured, by_row, wrong, factor)
        outcome = replace(outcome, explanations=found)
    one, *more = measured.independent
    over = "row" if more else f"{one.column} [{one.meaning.unit}]"
    return DataOutcome(outcome, over, absent, accuracy or 0.0, tuple(held), measured.rows)


def _judged(scene: str, measured: Measured, row: Row, columns: Sequence[Held], factor: float) -> Comparison:
    """The comparison of a quantity of a point, body or angle, from its columns."""
    ends = (scene, measured.source, OURS, *row, columns[0].series.meaning.unit)
    gaps, shares = np.stack([h.gap for h in columns]), np.stack([h.share for h in columns]) / factor
    compared = ~np.isnan(shares)
    if not compared.any():
        why = next((h.unknown for h in columns if h.unknown), NO_NUMBERS)
        return Comparison(*ends, verdict="not tested", rests_on=measured.source, why=why)
    share = float(np.nanmax(shares))
    # The largest difference; if the row disagrees, the largest of those that exceed their tolerance.
    seen = shares > 1.0 if share > 1.0 else compared
    worst = int(np.argmax(np.where(seen, gaps, -1.0)))
    column, place = divmod(worst, gaps.shape[1])
    verdict: Verdict = "not tested"
    why = ""
    if share > 1.0:
        verdict = "disagrees"
    elif all(h.blind for h in columns):
        why = TOO_COARSE
    elif any((h.gap > factor * h.close).any() for h in columns):
        why = f"it agrees only because {rounded(measured)} (or = 1 and so on if it is rounded to this)"
    elif few := [h.counts for h in columns if h.few]:
        why = "only {} of its {} numbers can be compared".format(*min(few))
    else:
        verdict = "agrees"
    return Comparison(
        *ends,
        difference=float(gaps[column, place]),
        tolerance=factor * float(columns[column].tolerance[place]),
        share=share,
        instant=float(measured.instants[place]),
        verdict=verdict,
        rests_on=measured.source,
        part=1.0,
        place=measured.rows[place],
        why=why,
    )


def _too_few(held: Sequence[Held], compared: int) -> tuple[str, ...]:
    """Messages if most rows, or most numbers of a column, cannot be compared."""
    there = int(np.any([np.isfinite(h.series.values) for h in held], axis=0).sum())
    if 2 * compared < there:
        return (f"only {compared} of {there} rows with numbers can be compared",)
    return tuple(
        f"only {h.counts[0]} of {h.counts[1]} numbers of {shown(h.series.column)} can be compared"
        for h in held
        if h.few and not h.unknown and h.counts[0]
    )


def _explained(
    driven: Driven,
    measured: Measured,
    by_row: Mapping[Row, Sequence[Held]],
    wrong: Sequence[Row],
    factor: float,
) -> tuple[Explanation, ...]:
    """Possible explanations of a disagreement, from numbers of the car and vectors with all components."""
    whole = {
        row: columns
        for row, columns in by_row.items()
        if len(columns) == (1 if row.of == "car" else 3) and any(np.isfinite(h.share).any() for h in columns)
    }
    if not whole.keys() & wrong:
        return ()
    every = [h.share for columns in whole.values() for h in columns]
    places, there = _as_motion(driven, measured, np.flatnonzero(np.isfinite(every).all(axis=0)))

    def of(number: Callable[[Held], Array]) -> dict[Row, Array]:
        return {row: _side_by_side(row, columns, number)[places] for row, columns in whole.items()}

    times = measured.instants[places] if driven.over_time else np.arange(float(len(places)))
    evidence = Evidence(
        scene=there or driven.scene,
        times=there.instants if there else times,
        given=of(lambda h: h.series.values),
        held=of(lambda h: h.ours),
        allowed=of(lambda h: factor * (h.swing + h.bound) + SMALLEST),
        wrong=tuple(row for row in whole if row in wrong),
        solved=Solved(there or driven.scene),
        over_time=driven.over_time,
        other_cars=driven.over_time or there is not None,
        own=of(lambda h: factor * (h.tolerance - h.swing - h.bound)),
        units={row: (columns[0].series.unit, columns[0].series.factor) for row, columns in whole.items()},
        labels=[measured.rows[place] for place in places],
    )
    try:
        return explain_evidence(evidence)
    except MissingLibrary:
        # Laws in many digits need an extra package, which the verdict does not need.
        return ()


def _side_by_side(row: Row, columns: Sequence[Held], number: Callable[[Held], Array]) -> Array:
    """A number of the columns of a row, (N, 3) or (N,); NaN for a component without a column."""
    if row.of == "car":
        return number(columns[0])
    found = np.full((len(columns[0].ours), 3), np.nan)
    for h in columns:
        found[:, h.series.meaning.axis] = number(h)
    return found


def _as_motion(driven: Driven, measured: Measured, rows: Indices) -> tuple[Indices, Scene | None]:
    """Some rows of a file in order, and a scene with a motion through them, for solving other cars.

    The rows of one independent column are sorted by it; those of several stay in the order of the file. The
    scene is None if times are not in even steps, if there are too few rows, or too many of several columns.
    """
    at = measured.instants[rows]
    if driven.over_time:
        if len(rows) < 2:
            return rows, None
        ends = {"start": float(at[0]), "stop": float(at[-1]), "samples": len(at)}
        there = driven.scene.model_copy(update={"time": driven.scene.time.model_copy(update=ends)})
        even = np.abs(there.instants - at).max() <= 1e-12 * float(np.ptp(at))
        return rows, there if at[-1] > at[0] and even else None
    if len(rows) < FEWEST or (len(rows) > MOST and len(driven.columns) > 1):
        return rows, None
    rows = rows[np.argsort(at, kind="stable")]
    still = [name for name in driven.scene.effects if not EFFECTS[name].derivative]
    inputs, _ = driven.inputs([s.values[rows] for s in measured.independent])
    return rows, row_by_row(driven.scene.model_copy(update={"effects": tuple(still)}), inputs)


def _solution(measured: Measured, by_row: Mapping[Row, Sequence[Held]]) -> Solution:
    """The file in the form of a solution."""
    numbers: dict[str, dict[str, Array]] = {}
    claims: dict[str, dict[str, Array]] = {}
    for row, columns in by_row.items():
        quantity, name = row
        numbers.setdefault(quantity, {})[name] = _side_by_side(row, columns, lambda h: h.series.values)
        off = np.nan_to_num(_side_by_side(row, columns, lambda h: h.tolerance))
        claims.setdefault(quantity, {})[name] = off
    instants = measured.instants
    accuracy = Accuracy(np.ones(len(instants)), claims)
    return Solution(measured.source, instants, numbers, accuracy, measured.notes)


def _lacking(scene: Scene, measured: Measured) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Lines on asked numbers that the file lacks, and the quantities that the file lacks completely."""
    given = {s.meaning.row for s in measured.numbers}
    lines, absent = [], []
    for quantity, names in asked_numbers(scene).items():
        words, of_car = QUANTITIES[quantity].words, QUANTITIES[quantity].of == "car"
        missing = [name for name in names if (quantity, name) not in given]
        none = len(missing) == len(names) and not of_car
        absent += missing if of_car else [words] * none
        if missing:
            of = "" if none else f" of {', '.join(missing)}"
            lines.append(f"{measured.source} gives no {words}{of}")
    return tuple(lines), tuple(absent)
