r"""The residual in twice the working precision, from sums and products whose rounding is computed exactly.

With fl(a + b) = s and fl(a b) = p, both rounding errors are numbers of the format and come out of a few
more operations (Knuth's sum, Dekker's product):

    a + b = s + e,      a b = p + f      exactly, but for overflow and underflow.

A number is carried as a pair high + low. What `doubled_residual` leaves out are products of two rounding
errors, so the proof of a pose sees what is left of C(y), not the rounding of looking at it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.vectors import LAST, NEXT, components_first, components_last

Array = NDArray[np.float64]
Pair = tuple[Array, Array]
"""Numbers as high and low."""

SPLITTER = 2.0**27 + 1.0  # splits 53 bits into two halves whose products are exact
# Rounding of the low parts in units of u^2 times a term, by the bounds below: a factor's low part is at most
# 6 u of it (its own rounding and that of a coordinate), a term's 13 u, a row's 21 u. Taking the two low
# parts of factors rounds twice each (24), their products (12), their sum (26), what it leaves out (36), the
# sums of up to 8 terms and of their carries (176): below 300, with as much again to spare.
LEFT_OUT = 600.0
# A product of pairs and a sum of four of them round some twenty times in units of u^2; three times that.
PAIRS = 64.0 * UNIT_ROUNDOFF**2


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b as high and low.

    >>> two_sum(np.float64(1.0), np.float64(1e-20))
    (np.float64(1.0), np.float64(1e-20))
    """
    high = a + b
    virtual = high - a
    # In place, which takes two thirds of the time: a and b less their parts in high, with the other sign.
    rest = high - virtual
    rest -= a
    virtual -= b
    rest += virtual
    return high, -rest


def quick_two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """The same where b is the smaller, in half the operations; else the low part is rounded by 2 u of b."""
    high = a + b
    return high, b - (high - a)


def two_product(a: Array, b: Array) -> tuple[Array, Array]:
    """a b as high and low; magnitudes between 1e-140 and 1e140, or zero."""
    high = a * b
    a_high, b_high = _upper_half(a), _upper_half(b)
    a_low, b_low = a - a_high, b - b_high
    rest = a_high * b_high
    rest -= high
    for one, other in ((a_high, b_low), (a_low, b_high), (a_low, b_low)):
        rest += one * other
    return high, rest


def _upper_half(a: Array) -> Array:
    scaled = SPLITTER * a
    return np.asarray(scaled - (scaled - a))


def exact_square(a: Array, b: Array) -> tuple[Array, Array]:
    """|a - b|^2 over the last dimension as high and low, to some 100 u^2 of itself."""
    difference, rest = two_sum(a, -b)
    square, square_rest = two_product(difference, difference)
    square_rest = square_rest + 2.0 * difference * rest
    total, carry = two_sum(square[..., 0], square[..., 1])
    total, last = two_sum(total, square[..., 2])
    return total, carry + last + square_rest.sum(axis=-1)


def pair_product(a: Pair, b: Pair) -> Pair:
    """a b, to the working precision of the low part."""
    high, low = two_product(*np.broadcast_arrays(a[0], b[0]))
    return high, low + (a[0] * b[1] + a[1] * b[0])


def pair_sum(a: Pair, b: Pair) -> Pair:
    """a + b, to the working precision of the low part."""
    high, low = two_sum(*np.broadcast_arrays(a[0], b[0]))
    return high, low + (a[1] + b[1])


def minus_pair(a: Pair) -> Pair:
    """-a."""
    return -a[0], -a[1]


def pair_dot(a: Pair, b: Pair) -> Pair:
    """a . b of vectors given as pairs, shape (..., 3) to (...,)."""
    products = [pair_product((a[0][..., i], a[1][..., i]), (b[0][..., i], b[1][..., i])) for i in range(3)]
    return two_sum(*pair_sum(pair_sum(products[0], products[1]), products[2]))


def pair_quotient(a: Pair, b: Pair) -> Pair:
    """a / b, to the working precision of the low part."""
    high = a[0] / b[0]
    held, rest = two_product(*np.broadcast_arrays(high, b[0]))
    return two_sum(high, ((a[0] - held) - rest + (a[1] - high * b[1])) / b[0])


def pair_root(a: Pair) -> Pair:
    """The root of a positive pair, to the working precision of the low part."""
    high = np.sqrt(a[0])
    held, rest = two_product(high, high)
    with np.errstate(divide="ignore", invalid="ignore"):
        low = np.where(high > 0.0, ((a[0] - held) - rest + a[1]) / (2.0 * high), 0.0)
    return two_sum(high, low)


def pair_cross(a: Pair, b: Pair) -> Pair:
    """a x b of vectors given as pairs, shape (..., 3)."""
    (a_next, a_last), (b_next, b_last) = (
        [(high[..., axes], low[..., axes]) for axes in (NEXT, LAST)] for high, low in (a, b)
    )
    # The sums of products may cancel, so their low parts are brought below the high ones again.
    return two_sum(*pair_sum(pair_product(a_next, b_last), minus_pair(pair_product(a_last, b_next))))


def doubled_residual(system: QuadraticMap, y: Array, low: Array, data: Array) -> tuple[Array, Array]:
    r"""C(y + low), and how far it may be from C of the coordinates that are meant.

    Each term c (y_a - y_b)(y_c - y_d), c a power of two, is a pair, and a row is summed as pairs. With D the
    uncertainties of the two coordinates in a factor F,  |F G - F' G'| <= |F| D_G + D_F (|G| + D_G).

    Args:
        y: coordinates, shape (..., size).
        low: what is known to be missing in y, |low| <= 5 u |y|, shape (..., size).
        data: uncertainty of each coordinate of y + low, shape (..., size), with 1 for a dimension of poses
            that share it.
    Returns:
        The value, (..., rows), and the doubt, (..., rows) with the dimensions of `data`.
    """
    coefficients, starts = system.terms
    (first, second), factors = system.differences
    # Coordinate by coordinate, so that the poses lie side by side in memory.
    y, low, data = (components_first(part) for part in (y, low, data))
    scale = coefficients.reshape(-1, *(1,) * (y.ndim - 1))
    differences = _difference(y, low, first, second)
    (f, f_low), (g, g_low) = ([part[places] for part in differences] for places in factors)
    high, rest = two_product(f, g)
    rest += f * g_low
    rest += f_low * g
    rest *= scale
    high *= scale
    total, carry = _row_sums(high, starts)
    value = total + (carry + _summed(rest, starts))
    size, doubted = largest(np.abs(differences[0]), data.shape[1:]), data[first] + data[second]
    (f_size, f_doubt), (g_size, g_doubt) = ((size[places], doubted[places]) for places in factors)
    doubt = f_size * g_doubt + f_doubt * (g_size + g_doubt)
    each = doubt * (1.0 + 16 * UNIT_ROUNDOFF) + LEFT_OUT * UNIT_ROUNDOFF**2 * f_size * g_size
    spread = _summed(np.abs(scale) * each, starts)
    spread = spread + 2.0 * UNIT_ROUNDOFF * largest(np.abs(value), data.shape[1:])
    return components_last(value), components_last(spread)


def largest(size: Array, shape: tuple[int, ...]) -> Array:
    """Magnitudes, each the largest of those that share a number of a shape with 1 for some dimensions.

    >>> largest(np.array([[1.0, 3.0], [2.0, 0.0]]), (2, 1))
    array([[3.],
           [2.]])
    """
    if size.shape == shape:
        return size
    dimensions = zip(range(-1, -1 - min(size.ndim, len(shape)), -1), reversed(shape), strict=False)
    shared = tuple(axis for axis, length in dimensions if length == 1 and size.shape[axis] > 1)
    return np.asarray(size.max(axis=shared, keepdims=True)) if shared else size


def _difference(
    y: Array, low: Array, first: NDArray[np.intp], second: NDArray[np.intp]
) -> tuple[Array, Array]:
    """y_first - y_second as high and low."""
    high, rest = two_sum(y[first], -y[second])
    return high, rest + (low[first] - low[second])


def _row_sums(terms: Array, starts: NDArray[np.intp]) -> tuple[Array, Array]:
    """Sums of runs of terms, along the first dimension, as high and low."""
    total, carry = terms[starts], np.zeros((len(starts), *terms.shape[1:]))
    for rows, places in runs(len(terms), starts):
        total[rows], rest = two_sum(total[rows], terms[places])
        carry[rows] += rest
    return total, carry


def _summed(terms: Array, starts: NDArray[np.intp]) -> Array:
    """The same, rounded."""
    total = terms[starts]
    for rows, places in runs(len(terms), starts):
        total[rows] += terms[places]
    return total


def runs(count: int, starts: NDArray[np.intp]) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Of runs of terms, those that have a second one, a third and so on, and its place."""
    lengths = np.diff(starts, append=count)
    for place in range(1, int(lengths.max())):
        rows = np.flatnonzero(lengths > place)
        yield rows, starts[rows] + place
