"""Checks the arrays of a solution: usable ones are compared, and a line reports each of the others.

The solution may come from a user's solver. Data that are missing, have a wrong shape, belong to other
instants or are not real numbers are reported and ignored; the rest is compared.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from validate.formulations.protocol import Accuracy, FormulationError, Solution, shape_of

Array = NDArray[np.float64]
Arrays = dict[str, dict[str, Array]]


@dataclass(frozen=True)
class Given:
    """The part of a solution that can be compared.

    Attributes:
        found: which of the requested instants the solution has, (instants,).
        solution: the solution at these instants, with every quantity as a key even if it has no numbers. Its
            notes are those of the check, without the notes of the original solution.
    """

    found: NDArray[np.bool_]
    solution: Solution

    def at(self, instants: NDArray[np.bool_]) -> Solution:
        """The solution at a part of the instants that are found."""
        rows = instants[self.found]
        return self.solution if rows.all() else self.solution.at(rows)


def given_by_both(one: Solution, two: Solution, instants: Array) -> tuple[Array, Solution, Solution]:
    """The instants that both solutions have, and both solutions at these instants.

    Raises:
        FormulationError: see `given`.
    """
    first, second = given(one, instants), given(two, instants)
    both = first.found & second.found
    return np.asarray(instants)[both], first.at(both), second.at(both)


def given(solution: Solution, instants: Array) -> Given:
    """The usable part of a solution at instants, shape (N,), s.

    Raises:
        FormulationError: the solution lacks its instants or its accuracy.
    """
    who, notes, faults = solution.formulation, list[str](), [*solution.faults]
    if not isinstance(solution.accuracy, Accuracy):
        problem = f"its accuracy is a {type(solution.accuracy).__name__}; needed: an Accuracy"
        raise FormulationError(who, TypeError(problem))
    times = _real(solution.times)
    if isinstance(times, str) or times.ndim != 1:
        problem = times if isinstance(times, str) else f"have the shape {times.shape}"
        raise FormulationError(who, ValueError(f"its times {problem}; needed: one number for each instant"))
    own = solution.accuracy
    if len(own.condition) != len(times):
        problem = f"its accuracy is for {len(own.condition)} instants; needed: for its {len(times)} times"
        raise FormulationError(who, ValueError(problem))
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
            notes.append(f"{who}: {quantity!r} is not a quantity and is ignored; there are: {known}")
            continue
        words, shape = QUANTITIES[quantity].words, shape_of(quantity, len(times))
        claimed = own.claims.get(quantity, {})
        for name, raw in _by_name(given_part, f"{who}: {words}", faults).items():
            what = f"{who}: {words} of {name}"
            array = _shaped(raw, shape)
            if isinstance(array, str):
                faults.append(f"{what} {array}; it is ignored")
                continue
            finite = np.isfinite(array)
            wrong = 0 if finite.all() else int(np.sum(~finite.reshape(len(array), -1).all(axis=-1)))
            said = any(note.startswith(f"{words} of {name} ") for note in solution.notes)
            if wrong and not said:
                notes.append(f"{what} is not a number at {wrong} of {len(array)} instants")
            numbers[quantity][name] = array[places]
            if name in claimed:
                claims[quantity][name] = claimed[name][places]
            else:
                notes.append(f"{what}: its accuracy is not given")
    accuracy = replace(own.at(places), claims=claims)
    return Given(found, Solution(who, instants[found], numbers, accuracy, tuple(notes), tuple(faults)))


def usable(solution: Solution, instants: Array) -> Solution:
    """The solution that a comparison uses: at the requested instants that it has, with its usable numbers.

    Raises:
        FormulationError: see `given`.
    """
    side = given(solution, instants).solution
    numbers, claims = (
        {quantity: part for quantity, part in arrays.items() if part}
        for arrays in (side.numbers, side.accuracy.claims)
    )
    accuracy = Accuracy(side.accuracy.condition, claims, usual=side.accuracy.usual)
    return Solution(side.formulation, side.times, numbers, accuracy)


def _places(times: Array, instants: Array) -> tuple[NDArray[np.bool_], NDArray[np.intp] | slice]:
    """Which instants are among the times, (instants,), and the index into `times` of each of these."""
    if np.array_equal(times, instants) and (times[1:] > times[:-1]).all():
        return np.ones(len(instants), dtype=bool), slice(None)
    found = np.isin(instants, times)
    # Each instant takes the first row with its time: the stable sort keeps rows of equal time in order.
    order = np.argsort(times, kind="stable")
    return found, order[np.searchsorted(times, instants[found], side="left", sorter=order)]


def _by_name(part: object, what: str, faults: list[str]) -> Mapping[str, object]:
    """The mapping itself; for anything else a fault is added and an empty mapping returned."""
    if isinstance(part, Mapping):
        return part
    faults.append(f"{what} given as {type(part).__name__}; needed: arrays by name")
    return {}


def _shaped(raw: object, shape: tuple[int, ...]) -> Array | str:
    """The numbers as an array of the given shape, or what is wrong with them."""
    array = _real(raw)
    if isinstance(array, str) or array.shape == shape:
        return array
    return f"has the shape {array.shape}; needed: {shape}"


def _real(raw: object) -> Array | str:
    """The numbers as an array of doubles, or what is wrong with them."""
    try:
        array = np.asarray(raw)
    except (ValueError, TypeError) as error:
        return f"is not an array ({error})"
    if isinstance(raw, np.ma.MaskedArray) and (masked := int(np.sum(raw.mask))):
        return f"has {masked} masked entries; needed: numbers, or NaN where a number does not exist"
    if array.dtype.kind not in "iuf":
        return f"is of type {array.dtype}; needed: real numbers"
    return np.asarray(array, dtype=float)
