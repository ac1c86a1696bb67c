"""Inputs of a scene as value, rate, acceleration and so on, evaluated apart from pointcoord's power series.

Polynomials, sines and sums are rounded once: from a number of a longer format, or from fractions of many
digits where that does not tell, for terms may cancel, and an angle may be many turns. A table means scipy's
cubic spline, for every model and for the reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.plan import plan_effects
from pointcoord.scene.input_part import InputPart, SinePart, TablePart
from pointcoord.scene.scene_file import Scene
from validate.extras import MissingPackage

# It takes half as long to import as numpy, and few laws need it; but it is missed before a scene is solved.
if find_spec("mpmath") is None:
    raise MissingPackage("validate.formulations.input_rates", ModuleNotFoundError(name="mpmath"))

Array = NDArray[np.float64]
Long = NDArray[np.longdouble]

DIGITS = 40  # of a sine, beside those that its angle has before the point
# Rounding unit of the longer format that numbers are tried in first; without one nothing is sure.
LONG = float(np.finfo(np.longdouble).eps) / 2.0
# Of a sine or cosine of that format, in such units: twice what the C library's own tests allow it.
SINE = 4.0


@dataclass(frozen=True)
class _Law:
    """A law and its time derivatives.

    Attributes:
        found: in a longer format, (derivatives + 1, N). doubts: how far these may be off.
        exact: one of them, by instant and derivative.
    """

    found: Long
    doubts: Long
    exact: Callable[[int, int], Fraction]


def laws_of(scene: Scene, times: Array) -> dict[str, Array]:
    """Every input at instants, with two time derivatives, or as many as the scene's effects are made of."""
    derivatives = max(2, plan_effects(scene.effects).derivative)
    return {name: rates(part, times, derivatives) for name, part in scene.inputs.items()}


def rates(part: InputPart, times: Array, derivatives: int = 2) -> Array:
    """Value and time derivatives at instants, shape (N, derivatives + 1); rad or mm per s^d.

    What is too large for the arithmetic comes out infinite; whoever uses it must check.
    """
    instants = np.asarray(times, dtype=float)
    with np.errstate(all="ignore"):
        if part.constant is not None:
            return np.outer(np.ones(len(instants)), [part.constant, *[0.0] * derivatives])
        if part.table is not None:
            return _spline(part.table, instants, derivatives)
        return _rounded_once(_law(part, instants, derivatives))


def _law(part: InputPart, instants: Array, derivatives: int) -> _Law:
    if part.sum is not None:
        return _sum([_law(term, instants, derivatives) for term in part.sum])
    if part.sine is not None:
        return _sine(part.sine, instants, derivatives)
    if part.table is not None:
        return _as_computed(_spline(part.table, instants, derivatives))
    return _polynomial(part.polynomial or (part.constant or 0.0,), instants, derivatives)


def _spline(table: TablePart, instants: Array, derivatives: int) -> Array:
    # Imported here: it takes several times as long as numpy, and few scenes have a table.
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(table.times, table.values)
    return np.stack([spline(instants, order) for order in range(derivatives + 1)], axis=-1)


def _as_computed(numbers: Array) -> _Law:
    found = numbers.T.astype(np.longdouble)
    return _Law(found, np.zeros_like(found), lambda i, d: Fraction(float(numbers[i, d])))


def _sum(laws: Sequence[_Law]) -> _Law:
    terms = np.stack([law.found for law in laws])
    found, sizes = terms.sum(axis=0), np.abs(terms).sum(axis=0)
    doubts = np.stack([law.doubts for law in laws]).sum(axis=0) + len(laws) * LONG * sizes
    return _Law(found, doubts, lambda i, d: sum((law.exact(i, d) for law in laws), Fraction(0)))


def _sine(wave: SinePart, instants: Array, derivatives: int) -> _Law:
    """Offset + amplitude sin(angle) and its rates."""
    amplitude, speed, t = (np.longdouble(x) for x in (wave.amplitude, wave.angular_frequency, instants))
    angle = speed * t + np.longdouble(wave.phase)
    # The product and the sum are rounded once each.
    doubt = LONG * (2.0 * np.abs(speed * t) + abs(wave.phase)) + SINE * LONG
    cosine, sine = np.cos(angle), np.sin(angle)
    quarters = (sine, cosine, -sine, -cosine)
    found = [amplitude * speed**d * quarters[d % 4] for d in range(derivatives + 1)]
    found[0] = wave.offset + found[0]
    # A power, of at most so many products and more, two products and a sum.
    doubts = [np.abs(amplitude * speed**d) * (doubt + (4.0 + 2.0 * d) * LONG) for d in range(derivatives + 1)]
    doubts[0] += LONG * (abs(wave.offset) + np.abs(amplitude))
    return _Law(np.stack(found), np.stack(doubts), lambda i, d: _exact_sine(wave, float(instants[i]), d))


def _exact_sine(wave: SinePart, t: float, d: int) -> Fraction:
    import mpmath

    amplitude, speed, instant, phase, offset = (
        Fraction(x) for x in (wave.amplitude, wave.angular_frequency, t, wave.phase, wave.offset)
    )
    angle = speed * instant + phase
    with mpmath.workdps(DIGITS + len(str(int(abs(angle))))):
        cosine, sine = mpmath.cos_sin(mpmath.mpf(angle.numerator) / angle.denominator)
        swing = Fraction(*mpmath.libmp.to_rational((sine, cosine, -sine, -cosine)[d % 4]._mpf_))
    return amplitude * speed**d * swing + (0 if d else offset)


def _polynomial(coefficients: tuple[float, ...], instants: Array, derivatives: int) -> _Law:
    """A polynomial and its rates by Horner's rule."""
    t, count = instants.astype(np.longdouble), len(coefficients)
    found, doubts = [], []
    for d in range(derivatives + 1):
        total, size = np.zeros(t.shape, np.longdouble), np.zeros(t.shape, np.longdouble)
        for k in range(count - 1, d - 1, -1):
            term = np.longdouble(coefficients[k]) * math.perm(k, d)
            total, size = total * t + term, size * np.abs(t) + abs(term)
        found.append(total)
        # Of each power two products and a sum are rounded; a little more for the size's own rounding.
        doubts.append(1.01 * 3.0 * count * LONG * size)
    return _Law(
        np.stack(found), np.stack(doubts), lambda i, d: _exact_polynomial(coefficients, float(instants[i]), d)
    )


def _exact_polynomial(coefficients: tuple[float, ...], t: float, d: int) -> Fraction:
    """The d-th derivative by Horner's rule in whole numbers: all of it times one power of two."""
    n, power = t.as_integer_ratio()
    ratios = [c.as_integer_ratio() for c in coefficients]
    common, step = max(below for _, below in ratios), power.bit_length() - 1
    exact, shift = 0, 0
    for k in range(len(coefficients) - 1, d - 1, -1):
        above, below = ratios[k]
        exact = exact * n + (math.perm(k, d) * above * (common // below) << shift)
        shift += step
    return Fraction(exact, common << max(shift - step, 0))


def _rounded_once(law: _Law) -> Array:
    """A law's numbers as the doubles nearest to what they stand for, shape (N, derivatives + 1).

    Where a number and what it may be off by could round to two doubles, fractions of many digits decide
    (Ziv, ACM Transactions on Mathematical Software 17, 1991).
    """
    total, doubt = law.found.T, law.doubts.T
    found = np.asarray(total, dtype=float)
    # A little more makes up for the rounding of the doubt itself and of these two sums.
    room = 1.001 * doubt + LONG * np.abs(total)
    sure = ((total - room).astype(float) == found) & ((total + room).astype(float) == found)
    for i, d in np.argwhere(~sure).tolist():
        found[i, d] = _nearest(law.exact(i, d))
    return found


def _nearest(number: Fraction) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf if number > 0 else -math.inf
