"""Two formulations on one scene: every quantity's largest difference, against a derived tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.results.named_columns import html_table
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene
from pointcoord.wording import nearest, shown
from validate.comparison.given import given_by_both
from validate.comparison.pair import SMALLEST, Pair
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import AccuracyError, Formulation, FormulationError, Solution
from validate.formulations.registry import formulation

Array = NDArray[np.float64]
GIVEN_BACK = "points of the chassis, or such as stay where they are drawn"
Verdict = Literal["agrees", "disagrees", "not tested", "not given"]


@dataclass(frozen=True)
class Explanation:
    """What would explain that numbers disagree; `diagnosis` finds it.

    Attributes:
        words: which numbers, and what was done to them.
        kind: of fault, as `diagnosis.kinds` calls it; two kinds joined by "and".
        quantities: whose numbers it explains: a quantity where it explains all that disagrees of it and
            undoes nothing that agrees, else quantity.name.
        leftover: the largest difference that is left when the fault is undone / what it is held to.
    """

    words: str
    kind: str
    quantities: tuple[str, ...]
    leftover: float


@dataclass(frozen=True)
class Comparison:
    """One quantity of one point, body or angle over a scene.

    Attributes:
        difference: largest difference of any component, and the `instant` (s) where it is.
        tolerance: what it was held to at that instant.
        share: largest difference / tolerance over all instants and components; it agrees up to 1.
        verdict: `not tested` where the tolerance rests on what one formulation claims of itself (see
            `tolerance`); `not given` where one of them gives no such numbers, and all numbers here are NaN.
        rests_on: the formulation whose claim makes the larger part of the widest tolerance, and `part` of it.
        place: where that is in a file of results, whose instants may be travels; empty of a scene's instants.
        telling: whether it would disagree if a solver gave back what it was given, where that is decided.
        why: it is not tested or not given; empty of a row that says something.
    """

    scene: str
    first: str
    second: str
    quantity: str
    name: str
    unit: str
    difference: float = math.nan
    tolerance: float = math.nan
    share: float = math.nan
    instant: float = math.nan
    verdict: Verdict = "not given"
    rests_on: str = ""
    part: float = math.nan
    place: str = ""
    telling: bool = True
    why: str = ""


@dataclass(frozen=True, repr=False)
class Outcome:
    """All comparisons of one scene and pair.

    Attributes:
        solutions: both solved scenes, for whoever wants to look further.
        notes: what the formulations said themselves of numbers without meaning, and what is wrong with
            what they gave.
        missing: what one formulation does not give, a line each.
        faults: what one gives that cannot be used, a line each, which are among the notes too.
        compared: at how many instants, of a file of results; None: at all that both give.
        factor: how many times the derived tolerance the differences were held to.
        explanations: what would explain that they disagree, the best first, where it was looked for.
    """

    scene: str
    rows: tuple[Comparison, ...]
    solutions: tuple[Solution, Solution]
    notes: tuple[str, ...]
    missing: tuple[str, ...]
    factor: float = 1.0
    explanations: tuple[Explanation, ...] = ()
    faults: tuple[str, ...] = ()
    compared: int | None = None

    @property
    def agreed(self) -> bool:
        """Whether every row agrees."""
        return all(row.verdict == "agrees" for row in self.rows)

    @property
    def stated(self) -> bool:
        """Whether one of them is held to an accuracy that it stated, and may give what it has."""
        return any(solution.accuracy.blind is not None for solution in self.solutions)

    @property
    def passed(self) -> bool:
        """Whether every row agrees; of a solver with a stated accuracy: something that tells, and nothing
        disagrees. What cannot be used of what is given is no agreement either way.
        """
        if self.faults or not self.stated:
            return self.agreed and not self.faults
        return not self.disagreements and any(row.verdict == "agrees" and row.telling for row in self.rows)

    @property
    def status(self) -> ExitStatus:
        """What it alone would end a run with."""
        if self.passed:
            return ExitStatus.AGREE
        return ExitStatus.DISAGREE if self.disagreements else ExitStatus.NO_VERDICT

    @property
    def counts(self) -> dict[str, int]:
        """How many rows have each verdict, and how many of those that agree tell nothing."""
        found = {verdict: sum(row.verdict == verdict for row in self.rows) for verdict in get_args(Verdict)}
        return found | {"given back": sum(row.verdict == "agrees" and not row.telling for row in self.rows)}

    @property
    def why_no_verdict(self) -> str:
        """Why it neither passes nor disagrees, in words; empty where it does, or where the rows say it."""
        if self.passed or self.disagreements:
            return ""
        if self.faults:
            return "something that is given cannot be used"
        if not self.stated:
            return ""
        if any(row.verdict == "agrees" for row in self.rows):
            return f"whatever agrees is what the solver was given: {GIVEN_BACK}"
        return "no number that is given is tested"

    def explained(self, row: Comparison) -> tuple[str, ...]:
        """What would explain that a row disagrees, the best first."""
        its = {row.quantity, f"{row.quantity}.{row.name}"}
        return tuple(one.words for one in self.explanations if its & {*one.quantities})

    @property
    def disagreements(self) -> tuple[Comparison, ...]:
        """The rows that do not."""
        return tuple(row for row in self.rows if row.verdict == "disagrees")

    @property
    def undecided(self) -> tuple[Comparison, ...]:
        """The rows of which nothing can be said: not tested, or not given."""
        return tuple(row for row in self.rows if row.verdict in ("not tested", "not given"))

    def __repr__(self) -> str:
        first, second = (solution.formulation for solution in self.solutions)
        verdicts = dict.fromkeys(row.verdict for row in self.rows)
        counts = ", ".join(f"{sum(row.verdict == v for row in self.rows)} {v}" for v in verdicts)
        return f"<Outcome of {self.scene!r}, {first} and {second}: {counts}>"

    def _repr_html_(self) -> str:
        """Every row, as a notebook shows it."""
        head = ("quantity", "name", "largest difference", "tolerance", "verdict")
        rows = (
            (
                row.quantity,
                row.name,
                *(f"{x:.1e} {row.unit}" for x in (row.difference, row.tolerance)),
                row.verdict,
            )
            for row in self.rows
        )
        return html_table(repr(self), head, rows)


def compare(
    scene: Scene,
    first: str | Formulation,
    second: str | Formulation,
    name: str | None = None,
    factor: float = 1.0,
) -> Outcome:
    """Solve a scene by two formulations and compare all that the scene asks for.

    Args:
        first, second: names of formulations, or formulations themselves.
        name: what to call the scene in the rows; its title if not given.
        factor: how many times the derived tolerance to hold differences to.
    Raises:
        FormulationError: one of them refuses the scene, or gives what is no solution.
        SceneError: the scene's own hardpoints make no mechanism.

    >>> compare(Scene.load("steer"), "pointcoord", "absolute").agreed
    True
    """
    one, two = (solved_by(formulation(f) if isinstance(f, str) else f, scene) for f in (first, second))
    return compare_solutions(scene, one, two, name or scene.title or "scene", factor=factor)


def solved_by(solver: Formulation, scene: Scene) -> Solution:
    """A scene's solution by a formulation.

    Raises:
        FormulationError: it refuses the scene, or gives what is no solution.
        SceneError: the scene is none, or its own hardpoints make no mechanism.
    """
    require_scene(scene)
    try:
        solution = solver.solve(scene)
    except AccuracyError as error:
        raise FormulationError(solver.name, error) from error
    if not isinstance(solution, Solution):
        problem = TypeError(f"it gives a {type(solution).__name__}; needed: a Solution")
        raise FormulationError(solver.name, problem)
    return solution


def compare_solutions(
    scene: Scene,
    one: Solution,
    two: Solution,
    name: str,
    asked: Mapping[str, Sequence[str]] | None = None,
    factor: float = 1.0,
) -> Outcome:
    """Compare two solved scenes.

    Args:
        asked: names to compare by quantity, if these are not all that the scene asks for.
        factor: how many times the derived tolerance to hold differences to; a tolerance that tests nothing
            (see `tolerance.untested`) tests nothing either way.
    Raises:
        FormulationError: one of them does not say at which instants its numbers are.
    """
    instants, first, second = given_by_both(one, two, scene.instants)
    faults = tuple(dict.fromkeys((*first.faults, *second.faults)))
    notes = tuple(dict.fromkeys((*one.notes, *two.notes, *first.notes, *second.notes, *faults)))
    rows: list[Comparison] = []
    missing: list[str] = []
    for quantity, names in (asked_numbers(scene) if asked is None else asked).items():
        parts = _parts(quantity, names, first, second)
        lacking = dict(_missing(quantity, parts, first, second))
        missing += lacking
        pair = Pair(quantity, (first, second), factor)
        for part in parts:
            rows.append(_reasoned(_row(name, part, pair, instants, scene), lacking, notes, faults))
    return Outcome(name, tuple(rows), (one, two), notes, tuple(missing), factor, faults=faults)


def _parts(quantity: str, asked: Sequence[str], one: Solution, two: Solution) -> list[str]:
    """Every point, body or angle that the scene asks for, and whatever else both give."""
    both = (name for name in one.numbers[quantity] if name in two.numbers[quantity])
    return list(dict.fromkeys((*asked, *both)))


def _missing(
    quantity: str, parts: Sequence[str], one: Solution, two: Solution
) -> Iterator[tuple[str, Sequence[str]]]:
    """Lines on what one of them does not give, each with the names that it is about."""
    words = QUANTITIES[quantity].words
    for side in (one, two):
        lacking = [part for part in parts if part not in side.numbers[quantity]]
        if lacking and not side.numbers[quantity]:
            yield f"{side.formulation} gives no {words}", lacking
        elif lacking:
            yield f"{side.formulation} gives no {words} of {', '.join(lacking)}", lacking
        for name in side.numbers[quantity]:
            near = "" if name in parts else nearest(name, lacking)
            if near:
                line = f"{side.formulation} gives {words} of {shown(name)}, which is left out"
                yield f"{line} (did you mean {near!r}?)", [near]


def _reasoned(
    row: Comparison, lacking: Mapping[str, Sequence[str]], notes: Sequence[str], faults: Sequence[str]
) -> Comparison:
    """A row that says nothing, with the reason.

    Args:
        lacking: lines on what is not given, with the names that each is about. notes, faults: of the outcome.
    """
    about = f": {QUANTITIES[row.quantity].words} of {row.name}"
    if row.verdict == "not given":
        found = (
            [fault for fault in faults if f"{about} " in fault][:1]
            or [line for line, names in lacking.items() if row.name in names]
            or notes
            or ["it is given at no instant of the scene"]
        )
    elif row.verdict == "not tested":
        wide = (
            f"the tolerance rests on the error bound of {row.rests_on}, and is too wide to test the other one"
        )
        found = [note for note in notes if f"{about}: its accuracy " in note] or [wide]
    else:
        return row
    return replace(row, why="; ".join(found))


def _row(name: str, part: str, pair: Pair, instants: Array, scene: Scene) -> Comparison:
    """The comparison of a point, body or angle at instants, (N,), s."""
    who, unit = [side.formulation for side in pair.sides], QUANTITIES[pair.quantity].unit
    row = Comparison(name, who[0], who[1], pair.quantity, part, unit)
    if part not in pair.names:
        return row
    held = pair.held(part)
    share = float(held.share.max())
    worst, widest = (np.unravel_index(np.argmax(of), of.shape) for of in (held.gap, held.allowed))
    verdict: Verdict = "agrees"
    if not held.claimed:
        verdict = "not tested"
    elif share > 1.0:
        verdict = "disagrees"
    elif (pair.wide(held) & (held.gap.max(axis=-1) > SMALLEST)).any():
        verdict = "not tested"
    larger = int(held.claims[1][widest] > held.claims[0][widest])
    return replace(
        row,
        difference=float(held.gap[worst]),
        tolerance=float(held.allowed[worst]),
        share=share,
        instant=float(instants[worst[0]]),
        verdict=verdict,
        rests_on=who[larger],
        part=float(pair.factor * held.claims[larger][widest] / (held.allowed[widest] + SMALLEST)),
        # Decided only where one of them may give what it has: else every row has to agree.
        telling=verdict != "agrees" or pair.tells(scene, held),
    )
