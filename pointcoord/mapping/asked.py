"""Checks the arguments of a kinematic map: the ranges when it is made, the inputs when it is evaluated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.errors import InputOutOfRange, UnknownName, WrongArgument
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array
from pointcoord.patches.domain import Domain

Ranges = Mapping[str, tuple[float, float]]

# Smallest width and largest end of a range for which squares and products of series stay finite and not zero.
NARROWEST, FARTHEST = 1e-100, 1e12

STATES = ("values", "rates", "accelerations")


def columns_of(
    domain: Domain, given: Sequence[Mapping[str, ArrayLike]]
) -> tuple[list[Array], dict[str, list[Array]], tuple[int, ...]]:
    """The free inputs of a domain and their rates as columns.

    Args:
        given: numbers or arrays by input, and their time derivatives.
    Returns:
        The free inputs by derivative, each (N, p); the inputs that move the chassis, by input and derivative,
        each (N,); and the common shape of the given arrays, with N numbers.
    Raises:
        UnknownName: an unknown input, or a free input that is missing.
        InputOutOfRange: a held input that moves, or a chassis input that is not finite.
        WrongArgument: values that are not numbers by input, or shapes that do not broadcast.
    """
    topology = domain.mechanism.topology
    held = {name: low for name, (low, high) in domain.ranges.items() if low == high}
    for d, state in enumerate(given):
        if not isinstance(state, Mapping):
            raise WrongArgument(STATES[d], f"is of type {type(state).__name__}", "numbers or arrays by input")
        kind = ("input", "input with a rate", "input with an acceleration")[d]
        for name in state:
            if name not in topology.inputs:
                raise UnknownName(kind, name, topology.inputs)
            wanted = held.get(name) if d == 0 else 0.0 if name in held else None
            value = np.ravel(numbers_of(f"values of {kind} {name!r}", state[name]))
            if wanted is not None and (value != wanted).any():
                worst = float(value[np.argmax(value != wanted)])
                raise InputOutOfRange(name, worst, f"{wanted:.10g}, as the map holds this input")
        for name in domain.free:
            if name not in state:
                raise UnknownName(f"given {kind}", name, state)
    arrays = [{name: np.asarray(value, dtype=float) for name, value in state.items()} for state in given]
    shape = common_shape([value.shape for state in arrays for value in state.values()], "inputs")
    count = int(np.prod(shape))
    columns = [
        np.stack([np.broadcast_to(state[name], shape).reshape(count) for name in domain.free], axis=-1)
        for state in arrays
    ]
    # A held input also moves the chassis, if a height over the ground is driven.
    arrays[0] = {**{name: np.asarray(value) for name, value in held.items()}, **arrays[0]}
    named = (name for name in topology.chassis_inputs if any(name in state for state in arrays))
    laws = {
        name: [np.broadcast_to(state.get(name, np.zeros(())), shape).reshape(count) for state in arrays]
        for name in named
    }
    for name, law in laws.items():
        for value in law:
            if not np.isfinite(value).all():
                raise InputOutOfRange(name, float(value[~np.isfinite(value)][0]), "finite values")
    return columns, laws, shape


def numbers_of(what: str, value: ArrayLike) -> Array:
    """A value as an array of doubles.

    Raises:
        WrongArgument: the value cannot be read as numbers.
    """
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        problem = f"cannot be read as numbers: {error}"
        raise WrongArgument(what, problem, "numbers or arrays of them") from error


def common_shape(shapes: Sequence[tuple[int, ...]], what: str) -> tuple[int, ...]:
    """The shape that some shapes broadcast to.

    Raises:
        WrongArgument: they do not broadcast.
    """
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError as error:
        found = ", ".join(map(str, dict.fromkeys(shapes)))
        raise WrongArgument(what, f"have the shapes {found}", "shapes that broadcast to one") from error


def checked_ranges(mechanism: Mechanism, ranges: Ranges) -> dict[str, tuple[float, float]]:
    """The ranges of the driving inputs, checked and in the mechanism's order.

    Raises:
        UnknownName: a range that is missing, or of an unknown input.
        WrongArgument: a range of a chassis input, or ends that are not a range.
    """
    topology = mechanism.topology
    if not isinstance(ranges, Mapping):
        raise WrongArgument("ranges", f"is of type {type(ranges).__name__}", "a pair of numbers by input")
    for name in ranges:
        if name in topology.chassis_inputs and name not in topology.required_inputs:
            allowed = "no range: this input moves the whole chassis and may have any value"
            raise WrongArgument(f"ranges[{name!r}]", "is given", allowed)
        if name not in topology.required_inputs:
            raise UnknownName("driving input", name, topology.required_inputs)
    found = {}
    for name in topology.required_inputs:
        if name not in ranges:
            raise UnknownName("range of an input", name, ranges)
        try:
            low, high = (float(end) for end in ranges[name])
        except (TypeError, ValueError):
            low, high = np.nan, np.nan
        # Comparisons with NaN are false.
        within = max(abs(low), abs(high)) <= FARTHEST
        if not (within and (low == high or high - low >= NARROWEST)):
            raise WrongArgument(
                f"ranges[{name!r}]",
                f"is {ranges[name]!r}",
                f"two finite numbers within {FARTHEST:g}, the lower first, at least {NARROWEST:g} apart; or "
                "two equal numbers to hold the input",
            )
        found[name] = (low + 0.0, high + 0.0)
    return found
