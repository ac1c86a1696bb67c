"""What a file may be meant as: a column of another sign, unit, size or zero, another held value or travel.

The numbers of a row say themselves at which input it is: Gauss and Newton's method finds the input whose pose
has them. Over the rows of the file an input x so found is a straight line x = k v + c over its column v, of
one that every row has it is a constant, and where the travel of another point was meant the heights of that
point at these poses are v. What is found at some rows is held to the whole file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.simulation import scene_mechanism
from validate.diagnosis.least import roundest
from validate.measured.mapping import Measured, Series
from validate.measured.meanings import CONTACT, INPUT, PLACES, TIME, Meaning
from validate.measured.poses import Driven, Found, height_of, input_of, of_a_pose, ours_of, widest
from validate.measured.tolerances import Held, held_of
from validate.plain_text import shown
from validate.tables.units import ANGLES, KINDS, named

Array = NDArray[np.float64]

ROWS = 16  # that inputs are found at
NEARLY_ALL = 0.8  # of them must be in reach
# Of an input's range: of differences, the longest step, and where steps end.
STEP, LONGEST, ENDS = 1e-6, 0.1, 1e-9
STEPS = 25
# What inputs that are found may leave of the differences, of the numbers' own spread.
PROMISING = 0.05
# Tolerances that a supposition may leave of the whole file: least squares make no largest difference least.
NEARLY = 1.5
# By what round numbers may leave more than those that were found, and that in parts of the input's own size.
CLOSE, ROUNDING = 1.2, 1e-6


@dataclass(frozen=True)
class Supposed:
    """A file that is meant otherwise.

    Attributes:
        kind: travel, of another point, or input.
        leftover: the largest difference that is left of the whole file, in its tolerance.
    """

    words: str
    measured: Measured
    kind: str = "input"
    leftover: float = math.inf


def meant_otherwise(
    scene: Scene,
    measured: Measured,
    held: Sequence[Held],
    accuracy: float | None,
    factor: float,
    driven: Driven,
) -> Supposed | None:
    """What explains the whole file: another travel, or else a change of its columns or held inputs."""
    for one in suppositions(scene, measured, driven):
        try:
            other = held_of(one.measured, scene, accuracy)[0]
        except PointcoordError:
            continue
        shares = np.stack([h.share for h in other])
        leftover = float(np.nanmax(shares, initial=0.0)) / factor
        # Fewer rows that agree are no explanation of those that are out of reach then.
        kept = np.isfinite(shares).any() and (one.kind == "travel" or _reached(other) >= _reached(held))
        if kept and leftover <= NEARLY:
            more = f"; this leaves {leftover:.3g} times what is tolerated" if leftover > 1.0 else ""
            return replace(one, words=one.words + more, leftover=leftover)
    return None


def suppositions(scene: Scene, measured: Measured, driven: Driven) -> Iterator[Supposed]:
    """What a file may be meant as, by some of its rows; of one over time nothing."""
    if measured.independent[0].meaning.kind == TIME:
        return
    rows = np.zeros(len(measured.rows), dtype=bool)
    rows[np.unique(np.linspace(0, len(rows) - 1, ROWS).astype(int))] = True
    numbers = tuple(s for s in measured.numbers if of_a_pose(s.meaning))
    some = replace(measured, numbers=numbers).taken(rows)
    yield from _other_travel(scene, measured, driven, some)
    columns = {input_of(s.meaning.words): i for i, s in enumerate(measured.independent)}
    held = [n for n in driven.scene.mechanism.topology.inputs if n in driven.said or n in driven.as_drawn]
    for names in dict.fromkeys([*((name,) for name in (*columns, *held)), tuple(columns)]):
        if (found := _implied(driven, some, names)) is None:
            continue
        if names[0] not in columns:
            yield from _other_value(measured, driven, names[0], found.inputs[names[0]])
            continue
        changes = {columns[n]: _change(some.independent[columns[n]], found.inputs[n], driven) for n in names}
        yield from _changed(measured, {i: change for i, change in changes.items() if change is not None})


def _reached(held: Sequence[Held]) -> int:
    """How many rows have numbers of ours."""
    return int(np.isfinite([h.ours for h in held]).any(axis=0).sum())


def _implied(driven: Driven, some: Measured, names: Sequence[str]) -> Found | None:
    """The poses that some rows' numbers come from, the other inputs being as said; None if there are none."""
    if len(some.numbers) < len(names):
        return None
    here, _ = driven.inputs([s.values for s in some.independent])
    theirs = np.stack([s.values for s in some.numbers])
    wide = np.nanmax(theirs, axis=1, initial=-np.inf) - np.nanmin(theirs, axis=1, initial=np.inf)
    wide_of = {name: widest(scene_mechanism(driven.scene), name) for name in names}
    ends = [driven.sensible.get(name, (-wide, wide)) for name, wide in wide_of.items()]
    low, high = np.array(ends).T[..., None]
    size, start = high - low, np.array([[driven.drawn.get(name, 0.0)] for name in names])

    def at(x: Array) -> tuple[Found, Array]:
        """Our numbers there, and how far they are from theirs, of their spread, (columns, rows)."""
        found = driven.solved(here | dict(zip(names, x, strict=True)), {})
        ours = [np.asarray(ours_of(s, found, driven.scene)[0]) for s in some.numbers]
        apart = [s.apart(one, s.values) for s, one in zip(some.numbers, ours, strict=True)]
        return found, np.stack(apart) / np.where(wide > 0.0, wide, 1.0)[:, None]

    x = np.repeat(start, len(some.rows), axis=1)
    try:
        for _ in range(STEPS):
            gap = at(x)[1]
            moved = [(at(x + one[:, None] * STEP * size)[1] - gap) / STEP for one in np.eye(len(names))]
            slopes = np.nan_to_num(np.stack(moved, axis=-1)).swapaxes(0, 1)
            step = np.einsum("ndc,cn->dn", np.linalg.pinv(slopes, rcond=1e-6), np.nan_to_num(gap))
            x = np.clip(x - size * np.clip(step, -LONGEST, LONGEST), low, high)
            if np.abs(step).max() <= ENDS:
                break
        found, gap = at(x)
    except PointcoordError:
        return None
    there = np.isfinite(gap).any(axis=0)
    if there.mean() < NEARLY_ALL or np.sqrt(np.nanmean(gap**2)) > PROMISING:
        return None
    counted = {n: one - driven.level(n) for n, one in zip(names, x, strict=True)}
    return replace(found, inputs={n: np.where(there, one, np.nan) for n, one in counted.items()})


# A column is a straight line.


@dataclass(frozen=True)
class _Change:
    """x = factor v + more of a column v."""

    factor: float
    more: float
    words: str


def _change(s: Series, x: Array, driven: Driven) -> _Change | None:
    """The simplest line that x follows as well as the best one; None where the column is as it is said."""
    some = np.isfinite(x) & np.isfinite(s.values)
    v, x = s.values[some], x[some]
    if len(v) < 2 or not np.ptp(v):
        return None
    slope, more = np.polyfit(v, x, 1).tolist()

    def left(factor: float, more: float) -> float:
        return float(np.sqrt(np.mean((factor * v + more - x) ** 2)))

    def zero_of(factor: float) -> float:
        return float(np.mean(x - factor * v))

    enough = CLOSE * left(slope, more) + ROUNDING * float(np.ptp(x))
    known = [sign * size / s.factor for size in KINDS[s.meaning.unit].values() for sign in (1.0, -1.0)]
    near = min(known, key=lambda one: abs(one - slope))
    if left(near, zero_of(near)) > enough:
        near = 1.0 / _round(1.0 / slope, lambda one: left(1.0 / one, zero_of(1.0 / one)) <= enough)
    factor = round(near) if math.isclose(abs(near), 1.0) else near
    drawn = driven.drawn.get(s.meaning.name, 0.0) if s.meaning.kind == INPUT else 0.0
    unit = ANGLES["deg"] if s.meaning.unit == "rad" else s.factor
    more = next(
        (one for one in (0.0, drawn) if left(factor, one) <= enough),
        _round(zero_of(factor), lambda one: left(factor, one) <= enough, unit),
    )
    said, other = named(s.factor, s.meaning.unit), named(abs(factor) * s.factor, s.meaning.unit)
    parts = [f"is in {other}, not in {said}" if other else f"is {abs(1.0 / factor):.6g} times ours"]
    parts = [*(parts if other != said else []), *(["has the other sign"] if factor < 0.0 else [])]
    if more == drawn != 0.0:
        parts.append("counts from the drawing on")
    elif more:
        parts.append(f"counts from another zero: {more / unit:+.5g} {named(unit, s.meaning.unit)} make ours")
    return _Change(factor, more, f"{shown(s.column)} {', and '.join(parts)}") if parts else None


def _round(found: float, fits: Callable[[float], bool], unit: float = 1.0) -> float:
    """A number as round as may be."""
    return float(roundest(found, 7, lambda near: bool(near) and fits(float(near)), unit))


def _changed(measured: Measured, changes: Mapping[int, _Change]) -> Iterator[Supposed]:
    """A file whose columns are changed; derivatives by one that counts the other way do so too."""
    columns = list(measured.independent)
    for i, change in changes.items():
        s = columns[i]
        columns[i] = replace(s, values=change.factor * s.values + change.more, off=abs(change.factor) * s.off)
    turned = {columns[i].meaning.words for i, change in changes.items() if change.factor < 0.0}
    numbers = (replace(s, values=-s.values) if s.meaning.per in turned else s for s in measured.numbers)
    if changes:
        words = ", and ".join(change.words for change in changes.values())
        yield Supposed(words, replace(measured, independent=tuple(columns), numbers=tuple(numbers)))


def _other_value(measured: Measured, driven: Driven, name: str, x: Array) -> Iterator[Supposed]:
    """An input that is the same in every row, at the value that the numbers come from."""
    some, unit = x[np.isfinite(x)], driven.scene.mechanism.topology.input_units[name]
    mean, enough = float(np.mean(some)), CLOSE * float(np.std(some)) + ROUNDING * float(np.abs(some).max())
    value = _round(mean, lambda one: abs(one - mean) <= enough, ANGLES["deg"] if unit == "rad" else 1.0)
    was = driven.said.get(name, driven.drawn.get(name, 0.0))
    words = f"{name} is {value:.6g} {unit} in every row, not {was:.6g}"
    yield Supposed(words, replace(measured, held={**measured.held, f"{INPUT}.{name}": value}))


# The travel of the wheel's centre, or of the contact.


def _other_travel(scene: Scene, measured: Measured, driven: Driven, some: Measured) -> Iterator[Supposed]:
    """The travel of the wheel's centre for that of the contact, or the other way.

    A contact's travel is v = z - R g, z that of the centre and R g what its lowest point lies less far below.
    Where no rolling radius R is said it is the one of least squares.
    """
    centre, part = scene.mechanism.topology.wheel_centre, scene.mechanism
    of_wheel = {one: one for one in (CONTACT, centre) if one}
    for name, table in part.plain(tuple(scene.inputs))["inputs"].items():
        if centre and table.get("height") == centre:
            of_wheel[name] = centre
        if table.get("contact") and table.get("over", CHASSIS) == CHASSIS:
            of_wheel[name] = CONTACT
    said = next((s for s in some.independent if s.meaning.name in of_wheel), None)
    found = _implied(driven, some, [input_of(said.meaning.words)]) if said else None
    if said is None or found is None or not part.topology.wheel_axis:
        return
    other = Meaning("travel", CONTACT if of_wheel[said.meaning.name] == centre else centre, "mm")
    radius, of = measured.rolling_radius, ""
    if other.name == CONTACT:
        if not radius > 0.0:
            there, home = found.numbers[PLACES], driven.home
            z, low = (
                height_of(part, CONTACT, size, there) - height_of(part, CONTACT, size, home)
                for size in (0.0, 1.0)
            )
            some_rows = np.isfinite(z + said.values)
            v, z, g = said.values[some_rows], z[some_rows], (z - low)[some_rows]
            best = float((z - v) @ g / (g @ g)) if g.any() else 0.0
            enough = CLOSE * float(np.linalg.norm(z - best * g - v)) + ROUNDING * float(np.ptp(v))
            radius = _round(best, lambda one: float(np.linalg.norm(z - one * g - v)) <= enough)
        of = f" with a rolling radius of {radius:.4g} mm"
    words = f"{shown(said.column)} is {other.words}{of}, not {said.meaning.words}"
    columns = (replace(s, meaning=other) if s.column == said.column else s for s in measured.independent)
    yield Supposed(words, replace(measured, independent=tuple(columns), rolling_radius=radius), "travel")
