r"""Numbers in twice the working precision, from sums and products whose rounding is computed exactly.

With fl(a + b) = s and fl(a b) = p, both rounding errors are doubles and take a few more operations (Knuth's
sum, Dekker's product):

    a + b = s + e,      a b = p + f      exactly, except for overflow and underflow.

A number is stored as a pair high + low.
"""

from __future__ import annotations

import numpy as np

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.vectors import LAST, NEXT

Pair = tuple[Array, Array]
"""Numbers as high and low."""

SPLITTER = 2.0**27 + 1.0  # splits 53 bits into two halves whose products are exact
# A product of pairs and a sum of four of them have about 20 roundings of u^2; this is three times that.
PAIRS = 64.0 * UNIT_ROUNDOFF**2


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b as high and low.

    >>> two_sum(np.float64(1.0), np.float64(1e-20))
    (np.float64(1.0), np.float64(1e-20))
    """
    high = a + b
    virtual = high - a
    # In place, which takes two thirds of the time: the remainders of a and b with reversed sign.
    rest = high - virtual
    rest -= a
    virtual -= b
    rest += virtual
    return high, -rest


def quick_two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b as high and low for |b| <= |a|, in half the operations; else low is wrong by up to 2 u of b."""
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
    scaled: Array = SPLITTER * a
    return scaled - (scaled - a)


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
