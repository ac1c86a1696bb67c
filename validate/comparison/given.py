"""Checks the arrays of a solution: usable ones are compared, and a line reports each of the others.

The solution may come from a user's solver. Data that are missing, have a wrong shape, belong to other
instants or are not real numbers are reported and ignored; the rest is compared.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from validate.arrays import Array
from validate.formulations.protocol import Accuracy, FormulationError, Places, Solution, shape_of
from validate.plain_text import counted_as, shown

Arrays = dict[str, dict[str, Array]]


def given_by_both(one: Solution, two: Solution, instants: Array) -> tuple[Array, Solution, Solution]:
    """The instants that both solutions have, and both solutions at these instants.

    Raises:
        FormulationError: see `given`.
    """
    first, second = given(one, instants), given(two, instants)
    if not np.array_equal(first.times, second.times):
        _, mine, others = np.intersect1d(first.times, second.times, return_indices=True)
        first, second = first.at(mine), second.at(others)
    return first.times, first, second


def given(solution: Solution, instants: Array) -> Solution:
    """The usable part of a solution at those of the instants, (N,), s, that it has.

    Returns:
        A solution with every quantity as a key, even if it has no numbers. Its notes are those of this check,
        without the notes of the original solution.
    Raises:
        FormulationError: the solution lacks its instants or its accuracy.
    """
    who, notes, faults = solution.formulation, list[str](), [*solution.faults]
    if not isinstance(solution.accuracy, Accuracy):
        problem = f"its accuracy is of type {type(solution.accuracy).__name__}; needed: an Accuracy"
        raise FormulationError(who, TypeError(problem))
    own, times = solution.accuracy, _real(solution.times)
    problem = times if isinstance(times, str) else f"have the shape {np.shape(times)}"
    if isinstance(times, str) or times.ndim != 1:
        raise FormulationError(who, ValueError(f"its times {problem}; needed: one number for each instant"))
    if len(own.condition) != len(times):
        problem = f"its accuracy is for {counted_as(len(own.condition), 'instant')}; needed: {len(times)}"
        raise FormulationError(who, ValueError(problem))
    common: Array = instants
    places: Places = slice(None)
    if not np.array_equal(times, instants):
        common, _, places = np.intersect1d(instants, times, return_indices=True)
    again = _first_rows(times)
    if len(common) < len(instants):
        notes.append(f"{who} gives {len(common)} of {len(instants)} instants; the others are not compared")
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
            array = _real(raw, shape)
            if isinstance(array, str):
                faults.append(f"{what} {array}; it is ignored")
                continue
            # Each of two rows with one time may be off by its own error bound.
            bound = claimed.get(name, np.zeros_like(array))
            with np.errstate(invalid="ignore"):
                apart = np.abs(array - array[again]) > bound + bound[again]
            other = apart.reshape(len(array), -1).any(axis=-1)
            if other.any():
                when = f"{times[np.argmax(other)]:g} s"
                faults.append(f"{what} has different numbers at one instant, {when}; it is ignored")
                continue
            wrong = int((~np.isfinite(array)).reshape(len(array), -1).any(axis=-1).sum())
            said = any(note.startswith(f"{words} of {name} ") for note in solution.notes)
            if wrong and not said:
                notes.append(f"{what} is not a number at {wrong} of {len(array)} instants")
            numbers[quantity][name] = array[places]
            if name in claimed:
                claims[quantity][name] = claimed[name][places]
            else:
                notes.append(f"{what}: its accuracy is not given")
    accuracy = replace(own.at(places), claims=claims)
    return Solution(who, common, numbers, accuracy, tuple(notes), tuple(faults))


def usable(solution: Solution, instants: Array) -> Solution:
    """The solution that a comparison uses: at the requested instants that it has, with its usable numbers.

    Raises:
        FormulationError: see `given`.
    """
    side = given(solution, instants)
    numbers = {quantity: part for quantity, part in side.numbers.items() if part}
    claims = {quantity: part for quantity, part in side.accuracy.claims.items() if part}
    accuracy = Accuracy(side.accuracy.condition, claims, usual=side.accuracy.usual)
    return Solution(side.formulation, side.times, numbers, accuracy)


def _first_rows(times: Array) -> Places:
    """The index of the first row that has the time of each row; a slice of all if no time is repeated."""
    if (times[1:] > times[:-1]).all():
        return slice(None)
    _, first, of = np.unique(times, return_index=True, return_inverse=True)
    return np.asarray(first[of])


def _by_name(part: object, what: str, faults: list[str]) -> Mapping[str, object]:
    """The mapping itself; for anything else a fault is added and an empty mapping returned."""
    if isinstance(part, Mapping):
        return part
    faults.append(f"{what} given as {type(part).__name__}; needed: arrays by name")
    return {}


def _real(raw: object, shape: tuple[int, ...] | None = None) -> Array | str:
    """The numbers as an array of doubles, of this shape if one is given, or what is wrong with them."""
    if isinstance(raw, str):
        return f"is {shown(raw)!r}; needed: real numbers"
    try:
        array = np.asarray(raw)
    except (ValueError, TypeError) as error:
        return f"is not an array ({error})"
    if isinstance(raw, np.ma.MaskedArray) and (masked := int(np.sum(raw.mask))):
        return f"has {masked} masked entries; needed: numbers, or NaN where a number does not exist"
    if array.dtype.kind not in "iuf":
        return f"is of type {array.dtype}; needed: real numbers"
    if shape is not None and array.shape != shape:
        return f"has the shape {array.shape}; needed: {shape}"
    return np.asarray(array, dtype=float)
