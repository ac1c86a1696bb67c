r"""A file of results held to what it can carry.

A number q of a file at an independent value x agrees with ours if they differ by at most

    T = h_q + S + a + b + 4 eps Q,    S = sum over the independent columns of max |q(x -+ h_x) - q(x)|,

h_q and h_x half a unit of the last digit as written, S what the rounding of x may do to the quantity, taken
at both ends of all x that are written so (to first order |q'| h_x, and monotonic over such a width), a the
accuracy that the user says the file has, b our own proven bound; and reading, changing the unit and turning
the sign round four times at most, a component being no more exact than the largest of its quantity, Q, from
which it is computed. So T is 0 only where the car gives nothing but zeros and the user says that these are
exact.

Digits written in full say nothing of how exact a program is: it stops where its own tolerance is met. Where a
column is in full digits and neither the user nor a map says an accuracy, its program is taken to place every
point to e = the scene's own tolerance, mm (1e-9 if the scene says none, what `simulate` solves to), and a is
what that makes of the number at that pose, with the worst signs (`formulations.stated_accuracy`). A travel in
full digits is reached to e likewise, which goes into S. Rows where such an error may reach a singular pose
are not tested. Where S alone is as wide as half of the whole range that the quantity
has in the file, no number of it could tell its curve from a level line: it is not tested. Independent columns
in even steps are set values, h_x = 0. Where nobody says how another one is rounded, and T is more than ten
times what it is without that part of S, what agrees only within that is not tested either. Nor is a number of
the car that agrees where fewer than half of what the file gives of it can be compared: the others would be as
little tested in a file of them alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from pointcoord import PointcoordError, Scene
from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import SMALLEST, Comparison, Outcome, Verdict
from validate.diagnosis import Explanation, explain_evidence
from validate.diagnosis.evidence import Evidence, Solved
from validate.extras import MissingPackage
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import Accuracy, Solution
from validate.measured.mapping import CONTACT, PLACES, TIME, TRAVEL, Measured, Series
from validate.measured.poses import (
    SPEED,
    Driven,
    Found,
    Numbers,
    Poses,
    at_either_end,
    of_a_pose,
    ours_of,
    poses_of,
)
from validate.measured.supposed import in_reach, likely
from validate.plain_text import shown, some_of
from validate.tables.errors import FileError
from validate.tables.units import named
from validate.toml_written import key_of

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

EPS = float(np.finfo(float).eps)
OURS = "pointcoord"
RADII = (50.0, 1500.0)  # mm, of wheels
# Suppositions on an independent column that the whole file is held to; of several columns a map takes long.
TRIED = 3
# How much an offset that least squares found may leave: the largest difference is the least near it only.
NEARLY = 1.5
TOO_COARSE = (
    "what its rows are taken by is rounded so coarsely that no number could tell its curve from a level line"
)
NO_NUMBERS = "no row has a number of it that can be compared with anything"
# A verdict may not rest on a rounding that nobody states and that widens the tolerance by more than this.
WIDER = 10.0
# Rows out of reach, or columns, that are named one by one.
NAMED = 3


@dataclass(frozen=True)
class Held:
    """A column of a file beside ours.

    Attributes:
        ours, tolerance: (N,), NaN where there is nothing to compare.
        swing: the part of the tolerance that the independent columns' rounding makes, (N,).
        supposed: the part of that which is the rounding of columns whose last digit no map says, (N,).
        bound: the part that is our own proven bound, (N,).
        unknown: why ours are not known, in words.
    """

    series: Series
    ours: Array
    tolerance: Array
    swing: Array
    supposed: Array
    bound: Array
    unknown: str = ""

    @property
    def close(self) -> Array:
        """The tolerance, at most WIDER times what it is without what is supposed, (N,)."""
        return np.asarray(np.minimum(self.tolerance, WIDER * (self.tolerance - self.supposed)))

    @property
    def gap(self) -> Array:
        """Difference of every number, (N,), NaN where there is none."""
        return _apart(self.series.values, self.ours, self.series)

    @property
    def share(self) -> Array:
        """Difference of every number in its tolerance, likewise."""
        return np.asarray(self.gap / (self.tolerance + SMALLEST))

    @property
    def counts(self) -> tuple[int, int]:
        """How many of its numbers are compared, and how many there are."""
        there = np.isfinite(self.series.values)
        return int((there & np.isfinite(self.gap) & np.isfinite(self.tolerance)).sum()), int(there.sum())

    @property
    def few(self) -> bool:
        """Whether most of its numbers cannot be compared."""
        compared, there = self.counts
        return 2 * compared < there

    @property
    def blind(self) -> bool:
        """Whether the independent column is too coarse to tell anything of it."""
        told = self.ours[np.isfinite(self.ours)]
        wide = float(np.ptp(told)) if len(told) else 0.0
        swing = self.swing[np.isfinite(self.swing)]
        return bool(wide > 0.0 and len(swing) and (swing >= 0.5 * wide).all())


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
        return tuple(
            held
            for held in self.columns
            if (held.series.meaning.quantity, held.series.meaning.label) == (row.quantity, row.name)
        )


def compare_results(
    measured: Measured, scene: Scene, name: str, accuracy: float | None = None, factor: float = 1.0
) -> DataOutcome:
    """Compare a file with the scene's car, at the file's own values.

    Args:
        name: what to call the scene.
        accuracy: how far the file's numbers may be off beside their digits, each in its column's own unit;
            what a map says of a column goes before it. None: not said, see the top of this file.
        factor: how many times the tolerance to hold differences to.
    Raises:
        FileError: no row can be reached, or nothing can be compared.
        MissingPackage: digits in full without an accuracy need the extra `validate`.
        PointcoordError: the scene cannot be solved.
    """
    poses = poses_of(scene, measured)
    try:
        held, ours, notes = _held(measured, scene, accuracy, poses)
    except FileError as error:
        raise _with_meant(error, measured, poses.driven) from None
    solution = _solution(measured, held)
    rows = [
        _row(name, measured, quantity, of, columns, factor)
        for quantity, part in _by_name(held).items()
        for of, columns in part.items()
    ]
    lacking, absent = _lacking(scene, measured)
    compared = int(np.any([np.isfinite(h.gap) & np.isfinite(h.tolerance) for h in held], axis=0).sum())
    faults = _too_few(measured, poses.driven, held, compared)
    outcome = Outcome(
        name,
        tuple(rows),
        (solution, ours),
        (*notes, *faults),
        lacking,
        factor,
        faults=faults,
        compared=compared,
    )
    explanations = _explained(scene, measured, held, ours, outcome, factor)
    if outcome.disagreements:
        others = _other_independent(scene, measured, held, outcome, accuracy, poses.driven)
        # Of a single number its own fault is as likely.
        whole = len(rows) == 1 and any(one.leftover <= 1.0 for one in explanations)
        travel = _other_travel(scene, measured, held, outcome, accuracy)
        if others or travel:
            # What explains the whole file leaves nothing for what explains a part of some difference.
            explanations = tuple(one for one in explanations if one.leftover <= 1.0)
        explanations = (*explanations, *others) if whole else (*others, *explanations)
        explanations = (*travel, *explanations)
    outcome = replace(outcome, explanations=explanations)
    return DataOutcome(outcome, _over(measured), absent, accuracy or 0.0, tuple(held), measured.rows)


def _other_independent(
    scene: Scene,
    measured: Measured,
    held: Sequence[Held],
    outcome: Outcome,
    accuracy: float | None,
    driven: Driven,
) -> tuple[Explanation, ...]:
    """Whether the columns that rows are taken by are meant otherwise, such as in another unit."""
    lost = len(measured.rows) - int(np.isfinite(np.stack([h.ours for h in held])).any(axis=0).sum())
    names = tuple(f"{row.quantity}.{row.name}" for row in outcome.disagreements)
    few = islice(likely(driven, measured), TRIED if len(measured.independent) == 1 else 1)
    for one in few:
        try:
            other, _, _ = _held(one.measured, scene, accuracy)
        except PointcoordError:
            continue
        leftover = _largest(other) / outcome.factor
        further = len(measured.rows) - int(np.isfinite(np.stack([h.ours for h in other])).any(axis=0).sum())
        # Fewer rows that agree are no explanation of those that are out of reach then.
        if leftover <= (NEARLY if one.found else 1.0) and further <= lost:
            more = f"; this leaves {leftover:.3g} times what is tolerated" if leftover > 1.0 else ""
            return (Explanation(one.words + more, "input", names, leftover),)
    return ()


def _with_meant(error: FileError, measured: Measured, driven: Driven) -> FileError:
    """A file of which no row can be reached, with what its columns may be meant as."""
    meant = _meant(measured, driven)
    if not meant:
        return error
    allowed = f"{error.allowed}; they nearly are if {meant}"
    return FileError(error.source, error.place, error.problem, allowed)


def _meant(measured: Measured, driven: Driven) -> str:
    """What the columns that rows are taken by may be meant as, in words; empty if nothing is likely."""
    known = (one.words for one in likely(driven, measured))
    return next(known, "") or next(in_reach(driven, measured), "")


def _too_few(measured: Measured, driven: Driven, held: Sequence[Held], compared: int) -> tuple[str, ...]:
    """That most of what is given cannot be compared, and what the file may be meant as, if that is so."""
    there = int(np.any([np.isfinite(h.series.values) for h in held], axis=0).sum())
    if 2 * compared < there:
        meant = _meant(measured, driven)
        more = f"; nearly all can if {meant}" if meant else ""
        return (f"only {compared} of {there} rows that hold numbers can be compared{more}",)
    few = [h for h in held if h.few and not h.unknown and h.counts[0]]
    return tuple(
        f"only {h.counts[0]} of {h.counts[1]} numbers of {shown(h.series.column)} can be compared"
        for h in few
    )


def _other_travel(
    scene: Scene, measured: Measured, held: Sequence[Held], outcome: Outcome, accuracy: float | None
) -> tuple[Explanation, ...]:
    """Whether the travel of the wheel's centre is meant where that of the contact is said, or the other way.

    Where no rolling radius is said it is the one that leaves least.
    """
    centre = scene.mechanism.topology.wheel_centre
    said = next((s for s in measured.independent if s.meaning.kind == TRAVEL), None)
    if said is None or said.meaning.name not in (CONTACT, centre):
        return ()
    meant = replace(said.meaning, name=centre if said.meaning.name == CONTACT else CONTACT)
    independent = tuple(replace(s, meaning=meant) if s is said else s for s in measured.independent)

    def other(radius: float) -> Measured:
        return replace(measured, independent=independent, rolling_radius=radius)

    def left(radius: float) -> float:
        """The largest difference in its tolerance, of poses alone: the radius is where it is least."""
        driven = Driven.of(scene, other(radius))
        found = driven.poses([s.values for s in independent], measured.numbers)
        there = [
            replace(h, ours=np.asarray(ours_of(h.series, found, scene)[0]))
            for h in held
            if of_a_pose(h.series.meaning)
        ]
        return float(np.max(np.nan_to_num([h.share for h in there]), initial=0.0))

    try:
        radius = measured.rolling_radius
        if meant.name == CONTACT and not radius > 0.0:
            radius = float(minimize_scalar(left, bounds=RADII, method="bounded", options={"xatol": 0.1}).x)
        leftover = _largest(_held(other(radius), scene, accuracy)[0])
    except PointcoordError:
        return ()
    leftover /= outcome.factor
    if not leftover <= 1.0:
        return ()
    of = f" with a rolling radius of {radius:.4g} mm" if meant.name == CONTACT else ""
    words = f"{shown(said.column)} is {meant.words}{of}, not {said.meaning.words}"
    names = tuple(f"{row.quantity}.{row.name}" for row in outcome.disagreements)
    return (Explanation(words, "travel", names, leftover),)


def _largest(held: Sequence[Held]) -> float:
    """The largest difference of all columns in its tolerance; infinite if there is none."""
    shares = np.concatenate([h.share for h in held])
    return float(np.nanmax(shares, initial=0.0)) if np.isfinite(shares).any() else math.inf


def _explained(
    scene: Scene,
    measured: Measured,
    held: Sequence[Held],
    ours: Solution,
    outcome: Outcome,
    factor: float,
) -> tuple[Explanation, ...]:
    """What would explain that a file disagrees: of numbers of the car and of vectors that are given whole."""
    wrong = {(row.quantity, row.name) for row in outcome.disagreements}
    whole = {
        (quantity, name): sorted(columns, key=lambda h: h.series.meaning.axis or 0)
        for quantity, part in _by_name(held).items()
        for name, columns in part.items()
        if len(columns) == (1 if QUANTITIES[quantity].of == "car" else 3)
        # Of points kinds of faults read where they are, by name.
        and not (columns[0].series.meaning.per and QUANTITIES[quantity].of != "car")
        and any(np.isfinite(h.gap).any() for h in columns)
    }
    if not wrong & whole.keys():
        return ()
    told = np.all([np.isfinite(h.gap) for columns in whole.values() for h in columns], axis=0)

    def of(number: Callable[[Held], Array]) -> dict[tuple[str, str], Array]:
        stacked = {
            row: np.stack([number(h)[told] for h in columns], axis=-1) for row, columns in whole.items()
        }
        return {row: a[:, 0] if QUANTITIES[row[0]].of == "car" else a for row, a in stacked.items()}

    over_time = measured.independent[0].meaning.kind == TIME
    times = _instants(measured)[told] if over_time else np.arange(float(told.sum()))
    there = _on_the_grid(scene, times) if over_time else scene
    evidence = Evidence(
        scene=there,
        times=times if there is scene else there.instants,
        given=of(lambda h: h.series.values),
        held=of(lambda h: h.ours),
        allowed=of(lambda h: factor * (h.swing + h.bound) + SMALLEST),
        wrong=tuple(row for row in whole if row in wrong),
        solved=Solved(there),
        over_time=over_time,
        own=of(lambda h: factor * (h.tolerance - h.swing - h.bound)),
        units={row: columns[0].series.meaning.unit for row, columns in whole.items()},
        theirs={row: unit for row, columns in whole.items() if (unit := _given_in(columns))},
        known={} if over_time else {n: a[told] for n, a in ours.numbers[PLACES].items()},
    )
    try:
        return explain_evidence(evidence)
    except MissingPackage:
        # Laws in many digits are an extra that the verdict needs not.
        return ()


def _given_in(columns: Sequence[Held]) -> tuple[str, float] | None:
    """The unit that columns are in where it is not ours, and how many of ours it is; None of several."""
    factors, ours = {h.series.factor for h in columns}, columns[0].series.meaning.unit
    if len(factors) != 1 or factors == {1.0}:
        return None
    (factor,) = factors
    unit = named(factor, ours)
    return (unit, factor) if unit else None


def _on_the_grid(scene: Scene, times: Array) -> Scene:
    """The scene at a file's instants, where these are evenly apart: other cars are solved there."""
    if len(times) < 2:
        return scene
    ends = {"start": float(times[0]), "stop": float(times[-1]), "samples": len(times)}
    there = scene.model_copy(update={"time": scene.time.model_copy(update=ends)})
    even = np.abs(there.instants - times).max() <= 1e-12 * float(np.ptp(times))
    return there if times[-1] > times[0] and even else scene


def _held(
    measured: Measured, scene: Scene, accuracy: float | None, poses: Poses | None = None
) -> tuple[list[Held], Solution, tuple[str, ...]]:
    poses = poses_of(scene, measured) if poses is None else poses
    values = [s.values for s in (*measured.independent, *measured.rates)]
    first = len(measured.independent)
    here = poses.at(values[:first], values[first:])
    notes = [*measured.notes, *poses.driven.notes, *_out_of_reach(measured, here)]
    if not here.reached.any():
        row = min(here.reasons)
        problem = f"none of its {len(values[0])} rows can be reached ({here.reasons[row]})"
        raise FileError(measured.source, measured.rows[row], problem, "rows that the scene's car can have")
    unsaid = [s for s in measured.numbers if accuracy is None and s.accuracy is None and not s.off.any()]
    stated = _taken_for_granted(measured, poses.driven, here) if unsaid else here
    if unsaid:
        notes.append(_granted(unsaid, measured, scene))
    given = (*measured.independent, *measured.rates)
    reached_to = [
        s.off + scene.tolerance if unsaid and s.meaning.kind == TRAVEL and not s.off.any() else s.off
        for s in given
    ]
    around = [
        (not given[i].said and bool(given[i].off.any()), [poses.at(e[:first], e[first:]) for e in ends])
        for i, ends in at_either_end(values, reached_to)
    ]
    largest: dict[tuple[str, str], float] = {}
    for s in measured.numbers:
        of = s.meaning.quantity, s.meaning.per
        largest[of] = max(largest.get(of, 0.0), float(np.nanmax(np.abs(s.values), initial=0.0)))
    found, nothing = [], np.zeros(len(values[0]))
    for s in measured.numbers:
        mine, bound = ours_of(s, here, scene)
        swing, supposed = nothing, nothing
        for unstated, sides in around:
            there = [ours_of(s, side, scene)[0] for side in sides]
            gaps = [np.nan_to_num(_apart(t, mine, s)) for t in there if t is not None and mine is not None]
            change = np.max([nothing, *gaps], axis=0)
            swing, supposed = swing + change, supposed + unstated * change
        ours = np.full(len(nothing), np.nan) if mine is None else mine
        own_accuracy = ours_of(s, stated, scene)[1] if s in unsaid else s.accuracy_or(accuracy or 0.0)
        rounding = 4.0 * EPS * largest[s.meaning.quantity, s.meaning.per]
        parts = (own_accuracy, bound)
        allowed = s.off + swing + rounding + sum(0.0 if part is None else part for part in parts)
        why = "" if mine is not None else here.unrated or NO_NUMBERS
        own = nothing if bound is None else bound
        found.append(Held(s, ours, np.where(np.isfinite(ours), allowed, np.nan), swing, supposed, own, why))
    if unknown := [shown(h.series.column) for h in found if h.unknown]:
        notes.append(f"{', '.join(unknown)} is not tested: {here.unrated or NO_NUMBERS}")
    notes += _widened(measured, found)
    instants = _instants(measured)
    claims = {
        q: {n: np.nan_to_num(a) for n, a in part.items()}
        for q, part in here.bounds.items()
        if q in here.numbers
    }
    solution = Solution(OURS, instants, here.numbers, Accuracy(np.ones(len(instants)), claims, proven=True))
    return found, solution, tuple(notes)


def _taken_for_granted(measured: Measured, driven: Driven, here: Found) -> Found:
    """Ours, held to what placing every point to the scene's tolerance makes of each number.

    Where that says nothing of a number, its bound is NaN.
    """
    # Their packages are an extra that printed files need not.
    from validate.formulations.input_rates import rates

    rows, scene = here.reached, driven.scene
    if measured.independent[0].meaning.kind == TIME:
        times = measured.independent[0].values[rows]
        laws = {name: rates(law, times) for name, law in scene.inputs.items()}
    else:
        laws = {n: np.column_stack([value[rows], here.laws[n][rows]]) for n, value in here.inputs.items()}
    bounds = _stated(scene, here, laws)
    slopes, nothing = {}, np.zeros((int(rows.sum()), 2))
    for per, slope in here.slopes.items():
        speeds = bounds[SPEED]
        if slope.laws:
            going = {n: np.column_stack([law[:, 0], nothing]) for n, law in laws.items()}
            for name, law in slope.laws.items():
                going[name][:, 1] = law[rows]
            speeds = _stated(scene, here, going)[SPEED]
        slopes[per] = replace(slope, bounds=speeds)
    return replace(here, bounds=bounds, slopes=slopes)


def _stated(scene: Scene, here: Found, laws: Mapping[str, Array]) -> Numbers:
    """What placing every point to the scene's tolerance makes of each number, by inputs and their rates."""
    from validate.formulations.stated_accuracy import accuracy_at

    rows = here.reached
    places = {name: place[rows] for name, place in here.numbers[PLACES].items()}
    stated = accuracy_at(scene, scene.tolerance, places, laws)
    blind = np.zeros(int(rows.sum()), dtype=bool) if stated.blind is None else stated.blind
    found: Numbers = {}
    for quantity, part in stated.claims.items():
        found[quantity] = {}
        for name, claim in part.items():
            found[quantity][name] = np.full((len(rows), *claim.shape[1:]), np.nan)
            found[quantity][name][rows] = np.where(blind.reshape(-1, *(1,) * (claim.ndim - 1)), np.nan, claim)
    return found


def _granted(unsaid: Sequence[Series], measured: Measured, scene: Scene) -> str:
    names = some_of([shown(s.column) for s in unsaid], NAMED)
    who = (
        "the file is" if len(unsaid) == len(measured.numbers) else f"{names} {'are' if unsaid[1:] else 'is'}"
    )
    return (
        f"compared with points placed within {scene.tolerance:g} mm, the scene's tolerance, and with what "
        f"that makes of each number: {who} in full digits and no --accuracy is given"
    )


def _apart(one: Array, other: Array, series: Series) -> Array:
    """How far numbers of a column are apart; whole turns apart is the same angle."""
    gap = np.abs(one - other)
    return np.minimum(gap, np.abs(2.0 * np.pi - gap)) if series.meaning.unit == "rad" else gap


def _out_of_reach(measured: Measured, found: Found) -> list[str]:
    lost = sorted(found.reasons)
    notes = [f"{measured.rows[i]} is left out: {found.reasons[i]}" for i in lost[:NAMED]]
    if len(lost) > NAMED:
        others = [measured.rows[i] for i in lost[NAMED:]]
        notes.append(f"likewise left out: {some_of(others, NAMED)}")
    return notes


def _widened(measured: Measured, held: Sequence[Held]) -> list[str]:
    """Which columns have a wider tolerance by an independent one's rounding than by their own digits."""
    wide = [h for h in held if np.nanmax(h.supposed, initial=0.0) > np.nanmax(h.series.off, initial=0.0)]
    if not wide:
        return []
    names = some_of([shown(h.series.column) for h in wide], NAMED)
    return [f"{names}: tolerance widened because {_rounded(measured)}"]


def _rounded(measured: Measured) -> str:
    """Which independent columns are taken as rounded without a word of the user, and what to say of them."""
    some = [s for s in measured.independent if not s.said and s.off.any()]
    given = (f"{shown(s.column)} is given to +-{np.max(s.off) / s.factor:.3g}" for s in some)
    lines = ", ".join(f"columns.{key_of(shown(s.column))}.printed = 0" for s in some)
    return f"{' and '.join(given)}; if that is exact as written, add this line to a map: {lines}"


def _solution(measured: Measured, held: Sequence[Held]) -> Solution:
    """The file as a solution of its own."""
    instants = _instants(measured)
    count = len(instants)
    numbers: dict[str, dict[str, Array]] = {}
    claims: dict[str, dict[str, Array]] = {}
    for quantity, part in _by_name(held).items():
        numbers[quantity], claims[quantity] = {}, {}
        for name, columns in part.items():
            shape = (count,) if QUANTITIES[quantity].of == "car" else (count, 3)
            given, off = np.full(shape, np.nan), np.zeros(shape)
            for h in columns:
                axis = h.series.meaning.axis
                place = (slice(None),) if axis is None else (slice(None), axis)
                given[place], off[place] = h.series.values, np.nan_to_num(h.tolerance)
            numbers[quantity][name], claims[quantity][name] = given, off
    accuracy = Accuracy(np.ones(count), claims)
    return Solution(measured.source, instants, numbers, accuracy, measured.notes)


def _by_name(held: Sequence[Held]) -> dict[str, dict[str, list[Held]]]:
    found: dict[str, dict[str, list[Held]]] = {}
    for quantity in QUANTITIES:
        for h in held:
            if h.series.meaning.quantity == quantity:
                found.setdefault(quantity, {}).setdefault(h.series.meaning.label, []).append(h)
    return found


def _instants(measured: Measured) -> Array:
    if len(measured.independent) == 1:
        return measured.independent[0].values
    return np.arange(len(measured.rows), dtype=float)


def _over(measured: Measured) -> str:
    if len(measured.independent) == 1:
        s = measured.independent[0]
        return f"{s.column} [{s.meaning.unit}]"
    return "row"


def _row(
    scene: str, measured: Measured, quantity: str, name: str, columns: Sequence[Held], factor: float
) -> Comparison:
    """The comparison of a point, body or angle by the columns that are given of it."""
    unit = columns[0].series.meaning.unit
    gaps = np.stack([h.gap for h in columns])
    allowed = factor * np.stack([h.tolerance for h in columns])
    ends = (scene, measured.source, OURS, quantity, name, unit)
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
    verdict: Verdict = "agrees"
    why = ""
    if share > 1.0:
        verdict = "disagrees"
    elif all(h.blind for h in columns):
        verdict, why = "not tested", TOO_COARSE
    elif (compared & (gaps > factor * np.stack([h.close for h in columns]))).any():
        verdict = "not tested"
        why = f"it agrees only because {_rounded(measured)} (= 1 and the like if it is rounded so)"
    elif few := [h.counts for h in columns if h.few]:
        verdict, why = "not tested", "only {} of its {} numbers can be compared".format(*min(few))
    return Comparison(
        *ends,
        float(gaps[worst, when]),
        float(allowed[worst, when]),
        share,
        float(_instants(measured)[when]),
        verdict,
        measured.source,
        1.0,
        measured.rows[when],
        why=why,
    )


def _lacking(scene: Scene, measured: Measured) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What the scene asks for and the file does not give, in lines; and quantities of which it gives none."""
    given: dict[str, set[str]] = {}
    for s in measured.numbers:
        given.setdefault(s.meaning.quantity, set()).add(s.meaning.label)
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
