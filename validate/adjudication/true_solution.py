"""Proven instants as a solution in doubles, which is off by its rounding and claims no less."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.formulations.protocol import Accuracy, Solution
from validate.reference.instant import Instant

Array = NDArray[np.float64]
Arrays = dict[str, Array]

UNIT_ROUNDOFF = float(np.finfo(float).eps) / 2
# The reference is proven to 60 digits of the greatest number of its kind; ten are left for what "greatest"
# means.
DUST = 1e-50


def as_solution(times: Array, instants: Sequence[Instant]) -> Solution:
    """The reference at instants, rounded to doubles.

    Numbers that are zero up to the reference's own proven error, which it claims, are zero: the middles of
    its intervals about 0 are some 1e-170. An angle that one of the instants leaves out is left out.
    """
    first = instants[0]
    angles = [n for n in ("camber", "kingpin") if all(n in i.effects for i in instants)]
    numbers = {
        "position": {n: np.array([i.position_as_float(n) for i in instants]) for n in first.position},
        "velocity": _rounded([i.velocity for i in instants], first.velocity),
        "acceleration": _rounded([i.acceleration for i in instants], first.acceleration),
        "angular_velocity": _rounded([i.angular_velocity for i in instants], ("knuckle",)),
        "angular_acceleration": _rounded([i.angular_acceleration for i in instants], ("knuckle",)),
        "wheel": {n: np.array([float(i.effects[n]) for i in instants]) for n in angles},
    }
    dust = {quantity: DUST * scale for quantity, scale in scales(numbers).items()}
    swept = {
        q: {n: np.where(np.abs(array) > dust[q], array, 0.0) for n, array in arrays.items()}
        for q, arrays in numbers.items()
    }
    claims = {
        q: {n: UNIT_ROUNDOFF * np.abs(array) + dust[q] for n, array in arrays.items()}
        for q, arrays in swept.items()
    }
    accuracy = Accuracy(condition=np.ones(len(times)), proven=True, **claims)
    return Solution("reference", times, accuracy=accuracy, notes=(), **swept)


def scales(numbers: Mapping[str, Arrays]) -> dict[str, float]:
    """The greatest number of each kind; of an acceleration the parts that cancel count, speed^2 / size."""
    corners = np.stack(list(numbers["position"].values()))
    size = float((corners.max(axis=0) - corners.min(axis=0)).max())
    fastest, hardest = _largest(numbers["velocity"]), _largest(numbers["acceleration"])
    push = hardest + fastest * (fastest / size)
    return {
        "position": float(np.abs(corners).max()),
        "velocity": fastest,
        "acceleration": push,
        "angular_velocity": fastest / size,
        "angular_acceleration": push / size,
        "wheel": 1.0,
    }


def _largest(vectors: Arrays) -> float:
    return max(float(np.abs(array).max()) for array in vectors.values())


def _rounded(rows: Sequence[Mapping[str, Any]], names: Iterable[str]) -> Arrays:
    return {n: np.array([[float(x) for x in row[n]] for row in rows]) for n in names}
