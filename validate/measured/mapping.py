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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from textwrap import fill
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from pointcoord import Scene, SceneError
from pointcoord.effects.numbers import ConventionName, meant_by
from pointcoord.mechanism.faults import faults_of, known_keys
from pointcoord.toml_text import parsed, read_file
from pointcoord.wording import meant, shown_key
from validate.arrays import Array, Flags
from validate.measured.meanings import (
    CONTACT,
    IGNORE,
    INPUT,
    PLACES,
    TIME,
    TRAVEL,
    Meaning,
    meanings_of,
    named,
)
from validate.measured.reading import Columns, read_columns
from validate.plain_text import shown
from validate.tables.errors import FileError
from validate.tables.units import allowed_units, factor_of
from validate.toml_written import key_of, value_of

# Least number of values to decide that a column is in even steps: two values always are.
FEWEST = 3
BY_CHANCE = 1e-3  # steps that are equal to this share of a step or a last digit are not so by chance
# Upper limit of lengths, times, angles and rates in our units: squares of larger numbers might overflow. For
# a higher derivative the limit is raised to the power of half its order.
FARTHEST = 1e12
NAMED = 5  # largest number of names listed in a message


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

    rolling_radius: Number = math.nan
    convention: ConventionName | None = None
    held: dict[str, Number] = {}
    columns: dict[str, ColumnSaid] = {}

    @classmethod
    def of(cls, content: Mapping[str, Any], where: str) -> MapSaid:
        """A map from plain data.

        Raises:
            FileError: the map is wrong; the first fault.
        """
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            fault = faults_of(error)[0]
            raise FileError(where, ".".join(map(str, fault.place)), fault.problem, fault.allowed) from None


@dataclass(frozen=True)
class Series:
    """A column in our units.

    Attributes:
        column: its name in the file. meaning: its meaning.
        values: (N,), NaN for no number.
        off: rounding error of the values, half a unit of the last digit, (N,).
        factor: its unit in our unit. unit: its unit in the file.
        accuracy: accuracy from the map, in its unit; None if not given.
        said: whether the map gives the unit of its last digit.
    """

    column: str
    meaning: Meaning
    values: Array
    off: Array
    factor: float = 1.0
    accuracy: float | None = None
    said: bool = False
    unit: str = ""

    @property
    def rounded_unasked(self) -> bool:
        """Whether it is taken as rounded although the map does not say so."""
        return not self.said and bool(self.off.any())

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

    def taken(self, rows: Flags) -> Series:
        """The series at some rows."""
        return replace(self, values=self.values[rows], off=self.off[rows])

    def accuracy_or(self, accuracy: float) -> float:
        """The error of its numbers in addition to rounding, in our unit: from the map, or else `accuracy`."""
        return self.factor * (accuracy if self.accuracy is None else self.accuracy)


@dataclass(frozen=True)
class Measured:
    """A file of results, with the meaning of its columns.

    Attributes:
        source: the file.
        independent: the independent columns: time, a travel and inputs, or inputs.
        numbers: the columns to compare.
        held: inputs and travels with one value in every row, in our units.
        rolling_radius: mm; NaN if not given.
        rows: name of each row.
        notes: remarks on columns and rows that were left out.
    """

    source: str
    independent: tuple[Series, ...]
    numbers: tuple[Series, ...]
    held: Mapping[str, float] = field(default_factory=dict)
    rolling_radius: float = math.nan
    rows: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def instants(self) -> Array:
        """Values of the independent column, (N,); indices of rows if there are several."""
        one, *others = self.independent
        return np.arange(len(self.rows), dtype=float) if others else one.values

    def taken(self, keep: Flags) -> Measured:
        """The file with some of its rows."""
        return replace(
            self,
            independent=tuple(s.taken(keep) for s in self.independent),
            numbers=tuple(s.taken(keep) for s in self.numbers),
            rows=tuple(row for row, kept in zip(self.rows, keep, strict=True) if kept),
        )


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
    map = _Map(where, MapSaid.of(content, where), columns, scene)
    found = map.series()
    over = map.independent(found)
    numbers = tuple(s for s in found if s.meaning.kind == "number")
    if not numbers:
        allowed = f"columns such as {', '.join(map.numbers[:NAMED])}"
        raise FileError(columns.source, "", f"has no numbers to compare{map.ignored}", allowed)
    notes, over_names = list[str](), [s.column for s in over]
    if out := [name for name, one in map.meant.items() if one is None]:
        notes.append(f"ignored: {listed(out)} (name not recognised, without a unit, or as the map says)")
    if even := [s.column for s in over if s.set_exactly]:
        names = listed(even, " and ")
        notes.append(f"{names}: in even steps, taken as exact; if rounded, give its printed = STEP in a map")
    if beside := [s.column for s in found if s.meaning.kind != "number" and s.column not in over_names]:
        given = listed(over_names, " and ")
        notes.append(f"{listed(beside)} not used: the pose of a row is given by {given}")
    for s in numbers:
        if lacking := int(np.isnan(s.values).sum()):
            notes.append(f"{shown(s.column)} has no number in {lacking} of {len(s.values)} rows")
    lost: Flags = np.asarray(np.isnan([s.values for s in over]).any(axis=0))
    if lost.all():
        raise FileError(columns.source, "", "no row gives its pose", "at least one row with its pose")
    if lost.any():
        first = columns.rows[int(np.argmax(lost))]
        notes.append(f"{int(lost.sum())} rows do not give their pose and are left out, the first: {first}")
    return Measured(
        source=columns.source,
        independent=tuple(replace(s, off=0.0 * s.off) if s.column in even else s for s in over),
        numbers=numbers,
        held=map.said.held,
        rolling_radius=map.said.rolling_radius,
        rows=columns.rows,
        notes=tuple(notes),
    ).taken(~lost)


def map_to_fill_in(file: str, scene: Scene) -> str:
    """The text of a map (TOML) to fill in for a file of results, with the recognised columns filled in.

    Raises:
        FileError: the file cannot be read.
        MissingLibrary: Parquet needs pyarrow.
    """
    columns = read_columns(file)
    map = _Map("", MapSaid(), columns, scene)
    lines = [
        f"# The columns of {columns.source}. Fill in what is missing, and remove the #.",
        fill(f"is: {map.there_is}", 100, initial_indent="# ", subsequent_indent="#     "),
        "# unit: mm, deg, rad, s and so on. Further keys: sign = -1, offset = 0.5, accuracy = 0.001,",
        "#     printed = 0.01 (the unit of the last digit; 0: exact as written)",
        f"# rolling_radius = 300.0    # mm, of travel.{CONTACT}",
        "",
        "[columns]",
    ]
    for (name, one), unit in zip(map.meant.items(), columns.units, strict=True):
        entry = {"is": one[0].words if one else "", "unit": shown(unit)}
        lines.append(f"{'' if all(entry.values()) else '# '}{key_of(shown(name))} = {value_of(entry)}")
    return "\n".join(lines) + "\n"


def listed(names: Iterable[str], by: str = ", ") -> str:
    """Names from a file for a message, long ones shortened."""
    return by.join(shown(shown_key(name)) for name in names)


@dataclass(frozen=True)
class _Map:
    """A map with the columns and the scene that it describes.

    Attributes:
        where: its name in messages.
    """

    where: str
    said: MapSaid
    columns: Columns
    scene: Scene

    def __post_init__(self) -> None:
        self._require("columns", self.said.columns, self.columns.names, f"column of {self.columns.source}")
        travels = (words for words, one in self.meanings.items() if one.kind == TRAVEL)
        held = (*self.scene.mechanism.topology.inputs, *travels)
        self._require("held", self.said.held, held, "input or travel")

    def _require(self, place: str, names: Iterable[str], known: Sequence[str], what: str) -> None:
        for name in names:
            if name not in known:
                problem = f"no {what} is called {shown(name)!r}{meant(name, known)}"
                raise FileError(self.where, place, problem, ", ".join(known))

    @cached_property
    def meanings(self) -> dict[str, Meaning]:
        """All possible meanings of a column, by their full names."""
        return meanings_of(self.scene.mechanism.topology)

    @property
    def numbers(self) -> tuple[str, ...]:
        """The full names of numbers that can be compared, numbers of the car first."""
        numbers = [one for one in self.meanings.values() if one.kind == "number"]
        return tuple(one.words for one in sorted(numbers, key=lambda one: one.axis is not None))

    @property
    def poses(self) -> str:
        """The columns that can give the pose of a row, in words."""
        topology = self.scene.mechanism.topology
        inputs = [f"{INPUT}.{name}" for name in topology.inputs]
        centre = f" such as {TRAVEL}.{topology.wheel_centre}" if topology.wheel_centre else ""
        return ", ".join((TIME, *inputs, f"{TRAVEL}.POINT{centre}", f"{TRAVEL}.{CONTACT}"))

    @property
    def ignored(self) -> str:
        """The columns without a meaning, for the end of a message."""
        ignored = [name for name, one in self.meant.items() if one is None]
        return f"; ignored: {listed(ignored)}" if ignored else ""

    @property
    def there_is(self) -> str:
        """The possible meanings of a column, in words."""
        centre = self.scene.mechanism.topology.wheel_centre
        some = ", ".join((*([f"{PLACES}.{centre}.z"] if centre else ()), *self.numbers[:NAMED]))
        return f"{self.poses}, QUANTITY.NAME[.AXIS] such as {some}, or {IGNORE}"

    def _lookup(self, name: str) -> tuple[Meaning | None, int]:
        """The meaning and sign of a name; names other than our full names are read by the convention."""
        found = named(name, self.meanings)
        if found is None or found.kind != "number" or name in self.meanings:
            return found, 1
        meant, sign = meant_by(found.name, self.said.convention or self.scene.convention)
        return (found if meant == found.name else named(meant, self.meanings)), sign

    @cached_property
    def meant(self) -> dict[str, tuple[Meaning, int] | None]:
        """The meaning and sign of each column; None for a column that is left out.

        The sign is from the map, from a minus before the name, or from the convention.

        Raises:
            FileError: the map gives an unknown meaning.
        """
        every = self.said.columns
        taken = [self._lookup(part.is_ or name)[0] for name, part in every.items()]
        found: dict[str, tuple[Meaning, int] | None] = {}
        for name, file_unit in zip(self.columns.names, self.columns.units, strict=True):
            part = every.get(name, ColumnSaid())
            meaning, sign = self._lookup(name.removeprefix("-") if part.is_ is None else part.is_)
            if part.is_ is None:
                sign = -1 if name.startswith("-") else sign
            elif meaning is None and part.is_ != IGNORE:
                known = (*self.meanings, IGNORE)
                near = meant(part.is_, (*known, *{n.partition(".")[2]: n for n in known if "." in n}))
                problem = f"nothing is called {shown(part.is_)!r}{near}"
                raise FileError(self.where, f"columns.{name}.is", problem, self.there_is)
            if every and name not in every and (not file_unit or meaning in taken):
                meaning = None
            found[name] = None if meaning is None else (meaning, part.sign or sign)
        return found

    def series(self) -> list[Series]:
        """All columns with a meaning, in our units."""
        found: dict[str, Series] = {}
        for at, (name, one) in enumerate(self.meant.items()):
            if one is None:
                continue
            if (words := one[0].words) in found:
                both = f"columns {shown(found[words].column)!r} and {shown(name)!r}"
                raise FileError(self.where, "columns", f"{both} are both {words}", "one column for each")
            found[words] = self._in_ours(at, name, *one)
        if not found:
            near = next((h for n in self.columns.names if (h := meant(n, self.numbers))), "")
            problem = f"none of {listed(self.columns.names)} is recognised{near}"
            allowed = f"names such as time, {', '.join(self.numbers[:NAMED])}, or a map of them (--map)"
            raise FileError(self.columns.source, "names of the columns", problem, allowed)
        return list(found.values())

    def _in_ours(self, at: int, name: str, meaning: Meaning, sign: int) -> Series:
        """A column in our unit."""
        source, column = self.columns.source, f"column {shown(name)!r}"
        if holds := self.columns.words.get(name):
            allowed = f'columns of numbers, or is = "{IGNORE}" in a map'
            raise FileError(source, column, f"contains {holds}", allowed)
        part = self.said.columns.get(name, ColumnSaid())
        unit = self.columns.units[at] if part.unit is None else part.unit
        factor = factor_of(unit, meaning.unit) if unit else None
        if factor is None:
            problem = "its unit is not given, neither after its name nor in a map"
            problem = f"{shown(unit)!r} is not a unit of {meaning.words}" if unit else problem
            wrong = (source, column) if part.unit is None else (self.where, f"columns.{name}.unit")
            raise FileError(*wrong, problem, allowed_units(meaning.unit))
        theirs, steps = self.columns.values[at], self.columns.steps[at]
        with np.errstate(over="ignore"):
            values = factor * (sign * theirs + part.offset)
        farthest = FARTHEST ** max(1.0, meaning.per_second / 2.0)
        for row in np.flatnonzero(np.abs(values) > farthest)[:1].tolist():
            problem = f"is {theirs[row]:.6g}, which is too large for {meaning.words} of a car"
            allowed = f"at most {farthest:g} {meaning.unit}, or an empty cell or nan for no number"
            raise FileError(source, f"{self.columns.rows[row]}, {column}", problem, allowed)
        said = part.printed is not None
        last = np.full(len(steps), part.printed) if said else steps
        return Series(name, meaning, values, 0.5 * factor * last, factor, part.accuracy, said, unit)

    def independent(self, found: Sequence[Series]) -> tuple[Series, ...]:
        """The columns that give the pose of a row: time, or a travel and inputs."""
        times, travels, inputs = ([s for s in found if s.meaning.kind == k] for k in (TIME, TRAVEL, INPUT))
        if len(travels) > 1 and not times:
            problem = f"each of {listed(s.column for s in travels)} could give the pose of a row"
            raise FileError(self.where, "columns", problem, f'is = "{IGNORE}" for all but one')
        if not (chosen := times or [*travels, *inputs]):
            problem = f"no column gives the pose of a row{self.ignored}"
            allowed = f"a column of {self.poses} (in a map)"
            raise FileError(self.columns.source, "names of the columns", problem, allowed)
        return tuple(chosen)
