"""Printed tables of other programs, and the difference of each of our two models from every column.

This folder contains the printed numbers, their source, and the licence of the source. Most columns are one of
our numbers, the others have a rule. A table lists the columns for which no rule is known.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import nan
from pathlib import Path

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES, number_called
from pointcoord.scene.input_part import InputPart
from validate.arrays import Array
from validate.comparison.compare import Comparison, Outcome
from validate.comparison.pair import SMALLEST
from validate.formulations.protocol import Accuracy, Solution
from validate.formulations.registry import formulation
from validate.measured.reading import Columns, read_columns
from validate.tables.errors import FileError
from validate.tables.units import factor_of

FOLDER = Path(__file__).parent
MODELS = ("pointcoord", "absolute")
NOT_HELD = "rule not known"


@dataclass(frozen=True)
class Table:
    """A printed table; `tables.toml` explains its entries.

    Attributes:
        name: name of its file in the folder. title: heading for the reader.
    """

    name: str
    title: str
    scene: str
    drives: str
    columns: Mapping[str, str]
    source: str
    licence: str
    note: str = ""
    left_out: str = ""
    accuracy: Mapping[str, float] = field(default_factory=dict)
    open: Mapping[str, str] = field(default_factory=dict)

    def scene_over(self, printed: Columns) -> Scene:
        """The car with the driven input of the first column; the instants are the table's rows.

        Raises:
            FileError: the rows are not in even steps.
        """
        beside = FOLDER / f"{self.scene}.toml"
        scene, over = Scene.load(beside if beside.exists() else self.scene), printed.values[0]
        per = _factor(printed.units[0], scene.mechanism.topology.input_units[self.drives])
        ends = {"start": float(over[0]), "stop": float(over[-1]), "samples": len(over)}
        inputs = scene.inputs | {self.drives: InputPart(polynomial=(0.0, per))}
        time = scene.time.model_copy(update=ends)
        there = scene.model_copy(update={"time": time, "inputs": inputs})
        # Instants are interpolated from the end values, so their rounding differs from the table's.
        if np.abs(there.instants - over).max() > 1e-14 * np.abs(over).max():
            raise FileError(printed.source, printed.names[0], "is not in even steps", "rows in even steps")
        return there


def tables() -> tuple[Table, ...]:
    """Every table, in the order of `tables.toml`."""
    known = tomllib.loads((FOLDER / "tables.toml").read_text(encoding="utf-8"))
    return tuple(Table(name, **about) for name, about in known.items())


@dataclass(frozen=True)
class Solved:
    """A car at the rows of a table, as one formulation solves it.

    Attributes:
        numbers: numbers of the car, (N,), and places of points, (N, 3), by their names; rad and mm.
        over: the first column.
    """

    scene: Scene
    numbers: Mapping[str, Array]
    over: Array

    @classmethod
    def of(cls, scene: Scene, solution: Solution, over: Array) -> Solved:
        """The car of a solution."""
        named = {q: n for q, n in solution.numbers.items() if q == "position" or QUANTITIES[q].of == "car"}
        return cls(scene, {name: array for of in named.values() for name, array in of.items()}, over)

    @property
    def damper_drawn(self) -> float:
        """The drawn length of the damper, mm."""
        part = self.scene.mechanism
        first, second = (np.array(part.points[name]) for name in part.structure.roles["damper"])
        return float(np.linalg.norm(second - first))

    @property
    def outward(self) -> Array:
        """How far the wheel centre has moved outboard, (N,), mm."""
        part = self.scene.mechanism
        centre = part.topology.wheel_centre
        return np.asarray((self.numbers[centre] - np.array(part.points[centre])) @ part.outboard)


Rule = tuple[str, str, Callable[[Solved], Array]]
"""The rule of a printed column: the kind of number (see `QUANTITIES`), its unit, and the column, (N,); NaN
where it does not exist."""
LENGTH = "dimension", "mm"
RULES: Mapping[str, Rule] = {
    # Wheel over damper, by the travel of the contact point: -dz_c / dl.
    "damper_ratio": (
        *("dimension_gradient", "mm/mm"),
        lambda car: -car.numbers["contact_travel_by_travel"] / car.numbers["damper_length_by_travel"],
    ),
    # The damper's length minus its drawn length.
    "damper_travel": (*LENGTH, lambda car: car.numbers["damper_length"] - car.damper_drawn),
    # Of a front axle.
    "wheelbase_change": (*LENGTH, lambda car: -car.numbers["recession"]),
    # At right angles to the steering axis in side view.
    "trail_at_the_axis": (
        *LENGTH,
        lambda car: car.numbers["castor_offset"] * np.cos(car.numbers["caster"]),
    ),
    "roll_centre_to_body": (
        *LENGTH,
        lambda car: car.numbers["roll_centre_height"] + car.numbers["contact_travel"],
    ),
    "wheel_centre_outward": (*LENGTH, lambda car: car.outward),
    # The turning radius, printed as 0 straight ahead.
    "turning_circle": (
        *LENGTH,
        lambda car: np.where(car.over == 0.0, 0.0, car.numbers["turning_radius"]),
    ),
}
"""Columns that are not simply one of our numbers; each rule was found by reproducing the printed numbers."""


def rule_of(name: str) -> Rule:
    """The rule of a name: one of our numbers unchanged, or one of `RULES`."""
    if name in RULES:
        return RULES[name]
    number = number_called(name)
    assert number is not None  # a table names what there is
    return number.quantity.name, number.quantity.unit, lambda car: car.numbers[name]


@dataclass(frozen=True)
class Column:
    """A printed column and our values.

    Attributes:
        name, unit: as printed. per: size of this unit in our unit.
        printed: (N,), in our unit. ours: the same from each model.
        rows: the comparison with each model. open: why the column is not judged; empty if it is judged.
    """

    name: str
    unit: str
    per: float
    printed: Array
    ours: tuple[Array, ...]
    rows: tuple[Comparison, ...]
    open: str

    @property
    def verdict(self) -> str:
        """The common verdict of both models."""
        if self.open:
            return NOT_HELD
        return "disagrees" if any(row.verdict == "disagrees" for row in self.rows) else "agrees"


@dataclass(frozen=True)
class Published:
    """A printed table and the results of the car at the same rows.

    Attributes:
        over: the first column, with its unit. at: its rows, (N,).
        columns: the other columns. outcomes: the comparison with each model, of the columns that are judged.
    """

    table: Table
    over: str
    at: Array
    columns: tuple[Column, ...]
    outcomes: tuple[Outcome, ...]

    @property
    def agreed(self) -> bool:
        """Whether both models give every number to its last digit."""
        return all(outcome.agreed for outcome in self.outcomes)


def compare_published() -> tuple[Published, ...]:
    """Every table beside both models; raises what `compare_table` does."""
    return tuple(map(compare_table, tables()))


def compare_table(table: Table) -> Published:
    """Compare a table with both models, to its own printed digits.

    Raises:
        FormulationError: a model refuses the car; MissingLibrary: it is not installed.
        FileError: the table's rows are not in even steps.
    """
    printed = read_columns(str(FOLDER / f"{table.name}.csv"))
    scene, over = table.scene_over(printed), printed.values[0]
    solutions = [formulation(name).solve(scene) for name in MODELS]
    solved = [Solved.of(scene, solution, over) for solution in solutions]
    columns = tuple(_column(table, printed, i, solutions, solved) for i in range(1, len(printed.names)))
    told = [f"{one.name} is not judged: {one.open}" for one in columns if one.open]
    notes = tuple(note for note in (table.note, *told) if note)
    theirs = Solution(table.title, over, {}, Accuracy(np.ones(len(over))))
    outcomes = tuple(
        Outcome(table.name, rows, (theirs, solution), notes, (), len(over))
        for k, solution in enumerate(solutions)
        for rows in [tuple(one.rows[k] for one in columns if not one.open)]
    )
    return Published(table, f"{printed.names[0]} [{printed.units[0]}]", over, columns, outcomes)


def _column(
    table: Table, printed: Columns, i: int, solutions: Sequence[Solution], solved: Sequence[Solved]
) -> Column:
    """Compare a printed column with both models.

    Allowed is half a unit of the last printed digit, plus the stated error of the table's own program, plus
    the error bound that a model gives for a number. For a rule no bound is added: a model's rounding is
    negligible beside printed digits, and a table in full precision has a stated accuracy.
    """
    name, unit, over = printed.names[i], printed.units[i], printed.values[0]
    what = table.columns[name]
    quantity, our_unit, rule = rule_of(what)
    per = _factor(unit, our_unit)
    theirs = per * printed.values[i]
    off = per * (0.5 * printed.steps[i] + table.accuracy.get(name, 0.0))
    ours = tuple(map(rule, solved))
    rows = []
    for values, solution in zip(ours, solutions, strict=True):
        gap = np.abs(values - theirs)
        # A value that does not exist is no difference if the rule is not known, else an infinite one.
        gap[np.isnan(gap)] = 0.0 if name in table.open else np.inf
        allowed = off + solution.accuracy.claims.get(quantity, {}).get(what, 0.0)
        share = gap / (allowed + SMALLEST)
        worst = int(np.argmax(share))
        rows.append(
            Comparison(
                scene=table.name,
                first=table.title,
                second=solution.formulation,
                quantity=quantity,
                name=what,
                unit=our_unit,
                difference=float(gap[worst]),
                tolerance=float(allowed[worst]),
                share=float(share[worst]),
                instant=float(over[worst]),
                verdict="agrees" if share[worst] <= 1.0 else "disagrees",
                rests_on=table.title,
                part=float(off[worst] / allowed[worst]),
                place=f"{printed.names[0]} {over[worst]:g} {printed.units[0]}",
            )
        )
    return Column(name, unit, per, theirs, ours, tuple(rows), table.open.get(name, ""))


def _factor(unit: str, ours: str) -> float:
    """Size of a table's unit in our unit; NaN, which agrees with nothing, if it is not such a unit."""
    factor = 1.0 if unit == ours else factor_of(unit, ours)
    return nan if factor is None else factor
