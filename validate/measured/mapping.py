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
from dataclasses import dataclass, replace
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
    NUMBER,
    PLACES,
    TIME,
    TRAVEL,
    Meaning,
    first_numbers,
    meanings_of,
    named,
    poses_of,
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
    held: Mapping[str, float]
    rolling_radius: float
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
    said, meanings = MapSaid.of(content, where), meanings_of(scene.mechanism.topology)
    travels = [words for words, one in meanings.items() if one.kind == TRAVEL]
    _require(where, "columns", said.columns, columns.names, f"column of {columns.source}")
    _require(where, "held", said.held, (*scene.mechanism.topology.inputs, *travels), "input or travel")
    meant_as = _meant_as(columns, said, scene, where)
    out = [name for name, one in meant_as.items() if one is None]
    ignored = f"; ignored: {listed(out)}" if out else ""
    found = _series(columns, said, meant_as, where)
    if not found:
        known = first_numbers(meanings)
        near = next((hint for name in columns.names if (hint := meant(name, known))), "")
        problem = f"none of {listed(columns.names)} is recognised{near}"
        allowed = f"names such as time, {', '.join(known[:NAMED])}, or a map of them (--map)"
        raise FileError(columns.source, "names of the columns", problem, allowed)
    times, heights, inputs, numbers = (
        [s for s in found if s.meaning.kind == kind] for kind in (TIME, TRAVEL, INPUT, NUMBER)
    )
    over = times or [*heights, *inputs]
    if len(heights) > 1 and not times:
        problem = f"each of {listed(s.column for s in heights)} could give the pose of a row"
        raise FileError(where, "columns", problem, f'is = "{IGNORE}" for all but one')
    if not over:
        problem = f"no column gives the pose of a row{ignored}"
        allowed = f"a column of {poses_of(scene.mechanism.topology)} (in a map)"
        raise FileError(columns.source, "names of the columns", problem, allowed)
    if not numbers:
        allowed = f"columns such as {', '.join(first_numbers(meanings)[:NAMED])}"
        raise FileError(columns.source, "", f"has no numbers to compare{ignored}", allowed)
    there: Flags = np.asarray(np.isfinite([s.values for s in over]).all(axis=0))
    if not there.any():
        raise FileError(columns.source, "", "no row gives its pose", "at least one row with its pose")
    notes = list[str]()
    if out:
        notes.append(f"ignored: {listed(out)} (name not recognised, without a unit, or as the map says)")
    if even := [s.column for s in over if s.set_exactly]:
        steps = "in even steps, taken as exact; if rounded, give its printed = STEP in a map"
        notes.append(f"{listed(even, ' and ')}: {steps}")
    if unused := [s.column for s in (*heights, *inputs) if times]:
        notes.append(
            f"{listed(unused)} not used: the pose of a row is given by {listed(s.column for s in over)}"
        )
    for s in numbers:
        if lacking := int(np.isnan(s.values).sum()):
            notes.append(f"{shown(s.column)} has no number in {lacking} of {len(s.values)} rows")
    if not there.all():
        first = columns.rows[int(np.argmin(there))]
        lost = len(there) - int(there.sum())
        notes.append(f"{lost} rows do not give their pose and are left out, the first: {first}")

    def kept(s: Series) -> Series:
        return replace(s, values=s.values[there], off=s.off[there] * (s.column not in even))

    return Measured(
        source=columns.source,
        independent=tuple(map(kept, over)),
        numbers=tuple(map(kept, numbers)),
        held=said.held,
        rolling_radius=said.rolling_radius,
        rows=tuple(row for row, is_there in zip(columns.rows, there, strict=True) if is_there),
        notes=tuple(notes),
    )


def map_to_fill_in(file: str, scene: Scene) -> str:
    """The text of a map (TOML) to fill in for a file of results, with the recognised columns filled in.

    Raises:
        FileError: the file cannot be read.
        MissingLibrary: Parquet needs pyarrow.
    """
    columns = read_columns(file)
    lines = [
        f"# The columns of {columns.source}. Fill in what is missing, and remove the #.",
        fill(f"is: {_there_is(scene)}", 100, initial_indent="# ", subsequent_indent="#     "),
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


def listed(names: Iterable[str], by: str = ", ") -> str:
    """Names from a file for a message, long ones shortened."""
    return by.join(shown(shown_key(name)) for name in names)


def _require(where: str, place: str, names: Iterable[str], known: Sequence[str], what: str) -> None:
    for name in names:
        if name not in known:
            problem = f"no {what} is called {shown(name)!r}{meant(name, known)}"
            raise FileError(where, place, problem, ", ".join(known))


def _there_is(scene: Scene) -> str:
    """The possible meanings of a column of a car, in words."""
    topology = scene.mechanism.topology
    centre = [f"{PLACES}.{topology.wheel_centre}.z"] if topology.wheel_centre else []
    some = ", ".join((*centre, *first_numbers(meanings_of(topology))[:NAMED]))
    return f"{poses_of(topology)}, QUANTITY.NAME[.AXIS] such as {some}, or {IGNORE}"


def _meant_as(
    columns: Columns, said: MapSaid, scene: Scene, where: str
) -> dict[str, tuple[Meaning, int] | None]:
    """The meaning and sign of each column; None for a column that is left out.

    The sign is from the map, from a minus before the name, or from the convention.

    Raises:
        FileError: the map gives an unknown meaning.
    """
    meanings, convention = meanings_of(scene.mechanism.topology), said.convention or scene.convention

    def lookup(name: str) -> tuple[Meaning | None, int]:
        """The meaning and sign of a name; names other than our full names are read by the convention."""
        one = named(name, meanings)
        if one is None or one.kind != NUMBER or name in meanings:
            return one, 1
        ours, sign = meant_by(one.name, convention)
        return (one if ours == one.name else named(ours, meanings)), sign

    taken = [lookup(part.is_ or name)[0] for name, part in said.columns.items()]
    found: dict[str, tuple[Meaning, int] | None] = {}
    for name, unit in zip(columns.names, columns.units, strict=True):
        part = said.columns.get(name, ColumnSaid())
        one, sign = lookup(name.removeprefix("-") if part.is_ is None else part.is_)
        if part.is_ is None:
            sign = -1 if name.startswith("-") else sign
        elif one is None and part.is_ != IGNORE:
            known = (*meanings, IGNORE)
            near = meant(part.is_, (*known, *(n.partition(".")[2] for n in known if "." in n)))
            problem = f"nothing is called {shown(part.is_)!r}{near}"
            raise FileError(where, f"columns.{name}.is", problem, _there_is(scene))
        # Next to a map, a column that it does not name needs a unit and a meaning that no other column has.
        left_out = said.columns and name not in said.columns and (not unit or one in taken)
        found[name] = None if one is None or left_out else (one, part.sign or sign)
    return found


def _series(
    columns: Columns, said: MapSaid, meant_as: Mapping[str, tuple[Meaning, int] | None], where: str
) -> list[Series]:
    """All columns with a meaning, in our units."""
    found: dict[str, Series] = {}
    for at, (name, one) in enumerate(meant_as.items()):
        if one is None:
            continue
        meaning, sign = one
        if (words := meaning.words) in found:
            both = f"columns {shown(found[words].column)!r} and {shown(name)!r}"
            raise FileError(where, "columns", f"{both} are both {words}", "one column for each")
        column, part = f"column {shown(name)!r}", said.columns.get(name, ColumnSaid())
        if holds := columns.words.get(name):
            allowed = f'columns of numbers, or is = "{IGNORE}" in a map'
            raise FileError(columns.source, column, f"contains {holds}", allowed)
        unit = columns.units[at] if part.unit is None else part.unit
        factor = factor_of(unit, meaning.unit) if unit else None
        if factor is None:
            problem = "its unit is not given, neither after its name nor in a map"
            problem = f"{shown(unit)!r} is not a unit of {words}" if unit else problem
            wrong = (columns.source, column) if part.unit is None else (where, f"columns.{name}.unit")
            raise FileError(*wrong, problem, allowed_units(meaning.unit))
        with np.errstate(over="ignore"):
            values = factor * (sign * columns.values[at] + part.offset)
        farthest = FARTHEST ** max(1.0, meaning.per_second / 2.0)
        for row in np.flatnonzero(np.abs(values) > farthest)[:1].tolist():
            problem = f"is {columns.values[at, row]:.6g}, which is too large for {words} of a car"
            allowed = f"at most {farthest:g} {meaning.unit}, or an empty cell or nan for no number"
            raise FileError(columns.source, f"{columns.rows[row]}, {column}", problem, allowed)
        is_said = part.printed is not None
        last = np.full(len(values), part.printed) if is_said else columns.steps[at]
        found[words] = Series(
            name, meaning, values, 0.5 * factor * last, factor, part.accuracy, is_said, unit
        )
    return [*found.values()]
