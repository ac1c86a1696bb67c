"""Inputs of a scene as value, rate, acceleration and so on, evaluated without pointcoord's power series.

Polynomials, sines and sums are evaluated in intervals and rounded once. The precision of the intervals is
raised until that is possible, because terms may cancel and an angle may be many turns. A table means scipy's
cubic spline, in every model and in the reference.
"""

from __future__ import annotations

import math
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import plan_effects
from pointcoord.scene.input_part import InputPart, TablePart
from pointcoord.scene.scene_file import Scene
from validate.arrays import Array
from validate.extras import not_there

# flint is imported where a law needs it, which is rare; but a missing flint is reported before solving.
if find_spec("flint") is None:
    raise not_there("validate.formulations.input_rates", ModuleNotFoundError(name="flint"))

Intervals = NDArray[Any]
"""Array of flint's arb; each is an interval that encloses the exact number."""

BITS = 128  # first precision of intervals; multiplied by four while an interval contains two doubles
ENDS = np.frompyfunc(lambda x: float(x.lower()), 1, 1), np.frompyfunc(lambda x: float(x.upper()), 1, 1)


def laws_of(scene: Scene, times: Array) -> dict[str, Array]:
    """Every input at instants, with two time derivatives, or more if the scene's effects need them."""
    derivatives = max(2, plan_effects(scene.effects).derivative)
    return {name: rates(part, times, derivatives) for name, part in scene.inputs.items()}


def rates(part: InputPart, times: Array, derivatives: int = 2) -> Array:
    """Value and time derivatives at instants, shape (N, derivatives + 1); rad or mm per s^d.

    Each number is the double nearest to the exact number: the precision is raised until both ends of its
    interval round to the same double (Ziv, ACM Transactions on Mathematical Software 17, 1991). A number that
    is too large for the arithmetic becomes infinite; the caller must check.
    """
    instants = np.asarray(times, dtype=float)
    if part.constant is not None:
        return np.outer(np.ones(len(instants)), [part.constant, *[0.0] * derivatives])
    if part.table is not None:
        return _spline(part.table, instants, derivatives)
    from flint import ctx

    found = np.empty((len(instants), derivatives + 1))
    left, bits = np.arange(len(instants)), BITS
    while len(left):
        with ctx.workprec(bits):
            law = _law(part, instants[left], derivatives)
            low, high = (np.asarray(end(law), dtype=float).T for end in ENDS)
        sure = (low == high) | np.isnan(low)
        found[left], left, bits = low, left[~sure.all(axis=-1)], 4 * bits
    return found


def _law(part: InputPart, instants: Array, derivatives: int) -> Intervals:
    """A law and its time derivatives, (derivatives + 1, N)."""
    from flint import arb

    orders = range(derivatives + 1)
    if part.sum is not None:
        return np.asarray(sum(_law(term, instants, derivatives) for term in part.sum))
    if part.table is not None:
        return _exact(_spline(part.table, instants, derivatives).T)
    t = _exact(instants)
    if part.sine is not None:
        # Offset + amplitude sin(angle).
        offset, amplitude, speed, phase = (
            arb(x)
            for x in (part.sine.offset, part.sine.amplitude, part.sine.angular_frequency, part.sine.phase)
        )
        sine, cosine = np.frompyfunc(arb.sin_cos, 1, 2)(t * speed + phase)
        quarters = (sine, cosine, -sine, -cosine)
        swings = [quarters[d % 4] * (amplitude * speed**d) for d in orders]
        return np.stack([swings[0] + offset, *swings[1:]])
    coefficients = part.polynomial or (part.constant or 0.0,)
    found = []
    for d in orders:
        # Horner's rule.
        total = t * 0
        for k in range(len(coefficients) - 1, d - 1, -1):
            total = total * t + arb(coefficients[k]) * math.perm(k, d)
        found.append(total)
    return np.stack(found)


def _exact(numbers: Array) -> Intervals:
    """Doubles as intervals without width."""
    from flint import arb

    return np.asarray(np.frompyfunc(arb, 1, 1)(numbers), dtype=object)


def _spline(table: TablePart, instants: Array, derivatives: int) -> Array:
    # Imported here: the import takes several times as long as numpy's, and few scenes have a table.
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(table.times, table.values)
    return np.stack([spline(instants, order) for order in range(derivatives + 1)], axis=-1)
