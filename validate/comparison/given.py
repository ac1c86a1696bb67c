"""What a formulation really gave: arrays that can be compared, and a line for everything that cannot.

A formulation may be anybody's. What is missing, has another shape, is given at other times or is no real
number is told and left out; the rest is compared.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from validate.formulations.protocol import Accuracy, FormulationError, Solution, shape_of

Array = NDArray[np.float64]
Arrays = dict[str, dict[str, Array]]


@dataclass(frozen=True)
class Given:
    """Numbers of one formulation at the instants asked for.

    Attributes:
        found: which of the instants it gives, (instants,); its arrays have a row for each of these.
        numbers: by quantity and name, (N, 3) or (N,).
        claims: how far each may be off, likewise; a name is missing where nothing is claimed of it.
        condition: condition number at each instant.
        blind: see `Accuracy.blind`.
        usual: see `Accuracy.usual`.
        notes: what the user should know of it. faults: what cannot be used and is left out, and why.
    """

    formulation: str
    found: NDArray[np.bool_]
    numbers: Arrays
    claims: Arrays
    condition: Array
    notes: tuple[str, ...]
    blind: NDArray[np.bool_] | None = None
    faults: tuple[str, ...] = ()
    usual: Mapping[str, Array] = field(default_factory=dict)

    def at(self, instants: NDArray[np.bool_]) -> Given:
        """The same at fewer instants, a part of those that are found."""
        rows = instants[self.found]
        if rows.all():
            return self
        numbers, claims = (
            {
                quantity: {name: array[rows] for name, array in part.items()}
                for quantity, part in arrays.items()
            }
            for arrays in (self.numbers, self.claims)
        )
        blind = None if self.blind is None else self.blind[rows]
        usual = {quantity: most[rows] for quantity, most in self.usual.items()}
        return replace(
            self,
            found=instants,
            numbers=numbers,
            claims=claims,
            condition=self.condition[rows],
            blind=blind,
            usual=usual,
        )


def given(solution: Solution, instants: Array) -> Given:
    """What a solution gives at instants, shape (N,).

    Raises:
        FormulationError: it does not say at which instants its numbers are, or nothing of its accuracy.
    """
    who, notes, faults = solution.formulation, list[str](), [*solution.faults]
    if not isinstance(solution.accuracy, Accuracy):
        problem = f"its accuracy is a {type(solution.accuracy).__name__}; needed: an Accuracy"
        raise FormulationError(who, TypeError(problem))
    times = _real(solution.times)
    if isinstance(times, str) or times.ndim != 1:
        problem = times if isinstance(times, str) else f"have the shape {times.shape}"
        raise FormulationError(who, ValueError(f"its times {problem}; needed: one number for each instant"))
    found, places = _places(times, instants)
    if not found.all():
        notes.append(
            f"{who} gives {int(found.sum())} of {len(instants)} instants; the others are not compared"
        )
    numbers: Arrays = {quantity: {} for quantity in QUANTITIES}
    claims: Arrays = {quantity: {} for quantity in QUANTITIES}
    for quantity, given_part in _by_name(solution.numbers, f"{who}: its numbers", faults).items():
        if quantity not in QUANTITIES:
            known = ", ".join(QUANTITIES)
            notes.append(f"{who}: {quantity!r} is no quantity and is left out; there are: {known}")
            continue
        words, shape = QUANTITIES[quantity].words, shape_of(quantity, len(times))
        claimed = solution.accuracy.claims.get(quantity, {})
        for name, raw in _by_name(given_part, f"{who}: {words}", faults).items():
            what = f"{who}: {words} of {name}"
            array = _shaped(raw, shape)
            if isinstance(array, str):
                faults.append(f"{what} {array}; it is left out")
                continue
            finite = np.isfinite(array)
            wrong = 0 if finite.all() else int(np.sum(~finite.reshape(len(array), -1).all(axis=-1)))
            said = any(note.startswith(f"{words} of {name} ") for note in solution.notes)
            if wrong and not said:
                notes.append(f"{what} is not a number at {wrong} of {len(array)} instants")
            numbers[quantity][name] = array[places]
            claim = _shaped(claimed[name], shape) if name in claimed else "is not given"
            if isinstance(claim, str):
                notes.append(f"{what}: its accuracy {claim}")
            else:
                claims[quantity][name] = claim[places]
    condition = _shaped(solution.accuracy.condition, times.shape)
    if isinstance(condition, str):
        notes.append(f"{who}: its condition number {condition}; 1 is taken")
        condition = np.ones_like(times)
    blind = None if solution.accuracy.blind is None else solution.accuracy.blind[places]
    usual = {quantity: most[places] for quantity, most in solution.accuracy.usual.items()}
    return Given(who, found, numbers, claims, condition[places], tuple(notes), blind, tuple(faults), usual)


def usable(solution: Solution, instants: Array) -> Solution:
    """A solution as a comparison takes it: at those of the instants that it gives, without what is no number.

    Raises:
        FormulationError: see `given`.
    """
    side = given(solution, instants)
    numbers, claims = (
        {quantity: part for quantity, part in arrays.items() if part}
        for arrays in (side.numbers, side.claims)
    )
    return Solution(
        side.formulation, instants[side.found], numbers, Accuracy(side.condition, claims, usual=side.usual)
    )


def _places(times: Array, instants: Array) -> tuple[NDArray[np.bool_], NDArray[np.intp] | slice]:
    """Which instants are among the times, and the place of each of these there."""
    if np.array_equal(times, instants) and (times[1:] > times[:-1]).all():
        return np.ones(len(instants), dtype=bool), slice(None)
    found = np.isin(instants, times)
    # For each instant found the first place of its time: sorting keeps those of one time in their order.
    order = np.argsort(times, kind="stable")
    return found, order[np.searchsorted(times, instants[found], side="left", sorter=order)]


def _by_name(part: object, what: str, faults: list[str]) -> Mapping[str, object]:
    """A mapping as it is; what is none is told and empty."""
    if isinstance(part, Mapping):
        return part
    faults.append(f"{what} given as {type(part).__name__}; needed: arrays by name")
    return {}


def _shaped(raw: object, shape: tuple[int, ...]) -> Array | str:
    """An array of a shape, or what is wrong with it."""
    array = _real(raw)
    if isinstance(array, str) or array.shape == shape:
        return array
    return f"has the shape {array.shape}; needed: {shape}"


def _real(raw: object) -> Array | str:
    """Real numbers in doubles, or what is wrong with them."""
    try:
        array = np.asarray(raw)
    except (ValueError, TypeError) as error:
        return f"is no array ({error})"
    if isinstance(raw, np.ma.MaskedArray) and (masked := int(np.sum(raw.mask))):
        return f"has {masked} masked entries; needed: numbers, NaN where there are none"
    if array.dtype.kind not in "iuf":
        return f"is of type {array.dtype}; needed: real numbers"
    return np.asarray(array, dtype=float)
