"""What the rows of the study of cost say: who reaches an accuracy in what time, and how cost grows.

Arithmetic on rows only. Three rules keep it honest. A way is in a race for an accuracy only by a setting
whose largest error, and the reference's own radius on top of it, is at or below that accuracy: a wrong number
is never quick. Times whose quartiles overlap are a tie. Nothing is averaged over quantities, scenes or ways.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from validate.cost.row import QuantityError, Row, Time

ACCURACIES = (1e-3, 1e-6, 1e-9)
"""In the unit of each quantity: mm of positions."""

OURS = ("series", "map", "newton", "newton-cold", "chord")
"""The ways of this project's solver; every other way is a contestant."""

DECADES = 2.0  # below the largest size: an exponent is fitted where fixed costs have been left behind
STRAIGHT = 0.25  # a line that misses a measured time by more, of that time, tells no crossover

Verdict = Literal["ours", "tie", "other", "only ours", "only others", "nobody"]


def phases(quantity: str) -> tuple[str, ...]:
    """What has to be done for a quantity, from instants to arrays; the set-up is apart."""
    return ("solve", "output") if quantity == "position" else ("solve", "rates", "output")


def together(row: Row, names: Iterable[str]) -> Time | None:
    """Some phases together, for all configurations, s; None where one was not measured.

    The quartiles are those of the phases, added: the interval is wider than that of a sum that was measured.
    """
    names = tuple(names)
    if row.status != "measured" or any(name not in row.times for name in names):
        return None
    times = [row.times[name] for name in names]
    total = Time(
        sum(t.median for t in times),
        sum(t.lower for t in times),
        sum(t.upper for t in times),
        min((t.repeats for t in times), default=0),
    )
    return total if math.isfinite(total.median) and total.median > 0.0 else None


def a_configuration(row: Row, names: Iterable[str]) -> Time | None:
    """Some phases together, for one configuration, s."""
    total = together(row, names)
    if total is None or row.configurations <= 0:
        return None
    n = row.configurations
    return Time(total.median / n, total.lower / n, total.upper / n, total.repeats)


def proven(error: QuantityError | None) -> float:
    """What an error is at most, the reference's own radius counted; infinite where it is not known."""
    if error is None or not (math.isfinite(error.largest) and math.isfinite(error.radius)):
        return math.inf
    return error.largest + error.radius


def apart(one: Time, other: Time) -> bool:
    """Whether two times differ by more than their quartiles: intervals that touch are a tie."""
    return one.upper < other.lower or other.upper < one.lower


@dataclass(frozen=True)
class Reach:
    """How a way comes to an accuracy.

    Attributes:
        accuracy: that was asked for, in the quantity's unit.
        setting: the cheapest that is accurate enough, value: the number that it dials; None where none is.
        time: of that setting, for one configuration, s.
        floor: the smallest of the largest errors of all settings, None if no setting gave the quantity.
        reason: why there is no floor.
    """

    scene: str
    quantity: str
    accuracy: float
    way: str
    setting: str | None
    time: Time | None
    floor: float | None
    reason: str = ""
    value: float | None = None


@dataclass(frozen=True)
class Race:
    """Who is quicker to an accuracy.

    Attributes:
        reached: those that reach it, the quickest first.
        missed: those that do not.
        verdict: of the quickest of ours against the quickest of the others.
    """

    scene: str
    quantity: str
    accuracy: float
    reached: tuple[Reach, ...]
    missed: tuple[Reach, ...]
    verdict: Verdict

    @property
    def ours(self) -> Reach | None:
        """The quickest of ours."""
        return next((r for r in self.reached if r.way in OURS), None)

    @property
    def other(self) -> Reach | None:
        """The quickest of the others."""
        return next((r for r in self.reached if r.way not in OURS), None)

    @property
    def ratio(self) -> float | None:
        """Time of the quickest of the others in times of the quickest of ours."""
        if self.ours is None or self.other is None:
            return None
        return _median(self.other) / _median(self.ours)


def _median(reach: Reach) -> float:
    return math.inf if reach.time is None else reach.time.median


def accuracy_rows(rows: Iterable[Row]) -> list[Row]:
    """Those that hold errors against times."""
    return [row for row in rows if row.part == "accuracy"]


def scenes_of(rows: Iterable[Row]) -> list[str]:
    """Scenes in the order in which they come."""
    return list(dict.fromkeys(row.scene for row in rows))


def quantities_of(rows: Iterable[Row]) -> list[str]:
    """Quantities that any row has an error of, in the order of the registry."""
    found = {quantity for row in rows for quantity in row.errors}
    return [*(q for q in QUANTITIES if q in found), *sorted(found - QUANTITIES.keys())]


def unit_of(quantity: str) -> str:
    """The unit of a quantity's numbers."""
    return QUANTITIES[quantity].unit if quantity in QUANTITIES else ""


def words_of(quantity: str) -> str:
    """A quantity for people."""
    return QUANTITIES[quantity].words if quantity in QUANTITIES else quantity


def reach(rows: Sequence[Row], quantity: str, accuracy: float) -> Reach:
    """How one way comes to an accuracy of one scene, by its rows."""
    best: tuple[Time, Row] | None = None
    floor: float | None = None
    for row in rows:
        error = row.errors.get(quantity) if row.status == "measured" else None
        if error is None or not math.isfinite(error.largest):
            continue
        floor = error.largest if floor is None else min(floor, error.largest)
        time = a_configuration(row, phases(quantity))
        if time is not None and proven(error) <= accuracy and (best is None or time.median < best[0].median):
            best = (time, row)
    return Reach(
        rows[0].scene,
        quantity,
        accuracy,
        rows[0].way,
        None if best is None else best[1].setting,
        None if best is None else best[0],
        floor,
        "" if floor is not None else _reason(rows, quantity),
        None if best is None else best[1].value,
    )


def _reason(rows: Sequence[Row], quantity: str) -> str:
    for row in rows:
        if row.status != "measured":
            return f"{row.status}: {row.reason}"
        if quantity in row.not_given:
            return f"not given: {row.not_given[quantity]}"
    return "no error was measured"


def races(rows: Iterable[Row], accuracies: Sequence[float] = ACCURACIES) -> list[Race]:
    """Every race, by scene, quantity and accuracy."""
    rows = accuracy_rows(rows)
    found = []
    for scene in scenes_of(rows):
        here = [row for row in rows if row.scene == scene]
        ways = {way: [row for row in here if row.way == way] for way in dict.fromkeys(r.way for r in here)}
        for quantity in quantities_of(here):
            for accuracy in accuracies:
                entries = [reach(of_way, quantity, accuracy) for of_way in ways.values()]
                reached = sorted((e for e in entries if e.time is not None), key=_median)
                missed = [e for e in entries if e.time is None]
                found.append(
                    Race(scene, quantity, accuracy, tuple(reached), tuple(missed), _verdict(reached))
                )
    return found


def _verdict(reached: Sequence[Reach]) -> Verdict:
    ours = [r.time for r in reached if r.way in OURS and r.time is not None]
    others = [r.time for r in reached if r.way not in OURS and r.time is not None]
    if not ours or not others:
        return "only ours" if ours else "only others" if others else "nobody"
    if not apart(ours[0], others[0]):
        return "tie"
    return "ours" if ours[0].median < others[0].median else "other"


@dataclass(frozen=True)
class Fit:
    """A power law, value = factor size^exponent, by least squares of the logarithms.

    Attributes:
        exponent, factor: of the law.
        error: the exponent's standard error; None from two points, which any law fits.
        smallest, largest: the sizes between which it was fitted. points: how many.
    """

    exponent: float
    factor: float
    error: float | None
    smallest: float
    largest: float
    points: int

    def at(self, size: float) -> float:
        """The law's value."""
        return float(self.factor * size**self.exponent)


def power_law(sizes: Sequence[float], values: Sequence[float]) -> Fit | None:
    """Fit a power law to positive points; None from fewer than two sizes.

    With x = log size and y = log value: exponent = Sxy / Sxx, and its standard error is
    sqrt(sum of squared residuals / (n - 2) / Sxx).
    """
    kept = [(s, v) for s, v in zip(sizes, values, strict=True) if s > 0.0 and v > 0.0 and math.isfinite(v)]
    if len({s for s, _ in kept}) < 2:
        return None
    x, y = np.log(np.array(kept, dtype=float)).T
    about = x - x.mean()
    spread = float(about @ about)
    exponent = float(about @ y) / spread
    residuals = y - y.mean() - exponent * about
    error = math.sqrt(float(residuals @ residuals) / (len(x) - 2) / spread) if len(x) > 2 else None
    factor = math.exp(float(y.mean() - exponent * x.mean()))
    return Fit(exponent, factor, error, min(s for s, _ in kept), max(s for s, _ in kept), len(kept))


def law_of_the_large(points: Sequence[tuple[float, float]]) -> Fit | None:
    """The power law of the largest sizes: two decades of them, and three points if there are as many."""
    points = sorted(points)
    large = [p for p in points if p[0] >= points[-1][0] * 10.0**-DECADES * (1.0 - 1e-9)] if points else []
    large = large if len(large) >= 3 else points[-3:]
    return power_law([s for s, _ in large], [v for _, v in large])


@dataclass(frozen=True)
class Growth:
    """How time or memory of a way grows.

    Attributes:
        against: instants, designs or unknowns. of: what grows, in s or bytes.
        points: size and value, the smallest size first.
        fit: see `law_of_the_large`.
        stopped: sizes that failed or were left out, with reasons.
    """

    scene: str
    way: str
    setting: str
    against: str
    of: Literal["time", "memory"]
    points: tuple[tuple[float, float], ...]
    fit: Fit | None
    stopped: tuple[tuple[float, str], ...]


def whole_run(row: Row) -> Time | None:
    """All phases that were measured of a run, `first` apart, for all configurations together, s.

    Against instants the set-up is left out: it is the same for any number of them.
    """
    apart = ("first", "set-up") if row.against == "instants" else ("first",)
    return together(row, [name for name in row.times if name not in apart])


def growths(rows: Iterable[Row]) -> list[Growth]:
    """How time and memory grow, by what is varied, scene, way and setting."""
    groups: dict[tuple[str, str, str, str], list[Row]] = {}
    for row in rows:
        if row.part == "growth" and row.size is not None:
            groups.setdefault((row.against, row.scene, row.way, row.setting), []).append(row)
    found = []
    for (against, scene, way, setting), group in groups.items():
        group = sorted(group, key=lambda row: row.size or 0)
        stopped = tuple(
            (float(r.size or 0), f"{r.status}: {r.reason}") for r in group if r.status != "measured"
        )
        times = [(float(r.size or 0), t.median) for r in group if (t := whole_run(r)) is not None]
        peaks = [
            (float(r.size or 0), float(r.peak_bytes))
            for r in group
            if r.status == "measured" and r.peak_bytes is not None and r.peak_bytes > 0
        ]
        of: Literal["time", "memory"]
        for of, points in (("time", times), ("memory", peaks)):
            if points or (of == "time" and stopped):
                fit = law_of_the_large(points)
                found.append(Growth(scene, way, setting, against, of, tuple(points), fit, stopped))
    return found


@dataclass(frozen=True)
class Line:
    """Time of a run as a fixed part and a part for each instant, s.

    Attributes:
        misses: the largest distance of a measured time from the line, of that time.
        set_up: median time of the set-up, which is in neither part.
    """

    way: str
    setting: str
    fixed: float
    each: float
    misses: float
    set_up: float
    largest: float
    dense: bool


def line(points: Sequence[tuple[float, float]]) -> tuple[float, float, float]:
    """Fixed part, part for each and largest relative miss of t = fixed + each n; neither part is negative.

    Least squares of the relative residuals (fixed + each n) / t - 1: small sizes count like large ones.
    """
    sizes, times = np.array(points, dtype=float).T
    columns = np.stack([1.0 / times, sizes / times], axis=1)
    solution = np.linalg.lstsq(columns, np.ones(len(times)), rcond=None)[0]
    if solution[0] < 0.0 or solution[1] < 0.0:
        # The constrained minimum of two unknowns lies where one of them is 0.
        alone = [column @ np.ones(len(times)) / (column @ column) for column in columns.T]
        choices = [np.array([alone[0], 0.0]), np.array([0.0, alone[1]])]
        solution = min(choices, key=lambda c: float(np.sum((columns @ c - 1.0) ** 2)))
    return float(solution[0]), float(solution[1]), float(np.max(np.abs(columns @ solution - 1.0)))


@dataclass(frozen=True)
class Crossover:
    """From how many instants one way is quicker than another, both at the accuracy or better.

    Attributes:
        instants: the count from which `above` is quicker; `below` is quicker before it. None if one of them
            is quicker at every count: then both names are its name.
        with_set_up: whether one set-up is counted.
        measured: the largest count that was measured of both: beyond it the lines are prolonged.
    """

    scene: str
    quantity: str
    accuracy: float
    ours: Line
    other: Line
    with_set_up: bool
    instants: float | None
    below: str
    above: str
    measured: float


def crossing(ours: Line, other: Line, with_set_up: bool) -> tuple[float | None, str, str]:
    """Where two lines cross at one instant or more, who is quicker before and who after."""
    first = ours.fixed + (ours.set_up if with_set_up else 0.0)
    second = other.fixed + (other.set_up if with_set_up else 0.0)
    at_one = first + ours.each <= second + other.each
    at_last = (ours.each, first) <= (other.each, second)
    below, above = (ours.way if at_one else other.way), (ours.way if at_last else other.way)
    if below == above:
        return None, below, above
    return (first - second) / (other.each - ours.each), below, above


def crossovers(rows: Sequence[Row], accuracies: Sequence[float] = ACCURACIES) -> list[Crossover]:
    """Of each scene whose growth in instants was measured: each of ours against each of the others."""
    found = []
    grown = [row for row in rows if row.part == "growth" and row.against == "instants"]
    for scene, quantity, accuracy in product(scenes_of(grown), ("position", "acceleration"), accuracies):
        known = {(r.way, r.setting): r for r in accuracy_rows(rows) if r.scene == scene}
        here = [row for row in grown if row.scene == scene]
        lines = _lines(here, known, quantity, accuracy)
        ours, others = ([one for one in lines if (one.way in OURS) == mine] for mine in (True, False))
        for other, one, counted in product(others, ours, (False, True)):
            measured = min(one.largest, other.largest)
            cross = crossing(one, other, counted)
            found.append(Crossover(scene, quantity, accuracy, one, other, counted, *cross, measured))
    return found


def _lines(
    grown: Sequence[Row], known: Mapping[tuple[str, str], Row], quantity: str, accuracy: float
) -> list[Line]:
    """Of each way the setting that is accurate enough and costs the least for each instant."""
    best: dict[str, Line] = {}
    for way, setting in dict.fromkeys((row.way, row.setting) for row in grown):
        group = [r for r in grown if (r.way, r.setting) == (way, setting) and r.size]
        errors = [r.errors.get(quantity) for r in group if r.status == "measured" and r.errors]
        if not errors and (way, setting) in known:
            errors = [known[way, setting].errors.get(quantity)]
        if not errors or any(proven(error) > accuracy for error in errors):
            continue
        times = [(r, t) for r in group if (t := together(r, phases(quantity))) is not None]
        if len({r.size for r, _ in times}) < 3:
            continue
        fixed, each, misses = line([(float(r.size or 0), t.median) for r, t in times])
        set_ups = [r.times["set-up"].median for r, _ in times if "set-up" in r.times]
        largest = max(float(r.size or 0) for r, _ in times)
        one = Line(
            way,
            setting,
            fixed,
            each,
            misses,
            float(np.median(set_ups)) if set_ups else 0.0,
            largest,
            group[0].dense,
        )
        if misses <= STRAIGHT and (way not in best or one.each < best[way].each):
            best[way] = one
    return list(best.values())


@dataclass(frozen=True)
class Dial:
    """What a way's accuracy costs: time of a configuration against what is dialled.

    Attributes:
        fit: time = factor value^exponent; a negative exponent says that accuracy costs time.
        coarse, fine: the times at the coarsest and the finest value, s.
        settings: these two in words.
    """

    scene: str
    way: str
    quantity: str
    fit: Fit
    coarse: Time
    fine: Time
    settings: tuple[str, str]

    @property
    def a_digit(self) -> float:
        """How many times as long a tenth of the value takes."""
        return float(10.0**-self.fit.exponent)

    @property
    def turns(self) -> bool:
        """Whether accuracy costs time for certain: quartiles apart, a slope beyond two standard errors."""
        return self.apart and (self.fit.error is None or self.rises)

    @property
    def apart(self) -> bool:
        """Whether the finest value takes longer than the coarsest one, their quartiles apart."""
        return self.coarse.upper < self.fine.lower

    @property
    def rises(self) -> bool:
        """Whether the slope over all values says that accuracy costs time, by more than two standard errors.

        The slope of equal times is rounding, and so is its error: a digit must cost a thousandth at least.
        """
        error = self.fit.error
        return error is not None and -self.fit.exponent > 2.0 * error and self.a_digit >= 1.001


def dials(rows: Iterable[Row], quantity: str = "position") -> list[Dial]:
    """The dial of each way that has one, by scene: a setting of ours, or one that moves the error tenfold."""
    groups: dict[tuple[str, str], list[tuple[float, Time, str]]] = {}
    errors: dict[tuple[str, str], list[float]] = {}
    for row in accuracy_rows(rows):
        time = a_configuration(row, phases(quantity))
        if row.value is not None and row.value > 0.0 and time is not None and quantity in row.errors:
            groups.setdefault((row.scene, row.way), []).append((row.value, time, row.setting))
            errors.setdefault((row.scene, row.way), []).append(proven(row.errors[quantity]))
    found = []
    for (scene, way), points in groups.items():
        if way not in OURS and max(errors[scene, way]) < 10.0 * min(errors[scene, way]):
            continue
        points.sort(key=lambda point: point[0])
        fit = power_law([value for value, _, _ in points], [time.median for _, time, _ in points])
        if fit is not None:
            coarse, fine = points[-1], points[0]
            found.append(Dial(scene, way, quantity, fit, coarse[1], fine[1], (coarse[2], fine[2])))
    return found


@dataclass(frozen=True)
class Findings:
    """All that the rows say."""

    races: tuple[Race, ...]
    growths: tuple[Growth, ...]
    crossovers: tuple[Crossover, ...]
    dials: tuple[Dial, ...]


def findings(rows: Sequence[Row]) -> Findings:
    """Everything that is computed from rows."""
    return Findings(tuple(races(rows)), tuple(growths(rows)), tuple(crossovers(rows)), tuple(dials(rows)))
