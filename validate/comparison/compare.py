"""Compares two formulations on one scene: the largest difference of every quantity, and its tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from pointcoord.results.named_columns import html_table
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene
from validate.arrays import Array
from validate.comparison.given import given_by_both
from validate.comparison.pair import SMALLEST, Pair
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import AccuracyError, Formulation, FormulationError, Solution
from validate.formulations.registry import formulation

GIVEN_BACK = "points of the chassis, or points that stay where they are drawn"
Verdict = Literal["agrees", "disagrees", "not tested", "not given"]


@dataclass(frozen=True)
class Explanation:
    """A possible explanation of a disagreement, found by `diagnosis`.

    Attributes:
        words: the numbers that it explains, and their fault.
        kind: kind of fault, by its name in `diagnosis.kinds`; two kinds are joined by "and".
        quantities: what it explains. The name of a quantity if it explains all numbers of the quantity that
            disagree and makes none disagree that agrees; otherwise quantity.name.
        leftover: largest difference / tolerance after the fault is corrected.
    """

    words: str
    kind: str
    quantities: tuple[str, ...]
    leftover: float


@dataclass(frozen=True)
class Comparison:
    """One quantity of one point, body or angle over a scene.

    Attributes:
        difference: largest difference of any component; `instant` is where it occurs, s.
        tolerance: the tolerance of this difference, at this instant.
        share: largest share of its tolerance, difference / tolerance, over all instants and components; the
            row agrees if it is at most 1.
        verdict: `not tested` if the error bound of one formulation makes the tolerance too wide (see
            `Pair.wide`); `not given` if one formulation gives no such numbers: all numbers here are NaN.
        rests_on: the formulation that limits: its error bound is the larger part of the widest tolerance.
        part: that error bound / the widest tolerance.
        place: the place of the difference in a file of results, whose rows may be travels; empty for a scene.
        telling: whether the row would disagree if a solver gave back the points that it was given. True
            where this is not examined.
        why: the reason for `not tested` or `not given`; empty for the other verdicts.
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
        solutions: the solutions of both formulations.
        notes: remarks of the formulations on numbers without meaning, and what is wrong with their numbers.
        missing: one line for each kind of number that one formulation does not give.
        faults: one line for each part of a solution that cannot be used; the notes repeat these lines.
        compared: number of instants that both give, or of rows compared, for a file of results.
        factor: factor on the derived tolerances.
        explanations: possible explanations of the disagreements, the best first; empty if not searched for.
    """

    scene: str
    rows: tuple[Comparison, ...]
    solutions: tuple[Solution, Solution]
    notes: tuple[str, ...]
    missing: tuple[str, ...]
    compared: int
    factor: float = 1.0
    explanations: tuple[Explanation, ...] = ()
    faults: tuple[str, ...] = ()

    @property
    def agreed(self) -> bool:
        """Whether every row agrees."""
        return all(row.verdict == "agrees" for row in self.rows)

    @property
    def stated(self) -> bool:
        """Whether one of them stated an accuracy beforehand; it may then give only part of the numbers."""
        return any(solution.accuracy.blind is not None for solution in self.solutions)

    @property
    def passed(self) -> bool:
        """Whether every row agrees. With a stated accuracy: whether a telling row agrees and none disagrees.

        Data that cannot be used never pass.
        """
        if self.faults or not self.stated:
            return self.agreed and not self.faults
        return not self.disagreements and any(row.verdict == "agrees" and row.telling for row in self.rows)

    @property
    def status(self) -> ExitStatus:
        """The exit status of a run of this comparison alone."""
        if self.passed:
            return ExitStatus.AGREE
        return ExitStatus.DISAGREE if self.disagreements else ExitStatus.NO_VERDICT

    @property
    def counts(self) -> dict[str, int]:
        """Number of rows with each verdict; `given back`: the rows that agree but are not telling."""
        found = {verdict: sum(row.verdict == verdict for row in self.rows) for verdict in get_args(Verdict)}
        return found | {"given back": sum(row.verdict == "agrees" and not row.telling for row in self.rows)}

    @property
    def why_no_verdict(self) -> str:
        """Why the comparison neither passes nor disagrees; empty if it does, or if the rows state why."""
        if self.passed or self.disagreements:
            return ""
        if self.faults:
            return "some of the numbers given cannot be used"
        if not self.stated:
            return ""
        if any(row.verdict == "agrees" for row in self.rows):
            return f"all numbers that agree were given to the solver: {GIVEN_BACK}"
        if all(row.verdict == "not given" for row in self.rows):
            return "no number is given"
        return "none of the numbers given is tested"

    def explained(self, row: Comparison) -> tuple[str, ...]:
        """Possible explanations of the disagreement of a row, the best first."""
        its = {row.quantity, f"{row.quantity}.{row.name}"}
        return tuple(one.words for one in self.explanations if its & {*one.quantities})

    @property
    def disagreements(self) -> tuple[Comparison, ...]:
        """The rows that disagree."""
        return tuple(row for row in self.rows if row.verdict == "disagrees")

    @property
    def undecided(self) -> tuple[Comparison, ...]:
        """The rows without a verdict: not tested, or not given."""
        return tuple(row for row in self.rows if row.verdict in ("not tested", "not given"))

    def __repr__(self) -> str:
        first, second = (solution.formulation for solution in self.solutions)
        verdicts = dict.fromkeys(row.verdict for row in self.rows)
        counts = ", ".join(f"{self.counts[verdict]} {verdict}" for verdict in verdicts)
        return f"<Outcome of {self.scene!r}, {first} and {second}: {counts}>"

    def _repr_html_(self) -> str:
        """A table of all rows, for notebooks."""
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
    first: str | Formulation | Solution,
    second: str | Formulation | Solution,
    name: str | None = None,
    factor: float = 1.0,
) -> Outcome:
    """Solve a scene by two formulations and compare all numbers that the scene asks for.

    Args:
        first, second: names of formulations, formulations, or solutions of the scene.
        name: name of the scene in the rows; its title if not given.
        factor: factor on the derived tolerances.
    Raises:
        FormulationError: one of them refuses the scene, or does not return a `Solution`.
        SceneError: the hardpoints of the scene do not form a mechanism.

    >>> compare(Scene.load("steer"), "pointcoord", "absolute").agreed
    True
    """
    one, two = (
        f if isinstance(f, Solution) else solved_by(formulation(f) if isinstance(f, str) else f, scene)
        for f in (first, second)
    )
    return compare_solutions(scene, one, two, name or scene.title or "scene", factor=factor)


def solved_by(solver: Formulation, scene: Scene) -> Solution:
    """The solution of a scene by a formulation.

    Raises:
        FormulationError: the formulation refuses the scene, or does not return a `Solution`.
        SceneError: `scene` is not a scene, or its hardpoints do not form a mechanism.
    """
    require_scene(scene)
    try:
        solution = solver.solve(scene)
    except AccuracyError as error:
        raise FormulationError(solver.name, error) from error
    if not isinstance(solution, Solution):
        problem = TypeError(f"it returns an object of type {type(solution).__name__}; needed: a Solution")
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
        asked: names to compare, by quantity; all that the scene asks for if not given.
        factor: factor on the derived tolerances. It does not change which tolerances are too wide to test
            anything (see `Pair.wide`).
    Raises:
        FormulationError: one of them does not give the instants of its numbers.
    """
    instants, first, second = given_by_both(one, two, scene.instants)
    faults = tuple(dict.fromkeys((*first.faults, *second.faults)))
    notes = tuple(dict.fromkeys((*one.notes, *two.notes, *first.notes, *second.notes, *faults)))
    rows: list[Comparison] = []
    missing: list[str] = []
    for quantity, names in (asked_numbers(scene) if asked is None else asked).items():
        both = (part for part in first.numbers[quantity] if part in second.numbers[quantity])
        parts = dict.fromkeys((*names, *both))
        absent = _missing(quantity, parts, (first, second))
        missing += absent
        pair = Pair(quantity, (first, second), factor)
        for part in parts:
            rows.append(_reasoned(_row(name, part, pair, instants, scene), absent, notes, faults))
    return Outcome(name, tuple(rows), (one, two), notes, tuple(missing), len(instants), factor, faults=faults)


def _missing(quantity: str, parts: Iterable[str], sides: Iterable[Solution]) -> dict[str, list[str]]:
    """One line for each kind of number that a solution does not give, with the names that are missing."""
    lines = {}
    for side in sides:
        given = side.numbers[quantity]
        if absent := [part for part in parts if part not in given]:
            of = f" of {', '.join(absent)}" if given else ""
            lines[f"{side.formulation} gives no {QUANTITIES[quantity].words}{of}"] = absent
    return lines


def _reasoned(
    row: Comparison, absent: Mapping[str, Sequence[str]], notes: Sequence[str], faults: Sequence[str]
) -> Comparison:
    """Adds the reason to a row that is not tested or not given.

    Args:
        absent: lines on numbers that are not given, each with their names.
        notes, faults: notes and faults of the outcome.
    """
    about = f": {QUANTITIES[row.quantity].words} of {row.name}"
    if row.verdict == "not given":
        lost = [fault for fault in faults if f"{about} " in fault][:1]
        lost = lost or [line for line, names in absent.items() if row.name in names]
        why = "; ".join(lost or notes) or "no instant of the scene has a number"
    elif row.verdict == "not tested":
        wide = f"the tolerance is limited by the error bound of {row.rests_on}"
        found = [note for note in notes if f"{about}: its accuracy " in note]
        why = "; ".join(found) or f"{wide}; it is too wide to test the other"
    else:
        why = ""
    return replace(row, why=why)


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
        # Matters only if one of them may give part of the numbers; otherwise every row must agree.
        telling=verdict != "agrees" or pair.tells(scene, held),
    )
