"""What the columns that rows are taken by may be meant as: of another sign, unit or zero than is said.

A column v of an input or a travel is supposed to be x = k v + c in ours, with k 1, -1, or what makes another
unit of it, and c 0, the drawn input, pi of an angle that counts the other way, or found by least squares of
the file's places and angles. Poses are solved at some rows only; whoever supposes it has to hold the whole
file to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, solve_poses
from pointcoord.data_classes import dataclass
from pointcoord.effects.registry import QUANTITIES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.simulation import scene_mechanism
from validate.measured.mapping import ARCSINE, INPUT, PLACES, TIME, TRAVEL, Measured, Series, angle_of
from validate.measured.poses import OverMap, Plan, Poses, sensible, widest
from validate.measured.units import KINDS
from validate.plain_text import shown

Array = NDArray[np.float64]

ROWS = 16  # that poses are solved at
NEARLY_ALL = 0.8  # of them must be in reach
STEPS = 8  # of least squares
STEP = {"rad": 1e-5, "mm": 1e-3}  # of its differences
# What a supposition may leave of the differences, of the numbers' own spread, to be held to the whole file.
PROMISING = 0.05
# By what a rounded offset may leave more than the found one, which least squares put lowest.
CLOSE = 1.1
# Of a found offset: how near to a known one it is meant to be that.
NEAR = 1e-3


@dataclass(frozen=True)
class Supposed:
    """A file with its independent columns meant otherwise; found: whether an offset was fitted to it."""

    words: str
    measured: Measured
    found: bool


@dataclass(frozen=True)
class _Change:
    """x = factor v + more, in words of the column; whether the offset was found by least squares."""

    words: str
    factor: float = 1.0
    more: float = 0.0
    found: bool = False

    @property
    def nothing(self) -> bool:
        return self.factor == 1.0 and self.more == 0.0


def likely(scene: Scene, measured: Measured, poses: Poses) -> Iterator[Supposed]:
    """The likeliest suppositions, what is known beforehand before what is found; none over time."""
    if measured.independent[0].meaning.kind == TIME or not any(map(_is_of_a_pose, measured.numbers)):
        return
    try:
        trial = _Trial(scene, _some(measured), poses)
        found = list(_supposed(trial))
    except PointcoordError:
        return
    before = trial.left([_Change("")] * len(measured.independent))
    found = [one for one in found if one[0] <= PROMISING and one[0] < before]
    # Simple before far-fetched, where both leave as little as the digits of a file allow.
    found.sort(key=lambda one: (math.floor(math.log10(one[0] + 1e-12)), one[1]))
    for _, _, changes in found:
        told = [
            f"{shown(s.column)} {change.words}"
            for s, change in zip(measured.independent, changes, strict=True)
            if not change.nothing
        ]
        independent = tuple(
            replace(s, values=c.factor * s.values + c.more, off=abs(c.factor) * s.off)
            for s, c in zip(measured.independent, changes, strict=True)
        )
        words, fitted = ", and ".join(told), any(change.found for change in changes)
        turned = {s.meaning.words for s, c in zip(independent, changes, strict=True) if c.factor < 0.0}
        slopes = [s for s in measured.numbers if s.meaning.per in turned]
        numbers = tuple(
            replace(s, values=-s.values) if s.meaning.per in turned else s for s in measured.numbers
        )
        yield Supposed(words, replace(measured, independent=independent, numbers=numbers), fitted)
        if slopes:
            # Derivatives by a column that counts the other way do so too, if they were not made of another.
            names = ", ".join(shown(s.column) for s in slopes)
            words = f"{words}, and {names} is by it as it is said"
            yield Supposed(words, replace(measured, independent=independent), fitted)


def in_reach(scene: Scene, measured: Measured, poses: Poses) -> Iterator[str]:
    """Units of a column that bring nearly all rows within reach, in words; nearest the said one first."""
    rates = [s.values for s in measured.rates]
    for i, s in enumerate(measured.independent):
        units = [(n, size / s.factor) for n, size in _units(s.meaning.unit)]
        for name, factor in sorted(units, key=lambda one: abs(math.log(one[1]))):
            values = [factor * v.values if k == i else v.values for k, v in enumerate(measured.independent)]
            try:
                reached = poses.at(values, rates).reached
            except PointcoordError:
                continue
            if abs(factor - 1.0) > 1e-9 and reached.mean() >= NEARLY_ALL:
                yield f"{shown(s.column)} is in {name}, not in {_unit_of(s)}"


def _is_of_a_pose(series: Series) -> bool:
    unit = QUANTITIES[series.meaning.quantity].unit
    return not series.meaning.per and "/" not in unit


def _some(measured: Measured) -> Measured:
    """Some of its rows, evenly, and of its numbers those that a pose has."""
    rows = np.zeros(len(measured.rows), dtype=bool)
    rows[np.unique(np.linspace(0, len(rows) - 1, ROWS).astype(int))] = True
    return replace(
        measured,
        independent=tuple(s.taken(rows) for s in measured.independent),
        numbers=tuple(s.taken(rows) for s in measured.numbers if _is_of_a_pose(s)),
        rows=tuple(row for row, kept in zip(measured.rows, rows, strict=True) if kept),
    )


def _supposed(trial: _Trial) -> Iterator[tuple[float, float, list[_Change]]]:
    """What is left of the differences, how far-fetched it is, and what is changed of each column."""
    columns = trial.measured.independent
    same = [_Change("")] * len(columns)
    known = [list(trial.known(s)) for s in columns]
    for i, changes in enumerate(known):
        for cost, change in changes:
            every = [*same[:i], change, *same[i + 1 :]]
            yield trial.left(every), cost, every
    for (i, first), (j, second) in combinations(enumerate(known), 2):
        for (cost, one), (further, two) in product(first, second):
            # Of units of two columns only that both are in the same.
            if abs(one.factor) != abs(two.factor):
                continue
            every = list(same)
            every[i], every[j] = one, two
            yield trial.left(every), cost + further + 1.0, every
    for i, s in enumerate(columns):
        for factor, words in ((1.0, ""), (-1.0, "counts the other way, and ")):
            found = trial.found(i, factor)
            if found is not None:
                change = _Change(words + trial.offset(s, factor, found), factor, found, found=True)
                every = [*same[:i], change, *same[i + 1 :]]
                yield trial.left(every), 3.0 - factor, every


@dataclass(frozen=True, repr=False)
class _Trial:
    """A file's numbers by other values of its independent columns."""

    scene: Scene
    measured: Measured
    poses: Poses

    @cached_property
    def plan(self) -> Plan:
        return Plan.of(self.scene, self.measured)

    def known(self, s: Series) -> Iterator[tuple[float, _Change]]:
        """Changes of a column that nothing is found for, and how far-fetched they are."""
        unit, drawn = s.meaning.unit, self._drawn(s)
        yield 1.0, _Change("has the other sign", -1.0)
        if unit == "rad":
            yield 1.2, _Change("is pi minus ours", -1.0, math.pi)
        homes = [("", 0.0)] if not drawn else [("", 0.0), (", and from the drawing on", drawn)]
        if drawn:
            yield 1.1, _Change("counts from the drawing on", 1.0, drawn)
            yield 1.3, _Change("counts from the drawing on, the other way", -1.0, drawn)
        said = _unit_of(s)
        for name, size in _units(unit):
            factor = size / s.factor
            if abs(factor - 1.0) > 1e-9:
                for i, (words, more) in enumerate(homes):
                    yield 1.1 + i, _Change(f"is in {name}, not in {said}{words}", factor, more)
                    if unit != "rad" or more:
                        back = f"is in {name}, not in {said}, and has the other sign{words}"
                        yield 2.1 + i, _Change(back, -factor, more)

    def _drawn(self, s: Series) -> float:
        """An input of the drawing; a travel counts from there by itself."""
        return self.plan.drawn.get(s.meaning.name, 0.0) if s.meaning.kind == INPUT else 0.0

    def offset(self, s: Series, factor: float, found: float) -> str:
        """What is missing of a column, in words."""
        theirs = found / s.factor
        unit, word = _unit_of(s), "missing" if found > 0.0 else "too many"
        drawn = self._drawn(s)
        if drawn and abs(found - drawn) <= NEAR * abs(drawn) and factor > 0.0:
            return "counts from the drawing on"
        return f"counts from another zero: {abs(theirs):.5g} {unit} are {word}"

    def left(self, changes: Sequence[_Change]) -> float:
        """What is left of the differences, of their numbers' spread; infinite where rows are out of reach."""
        values = [
            c.factor * s.values + c.more for s, c in zip(self.measured.independent, changes, strict=True)
        ]
        gap = self._gaps(values)
        told = np.isfinite(gap) | ~np.isfinite(self._theirs)
        # A supposition must make sense of nearly all rows.
        if not told.all(axis=0).mean() >= NEARLY_ALL or not np.isfinite(gap).any():
            return math.inf
        return float(np.sqrt(np.nanmean(gap**2)))

    def found(self, i: int, factor: float) -> float | None:
        """What least squares adds to a column; None where it does not come near."""
        columns = self.measured.independent
        begin = [0.0, self._drawn(columns[i])] if self._drawn(columns[i]) else [0.0]
        best: tuple[float, float] | None = None
        step = STEP[columns[i].meaning.unit]
        for more in begin:
            for _ in range(STEPS):
                here, there = (
                    self._gaps([(factor * s.values + c if s is columns[i] else s.values) for s in columns])
                    for c in (more, more + step)
                )
                both = np.isfinite(here) & np.isfinite(there)
                slope = (there[both] - here[both]) / step
                square = float(slope @ slope)
                if not square > 0.0:
                    break
                change = -float(slope @ here[both]) / square
                more += change
                rest = float(np.sqrt(np.mean((here[both] + slope * change) ** 2)))
                if best is None or rest < best[0]:
                    best = rest, more
                if abs(change) <= 1e-9 * (1.0 + abs(more)):
                    break
        if best is None or best[0] > PROMISING:
            return None
        return self._meant(i, factor, best[1])

    def _meant(self, i: int, factor: float, found: float) -> float:
        """An offset with as few decimals of the column's own unit as leave no more than what was found."""
        columns = self.measured.independent
        same = [_Change("")] * len(columns)

        def left(more: float) -> float:
            return self.left([*same[:i], _Change("", factor, more), *same[i + 1 :]])

        least = left(found)
        for decimals in range(7):
            more = columns[i].factor * round(found / columns[i].factor, decimals)
            if left(more) <= CLOSE * least:
                return more
        return found

    @cached_property
    def _theirs(self) -> Array:
        return np.stack([s.values for s in self.measured.numbers])

    @cached_property
    def _spread(self) -> Array:
        with np.errstate(invalid="ignore"):
            wide = np.nanmax(self._theirs, axis=1) - np.nanmin(self._theirs, axis=1)
        return np.where(wide > 0.0, wide, 1.0)[:, None]

    def _gaps(self, values: Sequence[Array]) -> Array:
        """Theirs less ours, of the spread of theirs, (columns, rows); NaN where there is no pose."""
        places = self._places(values)
        part = self.scene.mechanism
        axes = CarAxes(np.array(part.up), np.array(part.right), part.outboard)
        ours = []
        for s in self.measured.numbers:
            angle = angle_of(s.meaning)
            if angle is None:
                place = places.get(s.meaning.name)
                ours.append(np.full(len(s.values), np.nan) if place is None else place[:, s.meaning.axis])
                continue
            start, end = (places[point] for point in angle.ends(part.topology))
            if s.definition == ARCSINE:
                line = end - start
                ours.append(np.arcsin(axes.component(line, angle.sine) / np.linalg.norm(line, axis=-1)))
            else:
                ours.append(angle.value(start, end, axes))
        gap = self._theirs - np.stack(ours)
        angles = np.array([s.meaning.unit == "rad" for s in self.measured.numbers])[:, None]
        turned = (gap + math.pi) % (2.0 * math.pi) - math.pi
        return np.asarray(np.where(angles, turned, gap) / self._spread)

    def _places(self, values: Sequence[Array]) -> Mapping[str, Array]:
        """Where every point is, (rows, 3)."""
        count = len(values[0])
        if any(s.meaning.kind == TRAVEL for s in self.measured.independent) or self.plan.level is not None:
            # The map that the file was held to reaches as far as the car does with a travel.
            assert isinstance(self.poses, OverMap)
            found = replace(self.poses, sloped=(), rated=()).at(values)
            nothing = np.full((count, 3), np.nan)
            topology = self.scene.mechanism.topology
            return dict(found.numbers.get(PLACES, dict.fromkeys(topology.points, nothing)))
        inputs = {name: np.full(count, value) for name, value in self.plan.held.items()}
        inputs |= {s.meaning.name: v for s, v in zip(self.measured.independent, values, strict=True)}
        told = np.ones(count, dtype=bool)
        for name, (low, high) in self._sensible.items():
            told &= (inputs[name] > low) & (inputs[name] < high)
            inputs[name] = np.where(told, inputs[name], self.plan.drawn[name])
        if told.mean() < NEARLY_ALL:
            return dict.fromkeys(self.scene.mechanism.topology.points, np.full((count, 3), np.nan))
        poses = solve_poses(self.scene, inputs)
        told &= poses.solved
        return {n: np.where(told[:, None], a, np.nan) for n, a in poses.position.items()}

    @cached_property
    def _sensible(self) -> dict[str, tuple[float, float]]:
        """Between which values inputs have a meaning and are no slip, as the map has it."""
        mechanism, found = scene_mechanism(self.scene), {}
        for name in mechanism.topology.required_inputs:
            wide, drawn = widest(mechanism, name), self.plan.drawn[name]
            found[name] = sensible(mechanism, name, (drawn - wide, drawn + wide))
        return found


def _unit_of(s: Series) -> str:
    """The unit that a column is said to be in."""
    return next((n for n, size in _units(s.meaning.unit) if math.isclose(size, s.factor)), s.meaning.unit)


def _units(unit: str) -> list[tuple[str, float]]:
    """Units of a kind by their first names, and their sizes in ours."""
    found: dict[float, str] = {}
    for name, size in KINDS[unit].items():
        found.setdefault(size, name)
    return [(name, size) for size, name in found.items()]
