"""What each column of a file is: by its own name, or by a map that the user writes.

A map is TOML:

    rolling_radius = 270.0        # mm; for travel.contact only
    convention = "adams"          # whose names they are: adams, optimumk, lotus; as the scene if not said

    [held]                        # what is the same in every row; inputs that nothing is said of: as drawn
    rack = 0.0

    [columns.camber]              # by the name in the file
    is = "wheel.camber"           # time, input.NAME, travel.POINT or .contact, QUANTITY.NAME[.AXIS], ignore
    unit = "deg"                  # if the file does not say it
    sign = -1                     # ours = sign * theirs + offset, the offset in the column's unit
    offset = 0.0
    printed = 0.0001              # unit of the last digit, in the column's unit; 0: written in full or exact
    accuracy = 0.001              # how far its numbers may be off beside that, in the column's unit

Columns that a map does not name are found by their own names all the same, where the file says their unit and
no other column is said to be that. Rows are taken by time where there is one, or else by a travel and inputs;
what is not to count is ignored.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from pointcoord import Scene, SceneError
from pointcoord.effects.conventions import CONVENTIONS, ConventionName
from pointcoord.mechanism.faults import faults_of
from pointcoord.toml_text import parsed, read_file
from pointcoord.wording import meant, shown_key
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

Array = NDArray[np.float64]

# Values in even steps that are taken as set exactly: two always are.
FEWEST = 3
BY_CHANCE = 1e-3  # of a step or a last digit: what is even to less is hardly so by chance
# No length, time, angle or rate of a car is larger in our units; the square of what is may be no number. Of a
# higher derivative the limit is this for every two seconds that it is divided by.
FARTHEST = 1e12


Number = Annotated[float, Field(strict=True, ge=-FARTHEST, le=FARTHEST)]
Size = Annotated[Number, Field(ge=0.0)]


class ColumnSaid(BaseModel):
    """What a map says of a column, as the top of this file has it; None what it does not say."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    is_: str | None = Field(default=None, alias="is")
    unit: str | None = None
    sign: Literal[1, -1] = 1
    offset: Number = 0.0
    printed: Size | None = None
    accuracy: Size | None = None


class MapSaid(BaseModel):
    """What a map says, likewise."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    rolling_radius: Number = math.nan
    convention: ConventionName | None = None
    held: dict[str, Number] = {}
    columns: dict[str, ColumnSaid] = {}

    @classmethod
    def of(cls, content: Mapping[str, Any], where: str) -> MapSaid:
        """A map as plain data, checked.

        Raises:
            FileError: the first fault.
        """
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            if first["type"] == "extra_forbidden":
                *place, key = map(str, first["loc"])
                fields = (ColumnSaid if place else cls).model_fields.items()
                known = [field.alias or name for name, field in fields]
                problem = f"no key is called {key!r}{meant(key, known)}"
                raise FileError(where, ".".join(place), problem, ", ".join(known)) from None
            fault = faults_of(error)[0]
            raise FileError(where, ".".join(map(str, fault.place)), fault.problem, fault.allowed) from None


@dataclass(frozen=True)
class Series:
    """A column in our units.

    Attributes:
        column: its name in the file. meaning: what it is.
        values: (N,), NaN where the file has none.
        off: how far what was rounded may be from what is written, half a unit of the last digit, (N,).
        factor: how many of ours its unit is. accuracy: that a map says, in its unit; None if it says none.
        said: whether a map says what its last digit is.
    """

    column: str
    meaning: Meaning
    values: Array
    off: Array
    factor: float = 1.0
    accuracy: float | None = None
    said: bool = False

    @property
    def even(self) -> bool:
        """Whether its values go in even steps, as those do that are set and not measured.

        Programs leave zeros off: -30 is -30.0000000000 beside -26.6666666667, and is written the coarsest.
        Digits that are cut off come out even by chance only.
        """
        there = np.isfinite(self.values)
        values = np.unique(self.values[there])
        if len(values) < FEWEST:
            return False
        steps = np.diff(values)
        return bool(np.ptp(steps) <= BY_CHANCE * min(float(self.off[there].max()), float(steps.min())))

    def apart(self, ours: Array, theirs: Array) -> Array:
        """Ours less theirs; whole turns apart is the same angle."""
        gap, turn = ours - theirs, 2.0 * math.pi
        return gap - turn * np.rint(gap / turn) if self.meaning.unit == "rad" else gap

    def taken(self, rows: NDArray[np.bool_]) -> Series:
        """Some of its rows."""
        return replace(self, values=self.values[rows], off=self.off[rows])

    def accuracy_or(self, accuracy: float) -> float:
        """How far its numbers may be off beside their digits, in our unit."""
        return self.factor * (accuracy if self.accuracy is None else self.accuracy)


@dataclass(frozen=True)
class Measured:
    """A file of results, read and understood.

    Attributes:
        source: the file.
        independent: what the others are given over: the time, a travel and inputs, or inputs.
        numbers: what is to be compared.
        held: inputs and travels that are the same in every row, in our units.
        rolling_radius: mm; NaN if not said.
        rows: what to call each row.
        notes: what was left out.
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
        """Values of the independent column; numbers of rows where there are several, (N,)."""
        one, *others = self.independent
        return np.arange(len(self.rows), dtype=float) if others else one.values

    def taken(self, keep: NDArray[np.bool_]) -> Measured:
        """Some of its rows."""
        return replace(
            self,
            independent=tuple(s.taken(keep) for s in self.independent),
            numbers=tuple(s.taken(keep) for s in self.numbers),
            rows=tuple(row for row, kept in zip(self.rows, keep, strict=True) if kept),
        )


def read_results(file: str, map: str | None, scene: Scene) -> Measured:
    """Read a file of results of a scene's car.

    Args:
        map: file that says what the columns are; None where they carry our own names.
    Raises:
        FileError: the file or the map is wrong, or nothing in it can be compared.
        MissingLibrary: Parquet needs pyarrow.
    """
    columns = read_columns(file)
    where = columns.source if map is None else shown(map)
    return understood(columns, {} if map is None else _map_of(map), scene, where)


def _map_of(path: str) -> dict[str, Any]:
    """The content of a map."""
    try:
        return parsed(read_file(path, "the path of a map of columns (TOML)"), shown(path))
    except SceneError as error:
        raise FileError(shown(path), error.key, error.problem, error.allowed or "TOML") from None


def understood(columns: Columns, content: Mapping[str, Any], scene: Scene, where: str) -> Measured:
    """What columns mean, by a map as plain data.

    Args:
        where: what to call the map in messages.
    Raises:
        FileError: see `read_results`.
    """
    map = _Map(where, MapSaid.of(content, where), columns, scene)
    found = map.series()
    independent = map.independent(found)
    even = [s.column for s in independent if not s.said and s.off.any() and s.even]
    independent = tuple(replace(s, off=0.0 * s.off) if s.column in even else s for s in independent)
    numbers = tuple(s for s in found if s.meaning.kind == "number")
    if not numbers:
        allowed = f"columns such as {', '.join(map.known[:4])}"
        raise FileError(columns.source, "", "holds nothing to compare", allowed)
    notes = []
    if out := [name for name, one in map.filled.items() if one is None]:
        notes.append(f"ignored: {listed(out)} (name not recognised, without a unit, or as the map says)")
    if even:
        names = listed(even, " and ")
        notes.append(f"{names}: in even steps, taken as exact; if rounded, say printed = STEP of it in a map")
    taken = {s.column for s in (*independent, *numbers)}
    if beside := [s.column for s in found if s.column not in taken]:
        over = listed((s.column for s in independent), " and ")
        notes.append(f"{listed(beside)} is not compared: rows are taken by {over}")
    for s in numbers:
        if lacking := int(np.isnan(s.values).sum()):
            notes.append(f"{shown(s.column)} has no number in {lacking} of {len(s.values)} rows")
    lost: NDArray[np.bool_] = np.asarray(np.isnan([s.values for s in independent]).any(axis=0))
    if lost.all():
        raise FileError(columns.source, "", "no row says at which pose it is", "at least one")
    if lost.any():
        first = columns.rows[int(np.argmax(lost))]
        notes.append(f"rows that do not say at which pose they are: {int(lost.sum())}, from {first} on")
    return Measured(
        source=columns.source,
        independent=independent,
        numbers=numbers,
        held=map.held,
        rolling_radius=map.said.rolling_radius,
        rows=columns.rows,
        notes=tuple(notes),
    ).taken(~lost)


def map_to_fill_in(file: str, scene: Scene) -> str:
    """The text of a map (TOML) of a file of results: what is known of each column, and a line for the others.

    Raises:
        FileError: the file cannot be read.
        MissingLibrary: Parquet needs pyarrow.
    """
    columns = read_columns(file)
    map = _Map("", MapSaid(), columns, scene)
    topology = scene.mechanism.topology
    inputs = ", ".join(f"{INPUT}.{name}" for name in topology.inputs)
    lines = [
        f"# What the columns of {columns.source} are. Fill in what is missing, and take its # away.",
        f"# is: time, {inputs}, travel.POINT, travel.{CONTACT}, QUANTITY.NAME[.AXIS], ignore",
        f"#     such as {PLACES}.{topology.wheel_centre}.z, {', '.join(map.known[:5])}",
        "# unit: mm, deg, rad, s and the like. More keys: sign = -1, offset = 0.5, accuracy = 0.001,",
        "#     printed = 0.01 (the unit of the last digit; 0: exact as written)",
        f"# rolling_radius = 300.0    # mm, of travel.{CONTACT}",
        "",
        "[columns]",
    ]
    for (name, one), unit in zip(map.filled.items(), columns.units, strict=True):
        said = {"is": one.meaning.words if one else "", "unit": shown(one.unit if one else unit)}
        lines.append(f"{'' if all(said.values()) else '# '}{key_of(shown(name))} = {value_of(said)}")
    return "\n".join(lines) + "\n"


def listed(names: Iterable[str], by: str = ", ") -> str:
    """Names of a file as they can be shown, the long ones shortened."""
    return by.join(shown(shown_key(name)) for name in names)


@dataclass(frozen=True)
class Column:
    """What a column is, by a map that says everything of it.

    Attributes:
        name, at: in the file. unit: as the map or the file says it; empty where neither does.
        sign: of the map, of a minus before its name, or of the convention. said: what else the map says.
    """

    name: str
    at: int
    meaning: Meaning
    unit: str
    sign: int
    said: ColumnSaid


@dataclass(frozen=True)
class _Map:
    """A map of columns and what it is about."""

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
                raise self._wrong(place, problem, ", ".join(known))

    def _wrong(self, place: str, problem: str, allowed: str) -> FileError:
        """The map is at fault."""
        return FileError(self.where, place, problem, allowed)

    def _column(self, column: str, problem: str, allowed: str) -> FileError:
        """A column of the file is at fault."""
        return FileError(self.columns.source, f"column {shown(column)!r}", problem, allowed)

    @cached_property
    def meanings(self) -> dict[str, Meaning]:
        return meanings_of(self.scene.mechanism.topology)

    @property
    def held(self) -> dict[str, float]:
        """Inputs and travels that every row has, by their whole names."""
        return {n if n in self.meanings else f"{INPUT}.{n}": value for n, value in self.said.held.items()}

    @property
    def known(self) -> tuple[str, ...]:
        """Names of what can be compared, the car's own numbers first."""
        numbers = [one for one in self.meanings.values() if one.kind == "number"]
        return tuple(one.words for one in sorted(numbers, key=lambda one: one.axis is not None))

    def _lookup(self, name: str) -> tuple[Meaning | None, int]:
        """Its meaning and sign; of a name that is no whole one of ours, by the convention."""
        found = named(name, self.meanings)
        if found is None or found.kind != "number" or name in self.meanings:
            return found, 1
        meant_by, sign = CONVENTIONS[self.said.convention or self.scene.convention].number(found.name)
        return (found if meant_by == found.name else named(meant_by, self.meanings)), sign

    @cached_property
    def filled(self) -> dict[str, Column | None]:
        """What each column is; None what is left out.

        Raises:
            FileError: the map gives a column a name that there is not.
        """
        every = self.said.columns
        taken = [self._lookup(name if part.is_ is None else part.is_)[0] for name, part in every.items()]
        found: dict[str, Column | None] = {}
        for at, name in enumerate(self.columns.names):
            part = every.get(name) or ColumnSaid()
            unit = self.columns.units[at] if part.unit is None else part.unit
            meaning, sign = self._lookup(name.removeprefix("-") if part.is_ is None else part.is_)
            if part.is_ not in (None, IGNORE) and meaning is None:
                raise self._unknown(name, part.is_)
            if every and name not in every and (not unit or meaning in taken):
                meaning = None
            sign = -1 if name.startswith("-") and part.is_ is None else sign
            sign = part.sign if "sign" in part.model_fields_set else sign
            found[name] = None if meaning is None else Column(name, at, meaning, unit, sign, part)
        return found

    def _unknown(self, column: str, said: str | None) -> FileError:
        every, name = (*self.meanings, IGNORE), said or ""
        hint = meant(name, (*every, *{n.partition(".")[2]: n for n in every if "." in n}))
        allowed = f"{TIME}, {INPUT}.NAME, {TRAVEL}.POINT, {TRAVEL}.{CONTACT}, QUANTITY.NAME[.AXIS] such as "
        allowed += f"{', '.join(self.known[:5])}, or {IGNORE}"
        return self._wrong(f"columns.{column}.is", f"nothing is called {shown(name)!r}{hint}", allowed)

    # Columns in our units.

    def series(self) -> list[Series]:
        """Every column that means something, in our units."""
        found: dict[str, Series] = {}
        for column in self.filled.values():
            if column is None:
                continue
            if (words := column.meaning.words) in found:
                both = f"columns {shown(found[words].column)!r} and {shown(column.name)!r}"
                raise self._wrong("columns", f"{both} are both {words}", "one column for each")
            found[words] = self._in_ours(column)
        if not found:
            near = next((h for n in self.columns.names if (h := meant(n, self.known))), "")
            problem = f"none of {listed(self.columns.names)} is a name that we know{near}"
            allowed = f"names such as time, {', '.join(self.known[:4])}, or a map of them (--map)"
            raise FileError(self.columns.source, "names of the columns", problem, allowed)
        return list(found.values())

    def _in_ours(self, column: Column) -> Series:
        name, meaning, part = column.name, column.meaning, column.said
        if holds := self.columns.words.get(name):
            raise self._column(name, f"holds {holds}", f'columns of numbers, or is = "{IGNORE}" in a map')
        factor = factor_of(column.unit, meaning.unit) if column.unit else None
        if factor is None:
            problem = f"{shown(column.unit)!r} is no unit of {meaning.words}"
            problem = problem if column.unit else "its unit is not said, neither behind its name nor in a map"
            if part.unit is not None:
                raise self._wrong(f"columns.{name}.unit", problem, allowed_units(meaning.unit))
            raise self._column(name, problem, allowed_units(meaning.unit))
        theirs, steps = self.columns.values[column.at], self.columns.steps[column.at]
        with np.errstate(over="ignore"):
            values = factor * (column.sign * theirs + part.offset)
        farthest = FARTHEST ** max(1.0, meaning.per_second / 2.0)
        for row in np.flatnonzero(np.abs(values) > farthest)[:1].tolist():
            where = f"{self.columns.rows[row]}, column {shown(name)!r}"
            problem = f"is {theirs[row]:.6g}, a number of {meaning.words} that no car has"
            allowed = f"at most {farthest:g} {meaning.unit}, or nothing or nan for none"
            raise FileError(self.columns.source, where, problem, allowed)
        last = steps if part.printed is None else np.full(len(steps), part.printed)
        return Series(
            name, meaning, values, 0.5 * factor * last, factor, part.accuracy, part.printed is not None
        )

    def independent(self, found: list[Series]) -> tuple[Series, ...]:
        """What the rows are taken by: time, or a travel and inputs."""
        times, travels, inputs = ([s for s in found if s.meaning.kind == k] for k in (TIME, TRAVEL, INPUT))
        if len(travels) > 1 and not times:
            problem = f"{listed(s.column for s in travels)} could each be what rows are taken by"
            raise self._wrong("columns", problem, f'is = "{IGNORE}" of all but one')
        if not (chosen := times or [*travels, *inputs]):
            names = ", ".join(f"{INPUT}.{name}" for name in self.scene.mechanism.topology.inputs)
            allowed = f"a column of {TIME}, {names}, or {TRAVEL}.POINT (in a map)"
            problem = "no column says at which pose a row is"
            raise FileError(self.columns.source, "names of the columns", problem, allowed)
        return tuple(chosen)
