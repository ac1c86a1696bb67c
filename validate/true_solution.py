"""Proven instants as a solution in doubles, which is off by its rounding and claims no less."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.formulation import NUMBERS_OF, Accuracy, Solution
from validate.truth.instant import Instant

Array = NDArray[np.float64]
Arrays = dict[str, Array]

UNIT_ROUNDOFF = float(np.finfo(float).eps) / 2
# The truth is proven to 60 digits of the greatest number of its kind; ten are left for what "greatest" means.
DUST = 1e-50


def as_solution(times: Array, instants: Sequence[Instant]) -> Solution:
    """The truth at instants, rounded to doubles.

    Numbers that are zero up to the truth's own proven error are zero: the middles of its intervals about 0
    are some 1e-170, and a rate that is exactly zero is held to exactly zero. An angle that one of the
    instants leaves out is left out.
    """
    first = instants[0]
    angles = [n for n in ("camber", "kingpin") if all(n in i.angles for i in instants)]
    position = {n: np.array([i.position_as_float(n) for i in instants]) for n in first.position}
    velocity = _rounded([i.velocity for i in instants], first.velocity)
    acceleration = _rounded([i.acceleration for i in instants], first.acceleration)
    omega = _rounded([i.angular_velocity for i in instants], ("knuckle",))
    alpha = _rounded([i.angular_acceleration for i in instants], ("knuckle",))
    corners = np.stack(list(position.values()))
    size = float((corners.max(axis=0) - corners.min(axis=0)).max())
    fastest, hardest = _largest(velocity), _largest(acceleration)
    # Of an acceleration the parts that cancel count: speed squared over size.
    push = hardest + fastest * (fastest / size)
    return exact_solution(
        times,
        {
            "position": position,
            "velocity": _swept(velocity, fastest),
            "acceleration": _swept(acceleration, push),
            "angular_velocity": _swept(omega, fastest / size),
            "angular_acceleration": _swept(alpha, push / size),
            "wheel": {n: np.array([float(i.angles[n]) for i in instants]) for n in angles},
        },
    )


def exact_solution(times: Array, numbers: Mapping[str, Arrays], roundings: int = 1) -> Solution:
    """A solution whose numbers are exact but for being rounded.

    Args:
        numbers: by quantity and name, (N, 3) or (N,).
        roundings: how many roundings of themselves they have gone through.
    """
    rounded = roundings * UNIT_ROUNDOFF
    claims = {q: {n: rounded * np.abs(array) for n, array in numbers[q].items()} for q in NUMBERS_OF}
    accuracy = Accuracy(condition=np.ones(len(times)), proven=True, **claims)
    return Solution("truth", times, accuracy=accuracy, notes=(), **numbers)


def _swept(vectors: Arrays, scale: float) -> Arrays:
    return {name: np.where(np.abs(array) > DUST * scale, array, 0.0) for name, array in vectors.items()}


def _largest(vectors: Arrays) -> float:
    return max(float(np.abs(array).max()) for array in vectors.values())


def _rounded(rows: Sequence[Mapping[str, Any]], names: Iterable[str]) -> Arrays:
    return {n: np.array([[float(x) for x in row[n]] for row in rows]) for n in names}
