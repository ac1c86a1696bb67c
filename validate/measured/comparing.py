"""A file of results beside the car of a scene: the verdict of every number, and what would explain it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import MissingLibrary, Scene
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.comparison.compare import SMALLEST, Comparison, Outcome, Verdict
from validate.diagnosis import Explanation, explain_evidence
from validate.diagnosis.evidence import Evidence, Solved
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import Accuracy, Solution
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import PLACES
from validate.measured.poses import Driven
from validate.measured.supposed import meant_otherwise
from validate.measured.tolerances import NO_NUMBERS, OURS, Held, held_of, rounded
from validate.plain_text import shown

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
Row = tuple[str, str]

TOO_COARSE = (
    "what its rows are taken by is rounded so coarsely that no number could tell its curve from a level line"
)
FEWEST = 5  # rows that other cars are solved at


@dataclass(frozen=True)
class DataOutcome:
    """What came of a file.

    Attributes:
        outcome: its comparison as that of any two solutions; its instants are values of the independent
            column, in s, rad or mm, or numbers of rows from 0 on where several inputs are independent.
        over: what these are, with their unit.
        accuracy: how far the file's numbers may be off beside their digits, in their columns' units.
        absent: quantities that the scene asks for and the file does not give, in words; they are no rows of
            the outcome, so that it agrees where all that is given does.
        columns: each beside ours. rows: what to call each row of these.
    """

    outcome: Outcome
    over: str
    absent: tuple[str, ...]
    accuracy: float = 0.0
    columns: tuple[Held, ...] = ()
    rows: tuple[str, ...] = ()

    @property
    def at(self) -> Array:
        """Values of the independent column, or numbers of rows, (N,)."""
        return self.outcome.solutions[0].times

    def columns_of(self, row: Comparison) -> tuple[Held, ...]:
        """The columns that a row of the outcome is of."""
        return tuple(held for held in self.columns if _row_of(held) == (row.quantity, row.name))


def compare_results(
    measured: Measured, scene: Scene, name: str, accuracy: float | None = None, factor: float = 1.0
) -> DataOutcome:
    """Compare a file with the scene's car, at the file's own values.

    Args:
        name: what to call the scene.
        accuracy: how far the file's numbers may be off beside their digits, each in its column's own unit;
            what a map says of a column goes before it. None: not said, see `tolerances`.
        factor: how many times the tolerance to hold differences to.
    Raises:
        FileError: no row can be reached.
        MissingLibrary: it needs the extra `validate`.
        PointcoordError: the scene cannot be solved.
    """
    driven = Driven.of(scene, measured)
    held, ours, notes = held_of(measured, scene, accuracy, driven)
    by_row: dict[Row, list[Held]] = {}
    # What neither has anywhere, such as Ackermann of wheels that are not steered, is no difference.
    there = [h for h in held if np.isfinite(h.series.values).any() or np.isfinite(h.ours).any() or h.unknown]
    for quantity in QUANTITIES:
        for h in there or held:
            if h.series.meaning.quantity == quantity:
                by_row.setdefault(_row_of(h), []).append(h)
    rows = tuple(_judged(name, measured, *row, columns, factor) for row, columns in by_row.items())
    lacking, absent = _lacking(scene, measured)
    compared = int(np.any([np.isfinite(h.share) for h in held], axis=0).sum())
    faults = _too_few(held, compared)
    solutions = _solution(measured, by_row), ours
    coarse = ", ".join(row.name for row in rows if row.why == TOO_COARSE)
    notes = (*notes, *([f"{coarse} is not tested: {TOO_COARSE}"] if coarse else []), *faults)
    outcome = Outcome(name, rows, solutions, notes, lacking, factor, faults=faults, compared=compared)
    wrong = [(row.quantity, row.name) for row in outcome.disagreements]
    explanations = _explained(driven, scene, measured, by_row, ours, wrong, factor)
    names = tuple(map(".".join, wrong))
    if wrong and (other := meant_otherwise(scene, measured, held, accuracy, factor, names)):
        explanations = (other, *explanations)
    one, *others = measured.independent
    over = "row" if others else f"{one.column} [{one.meaning.unit}]"
    outcome = replace(outcome, explanations=explanations)
    return DataOutcome(outcome, over, absent, accuracy or 0.0, tuple(held), measured.rows)


def _row_of(held: Held) -> Row:
    """Under which quantity and name a column is compared."""
    return held.series.meaning.quantity, held.series.meaning.name


def _judged(
    scene: str, measured: Measured, quantity: str, name: str, columns: Sequence[Held], factor: float
) -> Comparison:
    """The comparison of a point, body or angle by the columns that are given of it."""
    gaps, allowed = (
        np.stack(part) for part in zip(*((h.gap, factor * h.tolerance) for h in columns), strict=True)
    )
    ends = (scene, measured.source, OURS, quantity, name, columns[0].series.meaning.unit)
    compared = np.isfinite(gaps) & np.isfinite(allowed)
    if not compared.any():
        nan = math.nan
        why = next((h.unknown for h in columns if h.unknown), NO_NUMBERS)
        return Comparison(*ends, nan, nan, nan, nan, "not tested", measured.source, nan, why=why)
    shares = np.where(compared, gaps / (allowed + SMALLEST), -1.0)
    share = float(shares.max())
    # The largest difference; of a column that disagrees, the largest of those that are too large.
    seen = shares > 1.0 if share > 1.0 else compared
    worst, when = (int(i) for i in np.unravel_index(int(np.argmax(np.where(seen, gaps, -1.0))), gaps.shape))
    verdict: Verdict = "not tested"
    why = ""
    if share > 1.0:
        verdict = "disagrees"
    elif all(h.blind for h in columns):
        why = TOO_COARSE
    elif any((h.gap > factor * h.close).any() for h in columns):
        why = f"it agrees only because {rounded(measured)} (= 1 and the like if it is rounded so)"
    elif few := [h.counts for h in columns if h.few]:
        why = "only {} of its {} numbers can be compared".format(*min(few))
    else:
        verdict = "agrees"
    at = gaps[worst, when], allowed[worst, when], share, measured.instants[when]
    difference, tolerance, _, instant = map(float, at)
    place = measured.rows[when]
    return Comparison(
        *ends, difference, tolerance, share, instant, verdict, measured.source, 1.0, place, why=why
    )


def _too_few(held: Sequence[Held], compared: int) -> tuple[str, ...]:
    """That most of what is given cannot be compared."""
    there = int(np.any([np.isfinite(h.series.values) for h in held], axis=0).sum())
    if 2 * compared < there:
        return (f"only {compared} of {there} rows that hold numbers can be compared",)
    return tuple(
        f"only {h.counts[0]} of {h.counts[1]} numbers of {shown(h.series.column)} can be compared"
        for h in held
        if h.few and not h.unknown and h.counts[0]
    )


def _explained(
    driven: Driven,
    scene: Scene,
    measured: Measured,
    by_row: dict[Row, list[Held]],
    ours: Solution,
    wrong: Sequence[Row],
    factor: float,
) -> tuple[Explanation, ...]:
    """What would explain that a file disagrees: of numbers of the car and of vectors that are given whole."""
    whole = {
        row: sorted(columns, key=lambda h: h.series.meaning.axis or 0)
        for row, columns in by_row.items()
        if len(columns) == (1 if _of_car(row) else 3) and any(np.isfinite(h.share).any() for h in columns)
    }
    if not whole.keys() & wrong:
        return ()
    every = [h for columns in whole.values() for h in columns]
    told = np.flatnonzero(np.isfinite([h.share for h in every]).all(axis=0))
    over_time = driven.over_time
    there = _on_the_grid(scene, measured.instants[told]) if over_time else None
    if not over_time:
        told, there = _by_rows(driven, measured.independent, told)

    def of(number: Callable[[Held], Array]) -> dict[Row, Array]:
        stacked = {
            row: np.stack([number(h)[told] for h in columns], axis=-1) for row, columns in whole.items()
        }
        return {row: a[:, 0] if _of_car(row) else a for row, a in stacked.items()}

    times = measured.instants[told] if over_time else np.arange(float(len(told)))
    evidence = Evidence(
        scene=there or scene,
        times=there.instants if there else times,
        given=of(lambda h: h.series.values),
        held=of(lambda h: h.ours),
        allowed=of(lambda h: factor * (h.swing + h.bound) + SMALLEST),
        wrong=tuple(row for row in whole if row in wrong),
        solved=Solved(there or scene),
        over_time=over_time,
        other_cars=over_time or there is not None,
        own=of(lambda h: factor * (h.tolerance - h.swing - h.bound)),
        units={row: columns[0].series.meaning.unit for row, columns in whole.items()},
        known={} if over_time else {n: a[told] for n, a in ours.numbers[PLACES].items()},
    )
    try:
        return explain_evidence(evidence)
    except MissingLibrary:
        # Laws in many digits are an extra that the verdict needs not.
        return ()


def _of_car(row: Row) -> bool:
    """Whether the car has one number of a row, and no vector."""
    return QUANTITIES[row[0]].of == "car"


def _on_the_grid(scene: Scene, times: Array) -> Scene | None:
    """The scene at a file's instants, where these are evenly apart: other cars are solved there."""
    if len(times) < 2:
        return None
    ends = {"start": float(times[0]), "stop": float(times[-1]), "samples": len(times)}
    there = scene.model_copy(update={"time": scene.time.model_copy(update=ends)})
    even = np.abs(there.instants - times).max() <= 1e-12 * float(np.ptp(times))
    return there if times[-1] > times[0] and even else None


def _by_rows(driven: Driven, independent: Sequence[Series], rows: Rows) -> tuple[Rows, Scene | None]:
    """Some rows of a file as a motion, one at each whole second, and their order in it: along one column."""
    one, *others = independent
    if others or len(rows) < FEWEST:
        return rows, None
    rows = rows[np.argsort(one.values[rows], kind="stable")]
    inputs, _ = driven.inputs([one.values[rows]])
    laws = {name: _from_row_to_row(value) for name, value in inputs.items()}
    content = driven.scene.model_dump(exclude_none=True, exclude={"points"})
    effects = [
        name for name in driven.scene.effects if not EFFECTS[name].derivative and not EFFECTS[name].way
    ]
    time = {"start": 0.0, "stop": float(len(rows) - 1), "samples": len(rows)}
    content |= {"inputs": laws, "time": time, "effects": effects}
    return rows, Scene.from_mapping(content, driven.scene.title or "scene")


def _from_row_to_row(values: Array) -> dict[str, Any]:
    """A law that has these values at whole seconds; a straight one, which is solved soonest, if it may be."""
    times, first = np.arange(float(len(values))), float(values[0])
    step = float(values[-1] - values[0]) / max(len(values) - 1, 1)
    if np.abs(values - (first + step * times)).max() <= 4.0 * EPS * np.abs(values).max():
        return {"polynomial": [first, step]} if step else {"constant": first}
    return {"table": {"times": times.tolist(), "values": values.tolist()}}


def _solution(measured: Measured, by_row: dict[Row, list[Held]]) -> Solution:
    """The file as a solution of its own."""
    count = len(measured.instants)
    numbers: dict[str, dict[str, Array]] = {}
    claims: dict[str, dict[str, Array]] = {}
    for row, columns in by_row.items():
        quantity, name = row
        given, off = np.full((count, 3), np.nan), np.zeros((count, 3))
        for h in columns:
            axis = h.series.meaning.axis or 0
            given[:, axis], off[:, axis] = h.series.values, np.nan_to_num(h.tolerance)
        numbers.setdefault(quantity, {})[name] = given[:, 0] if _of_car(row) else given
        claims.setdefault(quantity, {})[name] = off[:, 0] if _of_car(row) else off
    return Solution(
        measured.source, measured.instants, numbers, Accuracy(np.ones(count), claims), measured.notes
    )


def _lacking(scene: Scene, measured: Measured) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What the scene asks for and the file does not give, in lines; and quantities of which it gives none."""
    given: dict[str, set[str]] = {}
    for s in measured.numbers:
        given.setdefault(s.meaning.quantity, set()).add(s.meaning.name)
    lines, absent = [], []
    for quantity, names in asked_numbers(scene).items():
        words, of_car = QUANTITIES[quantity].words, QUANTITIES[quantity].of == "car"
        missing = [name for name in names if name not in given.get(quantity, set())]
        if of_car:
            absent += missing
        elif len(missing) == len(names):
            absent.append(words)
        if missing:
            whole = len(missing) == len(names) and not of_car
            of = "" if whole else f" of {', '.join(missing)}"
            lines.append(f"{measured.source} gives no {words}{of}")
    return tuple(lines), tuple(absent)
