"""Residual and polar form of a quadratic map at enclosed coordinates (see `enclosure`)."""

from __future__ import annotations

import numpy as np

from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.quadratic import QuadraticMap

Edges = tuple[Enclosed, Enclosed]


def differences(system: QuadraticMap, state: Enclosed) -> Edges:
    """Both differences in every term, (..., terms), from coordinates (..., size)."""
    (first, second), (left, right) = system.differences
    each = state.take(first) - state.take(second)
    return each.take(left), each.take(right)


def residual(system: QuadraticMap, a: Edges) -> Enclosed:
    """C(a), from the differences of a state, (..., rows)."""
    return _row_sums(system, a[0] * a[1])


def twice_polar(system: QuadraticMap, a: Edges, b: Edges) -> Enclosed:
    """2 B(a, b), from the differences of two states, (..., rows)."""
    return _row_sums(system, (a[0] * b[1]).scaled(2.0) if a is b else a[0] * b[1] + b[0] * a[1])


def _row_sums(system: QuadraticMap, products: Enclosed) -> Enclosed:
    """Rows as sums of their terms' products times the coefficients."""
    coefficients, starts = system.terms
    terms = products.scaled(coefficients)
    total, lengths = terms.take(starts), np.diff(starts, append=len(coefficients))
    for place in range(1, int(lengths.max())):
        rows = np.flatnonzero(lengths > place)
        longer = total.take(rows) + terms.take(starts[rows] + place)
        for whole, part in zip(total.parts, longer.parts, strict=True):
            whole[..., rows] = part
    return total
