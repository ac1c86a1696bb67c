"""What a file may be meant as: its independent columns of another sign, unit or zero, or another travel.

A column v of an input or a travel is supposed to be x = k v + c in ours, with k 1, -1, or what makes another
unit of it, and c 0, the drawn input, pi of an angle that counts the other way, or found by least squares of
the file's places and angles; or the travel of the wheel's centre to be that of the contact, or the other way.
Poses are solved at some rows; what leaves little there is held to the whole file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from pointcoord import PointcoordError, Scene
from pointcoord.mechanism.inputs import CHASSIS
from validate.diagnosis.least import fitted, roundest
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import CONTACT, INPUT, TIME, Meaning
from validate.measured.poses import Driven, of_a_pose, ours_of
from validate.measured.tolerances import Held, held_of
from validate.plain_text import shown
from validate.tables.units import ANGLES, KINDS, named

Array = NDArray[np.float64]

ROWS = 16  # that poses are solved at
NEARLY_ALL = 0.8  # of them must be in reach
STEP = {"rad": 1e-5, "mm": 1e-3}  # of differences by an offset
RADII = (50.0, 1500.0)  # mm, of wheels
# What a supposition may leave of the differences, of the numbers' own spread, to be held to the whole file.
PROMISING = 0.05
# Suppositions on a column that the whole file is held to; of several columns a map takes long.
TRIED = 3
# How much an offset that least squares found may leave: the largest difference is the least near it only.
NEARLY = 1.5
# By what a rounded offset may leave more than the found one, which least squares put lowest.
CLOSE = 1.1
# Of a found factor: how near to a unit's it is meant to be that one's.
NEARLY_UNIT = 1e-2
# Of a found offset: how near to a known one it is meant to be that.
NEAR = 1e-3


@dataclass(frozen=True)
class Supposed:
    """A file that is meant otherwise.

    Attributes:
        kind: travel, of another point, or input. found: whether an offset was fitted to it.
        leftover: the largest difference that is left of the whole file, in its tolerance.
    """

    words: str
    measured: Measured
    kind: str = "input"
    found: bool = False
    leftover: float = math.inf


@dataclass(frozen=True)
class _Change:
    """x = factor v + more of a column v; `found` of one of which either was found by least squares."""

    factor: float = 1.0
    more: float = 0.0
    found: bool = False

    @property
    def cost(self) -> float:
        """How far-fetched it is."""
        return (abs(self.factor) != 1.0) + (self.factor < 0.0) + 1.1 * (self.more != 0.0) + 2.0 * self.found

    def of(self, s: Series) -> Series:
        """A column that is changed so."""
        return replace(s, values=self.factor * s.values + self.more, off=abs(self.factor) * s.off)

    def words(self, s: Series, drawn: float) -> str:
        """What is said of the column."""
        if (self.factor, self.more) == (-1.0, math.pi):
            return f"{shown(s.column)} is pi minus ours"
        said, turned = _unit_of(s), self.factor < 0.0
        if self.found and not self.more:
            return f"{shown(s.column)} is {1.0 / self.factor:.6g} times ours"
        other = _unit_of(replace(s, factor=abs(self.factor) * s.factor))
        parts = [] if other == said else [f"is in {other}, not in {said}"]
        if not self.more:
            parts += ["has the other sign"] * turned
        elif abs(self.more - drawn) <= NEAR * abs(drawn):
            parts.append("counts from the drawing on" + ", the other way" * turned)
        else:
            parts += ["counts the other way"] * turned
            missing = "missing" if self.more > 0.0 else "too many"
            parts.append(f"counts from another zero: {abs(self.more / s.factor):.5g} {said} are {missing}")
        return f"{shown(s.column)} {', and '.join(parts)}"


Changes = dict[int, _Change]
"""What some columns are changed by, by their places."""


def meant_otherwise(
    scene: Scene,
    measured: Measured,
    held: Sequence[Held],
    accuracy: float | None,
    factor: float,
    driven: Driven,
) -> list[Supposed]:
    """What explains the whole file: another travel, and the likeliest change of its columns, if any does."""
    likeliest = islice(_likely(driven, measured), TRIED if len(measured.independent) == 1 else 1)
    found = []
    suppositions_of = (_other_travel(scene, measured, held), likeliest, _other_held(measured, driven))
    for suppositions in suppositions_of:
        for one in suppositions:
            try:
                other = held_of(one.measured, scene, accuracy)[0]
            except PointcoordError:
                continue
            shares = np.stack([h.share for h in other])
            leftover = float(np.nanmax(shares, initial=0.0)) / factor
            # Fewer rows that agree are no explanation of those that are out of reach then.
            kept = np.isfinite(shares).any() and (one.kind == "travel" or _reached(other) >= _reached(held))
            if kept and leftover <= (NEARLY if one.found else 1.0):
                more = f"; this leaves {leftover:.3g} times what is tolerated" if leftover > 1.0 else ""
                found.append(replace(one, words=one.words + more, leftover=leftover))
                break
    return found


def meant(measured: Measured, driven: Driven) -> str:
    """What the columns that rows are taken by may be meant as, in words; empty if nothing is likely.

    Where no number tells, a unit that brings nearly all rows within reach, nearest the said one first.
    """
    if known := next(_likely(driven, measured), None):
        return known.words
    some = _some(measured)
    for i, s in enumerate(some.independent):
        for size in sorted(_sizes(s), key=lambda size: abs(math.log(size / s.factor))):
            change = _Change(size / s.factor)
            values = [v.values for v in _moved(some, {i: change})]
            out = len(driven.inputs(values)[1]) > (1.0 - NEARLY_ALL) * len(some.rows)
            if abs(change.factor - 1.0) <= 1e-9 or out:
                continue
            if s.meaning.kind == TIME or driven.poses(values).reached.mean() >= NEARLY_ALL:
                return change.words(s, 0.0)
    return ""


def _reached(held: Sequence[Held]) -> int:
    """How many rows have numbers of ours."""
    return int(np.isfinite([h.ours for h in held]).any(axis=0).sum())


def _other_travel(scene: Scene, measured: Measured, held: Sequence[Held]) -> Iterator[Supposed]:
    """The travel of the wheel's centre for that of the contact, or the other way.

    Where no rolling radius is said it is the one that leaves least of poses.
    """
    centre, heights = scene.mechanism.topology.wheel_centre, _travels(scene)
    said = next((s for s in measured.independent if s.meaning.name in heights), None)
    if said is None:
        return
    other = Meaning("travel", centre if heights[said.meaning.name] == CONTACT else CONTACT, "mm")
    independent = tuple(replace(s, meaning=other) if s is said else s for s in measured.independent)

    def by(radius: float) -> Measured:
        return replace(measured, independent=independent, rolling_radius=radius)

    def left(radius: float) -> float:
        """The largest difference in its tolerance, of poses alone."""
        found = Driven.of(scene, by(radius)).poses([s.values for s in independent], measured.numbers)
        there = (h for h in held if of_a_pose(h.series.meaning))
        shares = [replace(h, ours=np.asarray(ours_of(h.series, found, scene)[0])).share for h in there]
        return float(np.max(np.nan_to_num(shares), initial=0.0))

    radius, of = measured.rolling_radius, ""
    if other.name == CONTACT:
        if not radius > 0.0:
            try:
                radius = float(minimize_scalar(left, bounds=RADII, options={"xatol": 0.1}).x)
            except PointcoordError:
                return
        of = f" with a rolling radius of {radius:.4g} mm"
    words = f"{shown(said.column)} is {other.words}{of}, not {said.meaning.words}"
    yield Supposed(words, by(radius), "travel")


def _other_held(measured: Measured, driven: Driven) -> Iterator[Supposed]:
    """Each input that is the same in every row, at the value that least squares find."""
    some, units = _some(measured), driven.scene.mechanism.topology.input_units
    if measured.independent[0].meaning.kind == TIME or not some.numbers:
        return
    held = {name: driven.drawn[name] for name in driven.as_drawn} | dict(driven.said)
    for name in (name for name in driven.scene.mechanism.topology.inputs if name in held):

        def gaps(value: float, name: str = name) -> Array:
            return _gaps(replace(driven, said={**driven.said, name: value}), some, {})

        best, least = _least_squares(gaps, [held[name]], STEP[units[name]])
        if math.isfinite(least):
            value = _rounded(gaps, best, NEARLY * least, ANGLES["deg"] if units[name] == "rad" else 1.0)
            words = f"{name} is {value:.6g} {units[name]} in every row, not {held[name]:.6g}"
            other = replace(measured, held={**measured.held, f"{INPUT}.{name}": value})
            yield Supposed(words, other, found=True)


def _travels(scene: Scene) -> dict[str, str]:
    """The travels and inputs that are one of the wheel's, with what travels: its centre or the contact."""
    part = scene.mechanism
    found = {one: one for one in (CONTACT, part.topology.wheel_centre) if one}
    for name, table in part.plain(tuple(scene.inputs))["inputs"].items():
        if table.get("height") == part.topology.wheel_centre and part.topology.wheel_centre:
            found[name] = part.topology.wheel_centre
        if table.get("contact") and table.get("over", CHASSIS) == CHASSIS:
            found[name] = CONTACT
    return found


def _likely(driven: Driven, measured: Measured) -> Iterator[Supposed]:
    """The likeliest suppositions, what is known beforehand before what is found; none over time."""
    if measured.independent[0].meaning.kind == TIME or not any(
        of_a_pose(s.meaning) for s in measured.numbers
    ):
        return
    some = _some(measured)
    try:
        before = _rms(_gaps(driven, some, {}))
        tried = [(_rms(_gaps(driven, some, changes)), changes) for changes in _changes(driven, some)]
    except PointcoordError:
        return
    kept = [(left, changes) for left, changes in tried if left <= PROMISING and left < before]
    # Simple before far-fetched, where both leave as little as the digits of a file allow.
    kept.sort(key=lambda one: (math.floor(math.log10(one[0] + 1e-12)), sum(c.cost for c in one[1].values())))
    for _, changes in kept:
        said = ((measured.independent[i], change) for i, change in changes.items())
        words = ", and ".join(change.words(s, _drawn(driven, s)) for s, change in said)
        independent = _moved(measured, changes)
        # Derivatives by a column that counts the other way do so too.
        turned = {independent[i].meaning.words for i, change in changes.items() if change.factor < 0.0}
        numbers = (replace(s, values=-s.values) if s.meaning.per in turned else s for s in measured.numbers)
        other = replace(measured, independent=independent, numbers=tuple(numbers))
        yield Supposed(words, other, found=any(one.found for one in changes.values()))


def _changes(driven: Driven, some: Measured) -> Iterator[Changes]:
    """What each column may be changed by: one alone, all with the other sign, one by another zero."""
    for i, s in enumerate(some.independent):
        factors = [sign * size / s.factor for size in _sizes(s) for sign in (1.0, -1.0)]
        zeros = {0.0, _drawn(driven, s)}
        changes = [_Change(1.0 if math.isclose(f, 1.0) else f, more) for f in factors for more in zeros]
        changes += [_Change(-1.0, math.pi)] if s.meaning.unit == "rad" else []
        yield from ({i: change} for change in changes if change != _Change())
    yield {i: _Change(-1.0) for i in range(len(some.independent))}
    for i in range(len(some.independent)):
        for sign in (1.0, -1.0):
            yield from _other_zero(driven, some, i, sign)
        yield from _other_size(driven, some, i)


def _moved(measured: Measured, changes: Changes) -> tuple[Series, ...]:
    """The independent columns, some of them changed."""
    return tuple(changes.get(i, _Change()).of(s) for i, s in enumerate(measured.independent))


def _some(measured: Measured) -> Measured:
    """Some of its rows, evenly, and of its numbers those that a pose has."""
    rows = np.zeros(len(measured.rows), dtype=bool)
    rows[np.unique(np.linspace(0, len(rows) - 1, ROWS).astype(int))] = True
    numbers = tuple(s for s in measured.numbers if of_a_pose(s.meaning))
    return replace(measured, numbers=numbers).taken(rows)


def _drawn(driven: Driven, s: Series) -> float:
    """An input of the drawing; a travel counts from there by itself."""
    return driven.drawn.get(s.meaning.name, 0.0) if s.meaning.kind == INPUT else 0.0


def _gaps(driven: Driven, some: Measured, changes: Changes) -> Array:
    """Theirs less ours, of the spread of theirs, (columns, rows); NaN where most rows have no pose."""
    values = [s.values for s in _moved(some, changes)]
    gap = np.full((len(some.numbers), len(some.rows)), np.nan)
    if len(driven.inputs(values)[1]) > (1.0 - NEARLY_ALL) * len(some.rows):
        return gap
    found = driven.poses(values, some.numbers)
    for i, s in enumerate(some.numbers):
        ours, _ = ours_of(s, found, driven.scene)
        if ours is not None:
            wide = np.nanmax(s.values, initial=-np.inf) - np.nanmin(s.values, initial=np.inf)
            gap[i] = s.apart(ours, s.values) / (wide if wide > 0.0 else 1.0)
    # A supposition must make sense of nearly all rows.
    there = np.isfinite([s.values for s in some.numbers])
    enough = (np.isfinite(gap) | ~there).all(axis=0).mean() >= NEARLY_ALL
    return gap if enough else np.full_like(gap, np.nan)


def _rms(gap: Array) -> float:
    """What is left of the differences, of their numbers' spread; infinite where rows are out of reach."""
    return float(np.sqrt(np.nanmean(gap**2))) if np.isfinite(gap).any() else math.inf


def _least_squares(
    gaps: Callable[[float], Array], begins: Iterable[float], step: float
) -> tuple[float, float]:
    """The number that makes gaps least, and what it leaves; infinite where that is much of them."""

    def read(sets: Array) -> Array:
        found = [gaps(float(one)).ravel() for (one,) in sets]
        # Rows out of reach say nothing of it.
        return np.stack([np.nan_to_num(gap) if np.isfinite(gap).any() else gap for gap in found])

    ends = (fitted(read, [begin], step, np.zeros(1)) for begin in begins)
    found = [(float(end[0]), _rms(gaps(float(end[0])))) for end in ends if end is not None]
    return min(found, key=lambda one: one[1], default=(math.nan, math.inf))


def _rounded(gaps: Callable[[float], Array], found: float, enough: float, unit: float) -> float:
    """A found number as round as it may be."""
    return float(roundest(found, 7, lambda near: _rms(gaps(float(near))) <= enough, unit))


def _other_zero(driven: Driven, some: Measured, i: int, factor: float) -> Iterator[Changes]:
    """The zero that least squares find for a column, as round as it may be, if one comes near."""
    s = some.independent[i]

    def gaps(more: float) -> Array:
        return _gaps(driven, some, {i: _Change(factor, more)})

    best, least = _least_squares(gaps, {0.0, _drawn(driven, s)}, STEP[s.meaning.unit])
    if least <= PROMISING:
        yield {i: _Change(factor, _rounded(gaps, best, CLOSE * least, s.factor), found=True)}


def _other_size(driven: Driven, some: Measured, i: int) -> Iterator[Changes]:
    """The factor that least squares find for a column, a unit's own where it is nearly one."""
    s = some.independent[i]

    def gaps(factor: float) -> Array:
        return _gaps(driven, some, {i: _Change(factor)})

    best, least = _least_squares(gaps, [1.0], 1e-4)
    if least <= PROMISING and abs(best) >= 1e-6:
        times = 1.0 / best
        ratios = [sign * size / s.factor for size in _sizes(s) for sign in (1.0, -1.0)]
        near = [one for one in ratios if abs(one - times) <= NEARLY_UNIT * abs(one)]
        near.append(float(roundest(times, 7, lambda one: abs(float(one) - times) <= NEAR * abs(times))))
        fitting = (one for one in near if _rms(gaps(1.0 / one)) <= CLOSE * least)
        yield {i: _Change(1.0 / next(fitting, times), found=True)}


def _sizes(s: Series) -> list[float]:
    """The units that a column can be in, each in ours."""
    return [*dict.fromkeys(KINDS[s.meaning.unit].values())]


def _unit_of(s: Series) -> str:
    """The unit that a column is said to be in, by its first name."""
    return named(s.factor, s.meaning.unit) or s.meaning.unit
