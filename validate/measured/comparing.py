"""Compares a file of results with the car of a scene: the verdict on every number, and explanations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from validate.arrays import Array, Indices
from validate.comparison.compare import Comparison, Outcome, Verdict
from validate.comparison.pair import SMALLEST
from validate.diagnosis import Explanation, explain_evidence
from validate.diagnosis.evidence import Evidence, Row
from validate.diagnosis.solved import Solved
from validate.formulations.asked_numbers import asked_numbers, per_second
from validate.formulations.protocol import Accuracy, Solution
from validate.measured.mapping import Measured
from validate.measured.poses import Driven, Found, row_by_row
from validate.measured.tolerances import Held, held_of
from validate.plain_text import gathered, shown
from validate.toml_written import key_of

OURS = "pointcoord"
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
        absent: quantities that the scene asks for and the file does not give, in words. They have no rows in
            the outcome, so that it agrees if all given numbers agree.
        accuracy: error of the file's numbers in addition to their rounding, in the units of their columns.
        columns: the columns with our numbers. rows: names of the rows.
    """

    outcome: Outcome
    over: str
    absent: tuple[str, ...]
    accuracy: float
    columns: tuple[Held, ...]
    rows: tuple[str, ...]

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
    here = Driven.of(scene, measured).at()
    held, assumed = held_of(here, accuracy)
    # A number that neither has in any row, such as Ackermann of wheels that are not steered, is left out.
    there = [h for h in held if np.isfinite(h.series.values).any() or np.isfinite(h.ours).any()] or held
    in_order = sorted(there, key=lambda h: [*QUANTITIES].index(h.series.meaning.quantity))
    by_row = gathered((Row(*h.series.meaning.row), h) for h in in_order)
    rows = tuple(_judged(name, here.driven, row, columns, factor) for row, columns in by_row.items())
    untested = gathered((row.why, row.name) for row in rows if row.why)
    notes = (
        *(*measured.notes, *here.driven.notes, *here.left_out, *assumed),
        *(
            f"{', '.join(map(shown, dict.fromkeys(some)))} is not tested: {why}"
            for why, some in untested.items()
        ),
    )
    compared = int(np.any([np.isfinite(h.share) for h in held], axis=0).sum())
    times, accuracies = measured.instants, Accuracy(np.ones(len(measured.rows)))
    solutions = (Solution(measured.source, times, {}, accuracies), Solution(OURS, times, {}, accuracies))
    explanations: tuple[Explanation, ...] = ()
    if wrong := [row for row, one in zip(by_row, rows, strict=True) if one.verdict == "disagrees"]:
        explanations = _explained(here, by_row, wrong, factor)
    outcome = Outcome(name, rows, solutions, notes, (), compared, factor, explanations)
    one, *more = measured.independent
    over = "row" if more else f"{one.column} [{one.meaning.unit}]"
    return DataOutcome(outcome, over, _absent(scene, measured), accuracy or 0.0, tuple(held), measured.rows)


def _judged(scene: str, driven: Driven, row: Row, columns: Sequence[Held], factor: float) -> Comparison:
    """The comparison of a quantity of a point, body or angle, from its columns."""
    measured = driven.measured
    gaps, shares = np.stack([h.gap for h in columns]), np.stack([h.share for h in columns]) / factor
    ends = (scene, measured.source, OURS, *row, columns[0].series.meaning.unit)
    verdict: Verdict = "not tested"
    why = ""
    if np.isnan(shares).all():
        rate = per_second(row.quantity) and not driven.over_time
        why = "rates need a column of time" if rate else "no row has a number of it that can be compared"
        return Comparison(*ends, verdict=verdict, rests_on=measured.source, why=why)
    share = float(np.nanmax(shares))
    if share > 1.0:
        verdict = "disagrees"
    elif all(h.blind for h in columns):
        why = TOO_COARSE
    elif any(h.supposes(factor) for h in columns):
        why = f"it agrees only because {_rounded(measured)}"
    elif few := [counts for counts in (h.compared for h in columns) if 2 * counts[0] < counts[1]]:
        why = "only {} of its {} numbers can be compared".format(*min(few))
    else:
        verdict = "agrees"
    # The largest difference; if the row disagrees, the largest of those that exceed their tolerance.
    seen = shares > 1.0 if share > 1.0 else ~np.isnan(shares)
    worst = int(np.argmax(np.where(seen, gaps, -1.0)))
    column, place = divmod(worst, gaps.shape[1])
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


def _rounded(measured: Measured) -> str:
    """The independent columns taken as rounded although this is not stated, and the lines for a map."""
    some = [s for s in measured.independent if s.rounded_unasked]
    given = " and ".join(f"{shown(s.column)} is given to +-{np.max(s.off) / s.factor:.3g}" for s in some)
    lines = ", ".join(f"columns.{key_of(shown(s.column))}.printed = 0" for s in some)
    return f"{given}; if it is exact as written, add to a map: {lines} (or the unit to which it is rounded)"


def _explained(
    here: Found, by_row: Mapping[Row, Sequence[Held]], wrong: Sequence[Row], factor: float
) -> tuple[Explanation, ...]:
    """Possible explanations of a disagreement, from numbers of the car and vectors with all components."""
    whole = {
        row: sorted(columns, key=lambda h: h.series.meaning.axis or 0)
        for row, columns in by_row.items()
        if len(columns) == (1 if row.of == "car" else 3) and any(np.isfinite(h.share).any() for h in columns)
    }
    if not whole.keys() & wrong:
        return ()
    shares = [h.share for columns in whole.values() for h in columns]
    places, there = _as_motion(here, np.flatnonzero(np.isfinite(shares).all(axis=0)))
    driven, measured = here.driven, here.driven.measured

    def of(number: Callable[[Held], Array]) -> dict[Row, Array]:
        parts = {row: [number(h)[places] for h in columns] for row, columns in whole.items()}
        return {row: np.stack(some, axis=-1) if some[1:] else some[0] for row, some in parts.items()}

    times = measured.instants[places] if driven.over_time else np.arange(float(len(places)))
    evidence = Evidence(
        scene=there or driven.scene,
        times=there.instants if there else times,
        given=of(lambda h: h.series.values),
        trusted=of(lambda h: h.ours),
        allowed=of(lambda h: factor * (h.swing + h.bound) + SMALLEST),
        wrong=tuple(row for row in whole if row in wrong),
        solved=Solved(there or driven.scene),
        over_time=driven.over_time,
        other_cars=driven.over_time or there is not None,
        own=of(lambda h: factor * h.own),
        units={row: (columns[0].series.unit, columns[0].series.factor) for row, columns in whole.items()},
        labels=[measured.rows[place] for place in places],
    )
    return explain_evidence(evidence)


def _as_motion(here: Found, rows: Indices) -> tuple[Indices, Scene | None]:
    """Some rows of a file in order, and a scene with a motion through them, for solving other cars.

    The rows of one independent column are sorted by it; those of several stay in the order of the file. The
    scene is None if times are not in even steps, if there are too few rows, or too many of several columns.
    """
    driven = here.driven
    at = driven.measured.instants[rows]
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
    places = np.searchsorted(here.rows, rows)
    still = tuple(name for name in driven.scene.effects if not EFFECTS[name].derivative)
    inputs = {name: value[places] for name, value in here.inputs.items()}
    return rows, row_by_row(driven.scene.model_copy(update={"effects": still}), inputs)


def _absent(scene: Scene, measured: Measured) -> tuple[str, ...]:
    """Numbers of the car, and vectors of all points or bodies, that the scene asks for and the file lacks."""
    given, absent = {s.meaning.row for s in measured.numbers}, list[str]()
    for quantity, names in asked_numbers(scene).items():
        missing = [name for name in names if (quantity, name) not in given]
        if QUANTITIES[quantity].of == "car":
            absent += missing
        elif len(missing) == len(names):
            absent.append(QUANTITIES[quantity].words)
    return tuple(absent)
