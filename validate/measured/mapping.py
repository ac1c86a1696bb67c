"""The meaning of each column of a file: from its name, or from a map that the user writes.

A map is TOML:

    rolling_radius = 270.0        # mm; for travel.contact only
    convention = "adams"          # definitions of the names: adams, optimumk, lotus; the scene's if not given

    [held]                        # inputs with one value in every row; other inputs are as drawn
    rack = 0.0

    [columns.camber]              # by the name in the file
    is = "wheel.camber"           # time, input.NAME, travel.POINT or .contact, QUANTITY.NAME[.AXIS], ignore
    unit = "deg"                  # if the file does not give it
    sign = -1                     # ours = sign * theirs + offset, the offset in the column's unit
    offset = 0.0
    printed = 0.0001              # unit of the last digit, in the column's unit; 0: written in full or exact
    accuracy = 0.001              # error of its numbers in addition to rounding, in the column's unit

Columns that a map does not name are recognised by their names if the file gives their unit and no other
column has the same meaning. The pose of a row is given by time, if there is such a column, or else by a
travel and inputs; other columns of these kinds are ignored.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from textwrap import fill
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from pointcoord import Scene, SceneError
from pointcoord.effects.numbers import ConventionName, meant_by
from pointcoord.mechanism.faults import fault_of, known_keys
from pointcoord.toml_text import parsed, read_file
from pointcoord.wording import meant, shown_key
from validate.arrays import Array, Flags
from validate.measured.meanings import (
    CONTACT,
    IGNORE,
    INPUT,
    NUMBER,
    TIME,
    TRAVEL,
    Meaning,
    meanings_of,
    named,
    some_meanings,
)
from validate.measured.reading import Columns, read_columns
from validate.plain_text import gathered, shown
from validate.tables.errors import FileError
from validate.tables.units import allowed_units, factor_of
from validate.toml_written import key_of, value_of

# Upper limit of numbers in our units: squares and cubes of larger ones might overflow.
FARTHEST = 1e100
# Least number of values to decide that a column is in even steps: two values always are.
FEWEST = 3
BY_CHANCE = 1e-3  # steps that are equal to this share of a step or a last digit are not so by chance

Number = Annotated[float, Field(strict=True, ge=-FARTHEST, le=FARTHEST)]
Size = Annotated[Number, Field(ge=0.0)]


class _Said(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _known(cls, content: object) -> object:
        return known_keys(content, [key.alias or name for name, key in cls.model_fields.items()])


class ColumnSaid(_Said):
    """The entries of a column in a map, see the top of this file; None if not given."""

    is_: str | None = Field(default=None, alias="is")
    unit: str | None = None
    sign: Literal[1, -1] | None = None
    offset: Number = 0.0
    printed: Size | None = None
    accuracy: Size | None = None


class MapSaid(_Said):
    """The content of a map, see the top of this file."""

    rolling_radius: Annotated[Number, Field(gt=0.0)] | None = None
    convention: ConventionName | None = None
    held: dict[str, Number] = {}  # inputs and travels with one value in every row, in our units
    columns: dict[str, ColumnSaid] = {}


@dataclass(frozen=True)
class Series:
    """A column in our units.

    Attributes:
        column: its name in the file. meaning: its meaning.
        values: (N,), NaN for no number.
        off: rounding error of the values, half a unit of the last digit, (N,).
        unit: its unit in the file. factor: this unit in our unit.
        said: its entry in the map.
    """

    column: str
    meaning: Meaning
    values: Array
    off: Array
    unit: str
    factor: float
    said: ColumnSaid

    @property
    def rounded_unasked(self) -> bool:
        """Whether it is taken as rounded although the map does not say so."""
        return self.said.printed is None and bool(self.off.any())

    @property
    def set_exactly(self) -> bool:
        """Whether its values are in even steps, as set values are, unlike measured ones.

        Programs omit trailing zeros: -30 may stand for -30.0000000000 next to -26.6666666667, although it
        seems to be rounded most. Rounded values are in even steps only by chance.
        """
        there = np.isfinite(self.values)
        values = np.unique(self.values[there])
        if not self.rounded_unasked or len(values) < FEWEST:
            return False
        steps = np.diff(values)
        return bool(np.ptp(steps) <= BY_CHANCE * min(float(self.off[there].max()), float(steps.min())))

    def apart(self, ours: Array, theirs: Array) -> Array:
        """The difference `ours - theirs`; for angles without whole turns."""
        gap, turn = ours - theirs, 2.0 * math.pi
        return gap - turn * np.rint(gap / turn) if self.meaning.unit == "rad" else gap

    def accuracy_or(self, accuracy: float) -> float:
        """The error of its numbers in addition to rounding, in our unit: from the map, or else `accuracy`."""
        return self.factor * (accuracy if self.said.accuracy is None else self.said.accuracy)


@dataclass(frozen=True)
class Measured:
    """A file of results, with the meaning of its columns.

    Attributes:
        source: the file.
        independent: the independent columns: time, a travel and inputs, or inputs.
        numbers: the columns to compare.
        said: the map.
        rows: name of each row.
        notes: remarks on columns and rows that were left out.
    """

    source: str
    independent: tuple[Series, ...]
    numbers: tuple[Series, ...]
    said: MapSaid
    rows: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def instants(self) -> Array:
        """Values of the independent column, (N,); indices of rows if there are several."""
        one, *others = self.independent
        return np.arange(len(self.rows), dtype=float) if others else one.values


def read_results(file: str, map: str | None, scene: Scene) -> Measured:
    """Read a file of results for a scene's car.

    Args:
        map: file that describes the columns; None if the columns have our names.
    Raises:
        FileError: the file or the map is wrong, or nothing in the file can be compared.
        MissingLibrary: Parquet needs pyarrow.
    """
    columns = read_columns(file)
    if map is None:
        return understood(columns, {}, scene, columns.source)
    try:
        content = parsed(read_file(map, "the path of a map of columns (TOML)"), shown(map))
    except SceneError as error:
        raise FileError(shown(map), error.key, error.problem, error.allowed or "TOML") from None
    return understood(columns, content, scene, shown(map))


def understood(columns: Columns, content: Mapping[str, Any], scene: Scene, where: str) -> Measured:
    """Find the meaning of columns, with a map as plain data.

    Args:
        where: name of the map in messages.
    Raises:
        FileError: see `read_results`.
    """
    source, topology = columns.source, scene.mechanism.topology
    said = _map_said(content, columns, scene, where)
    meant_as = _meant_as(columns, said, scene, where)
    found = [
        _series(columns, i, *one, said.columns.get(name, ColumnSaid()), where)
        for i, (name, one) in enumerate(meant_as.items())
        if one is not None
    ]
    for words, some in gathered((s.meaning.words, s.column) for s in found).items():
        if some[1:]:
            raise FileError(where, "columns", f"{listed(some)} are each {words}", "one column for each")
    out = [name for name, one in meant_as.items() if one is None]
    ignored = f"; ignored: {listed(out)}" if out else ""
    times, heights, inputs, numbers = (
        [s for s in found if s.meaning.kind == kind] for kind in (TIME, TRAVEL, INPUT, NUMBER)
    )
    over = times or [*heights, *inputs]
    travels = [*(s.column for s in heights), *(name for name in said.held if name not in topology.inputs)]
    if travels[1:] and not times:
        problem = f"each of {listed(travels)} could give the pose of a row"
        raise FileError(where, "columns", problem, f'is = "{IGNORE}" for all but one')
    if not (over and numbers):
        problem = "has no numbers to compare" if over else "no column gives the pose of a row"
        allowed = f"columns called {some_meanings(topology)}, or a map of them (--map)"
        raise FileError(source, "names of the columns", problem + ignored, allowed)
    there: Flags = np.asarray(np.isfinite([s.values for s in over]).all(axis=0))
    if not there.any():
        raise FileError(source, "", "no row gives its pose", "at least one row with its pose")
    notes = list[str]()
    if out:
        notes.append(f"ignored: {listed(out)} (name not recognised, without a unit, or as the map says)")
    if even := [s.column for s in over if s.set_exactly]:
        steps = "in even steps, taken as exact; if rounded, give its printed = STEP in a map"
        notes.append(f"{listed(even)}: {steps}")
    if times and (unused := [s.column for s in (*heights, *inputs)]):
        notes.append(f"{listed(unused)} not used: the pose of a row is given by {shown(times[0].column)}")
    for s in numbers:
        if lacking := int(np.isnan(s.values).sum()):
            notes.append(f"{shown(s.column)} has no number in {lacking} of {len(s.values)} rows")
    if lost := [row for row, is_there in zip(columns.rows, there, strict=True) if not is_there]:
        notes.append(f"{len(lost)} rows do not give their pose and are left out, the first: {lost[0]}")

    def kept(s: Series) -> Series:
        return replace(s, values=s.values[there], off=s.off[there] * (s.column not in even))

    return Measured(
        source=source,
        independent=tuple(map(kept, over)),
        numbers=tuple(map(kept, numbers)),
        said=said,
        rows=tuple(np.array(columns.rows)[there].tolist()),
        notes=tuple(notes),
    )


def map_to_fill_in(file: str, scene: Scene) -> str:
    """The text of a map (TOML) to fill in for a file of results, with the recognised columns filled in.

    Raises:
        FileError: the file cannot be read.
        MissingLibrary: Parquet needs pyarrow.
    """
    columns, meanings = read_columns(file), f"is: {some_meanings(scene.mechanism.topology)}"
    lines = [
        f"# The columns of {columns.source}. Fill in what is missing, and remove the #.",
        fill(meanings, 100, initial_indent="# ", subsequent_indent="#     "),
        "# unit: mm, deg, rad, s and so on. Further keys: sign = -1, offset = 0.5, accuracy = 0.001,",
        "#     printed = 0.01 (the unit of the last digit; 0: exact as written)",
        f"# rolling_radius = 300.0    # mm, of travel.{CONTACT}",
        "",
        "[columns]",
    ]
    found = _meant_as(columns, MapSaid(), scene, "")
    for (name, one), unit in zip(found.items(), columns.units, strict=True):
        entry = {"is": one[0].words if one else "", "unit": shown(unit)}
        lines.append(f"{'' if all(entry.values()) else '# '}{key_of(shown(name))} = {value_of(entry)}")
    return "\n".join(lines) + "\n"


def listed(names: Iterable[str]) -> str:
    """Names from a file for a message, long ones shortened."""
    return ", ".join(shown(shown_key(name)) for name in names)


def _map_said(content: Mapping[str, Any], columns: Columns, scene: Scene, where: str) -> MapSaid:
    """A map from plain data, checked to name only columns of the file, and inputs and travels of the car."""
    try:
        said = MapSaid.model_validate(content)
    except ValidationError as error:
        fault = fault_of(error)
        raise FileError(where, ".".join(map(str, fault.place)), fault.problem, fault.allowed) from None
    topology = scene.mechanism.topology
    travels = [words for words, one in meanings_of(topology).items() if one.kind == TRAVEL]
    for place, given, known in (
        ("columns", said.columns, columns.names),
        ("held", said.held, (*topology.inputs, *travels)),
    ):
        for name in given:
            if name not in known:
                problem = f"{shown(name)!r} does not exist{meant(name, known)}"
                raise FileError(where, place, problem, ", ".join(known))
    return said


def _meant_as(
    columns: Columns, said: MapSaid, scene: Scene, where: str
) -> dict[str, tuple[Meaning, int] | None]:
    """The meaning and sign of each column; None for a column that is left out.

    The sign is from the map, from a minus before the name, or from the convention.

    Raises:
        FileError: the map gives an unknown meaning.
    """
    topology, convention = scene.mechanism.topology, said.convention or scene.convention
    meanings = meanings_of(topology)

    def meant_by_column(name: str) -> tuple[Meaning, int] | None:
        part = said.columns.get(name, ColumnSaid())
        words = name.removeprefix("-") if part.is_ is None else part.is_
        one, sign = named(words, meanings), 1
        # Names other than our full names are read by the convention.
        if one is not None and one.kind == NUMBER and words not in meanings:
            ours, sign = meant_by(one.name, convention)
            one = one if ours == one.name else named(ours, meanings)
        if one is None:
            if part.is_ in (None, IGNORE):
                return None
            near = meant(words, (*meanings, *(full.partition(".")[2] for full in meanings)))
            problem = f"nothing is called {shown(words)!r}{near}"
            raise FileError(where, f"columns.{name}.is", problem, some_meanings(topology))
        if part.is_ is None and name.startswith("-"):
            sign = -1
        return one, part.sign or sign

    found = {name: meant_by_column(name) for name in columns.names}
    taken = [one[0] for name in said.columns if (one := found[name])]
    for name, unit in zip(columns.names, columns.units, strict=True):
        # Next to a map, a column that it does not name needs a unit and a meaning that no other column has.
        if said.columns and name not in said.columns and (one := found[name]):
            found[name] = one if unit and one[0] not in taken else None
    return found


def _series(columns: Columns, at: int, meaning: Meaning, sign: int, part: ColumnSaid, where: str) -> Series:
    """A column in our units.

    Args:
        at: its number in the file. part: its entry in the map.
    """
    name, source, words = columns.names[at], columns.source, meaning.words
    column = f"column {shown(name)!r}"
    if holds := columns.words.get(name):
        raise FileError(
            source, column, f"contains {holds}", f'columns of numbers, or is = "{IGNORE}" in a map'
        )
    unit = columns.units[at] if part.unit is None else part.unit
    factor = factor_of(unit, meaning.unit) if unit else None
    if factor is None:
        problem = "its unit is not given, neither after its name nor in a map"
        problem = f"{shown(unit)!r} is not a unit of {words}" if unit else problem
        wrong = (source, column) if part.unit is None else (where, f"columns.{name}.unit")
        raise FileError(*wrong, problem, allowed_units(meaning.unit))
    with np.errstate(over="ignore"):
        values = factor * (sign * columns.values[at] + part.offset)
    for row in np.flatnonzero(np.abs(values) > FARTHEST)[:1].tolist():
        problem = f"is {columns.values[at, row]:.6g}, which is too large for {words} of a car"
        allowed = f"at most {FARTHEST:g} {meaning.unit}, or an empty cell or nan for no number"
        raise FileError(source, f"{columns.rows[row]}, {column}", problem, allowed)
    steps = columns.steps[at] if part.printed is None else np.full(len(values), part.printed)
    return Series(name, meaning, values, 0.5 * factor * steps, unit, factor, part)
