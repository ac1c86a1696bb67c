r"""Numbers in twice the working precision that carry two bounds through every operation.

An `Enclosed` is high + low with two radii:

- *proven*: the exact number lies within it of high + low, whatever rounding did;
- *expected*: what an evaluation of the same formula in plain doubles loses at most where nothing is wrong, by
  running error analysis (Higham, Accuracy and Stability, section 3.3): each operation adds u of its result.

Both follow the same rules, |x| s + r |y| + r s for a product, so they are carried as one array with a
leading dimension of 2. Numbers that lie close together, such as a point's at neighbouring instants, share
their radii: where an array of radii has 1 for a dimension, each holds for all numbers along it.

Operations keep |low| <= u |high|, up to u^2 of their operands; with that a sum is rounded by 5 u^2 of its
operands and a product by 8 u^2 of itself, and underflow by less than TINY.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.numerics.double_double import largest, quick_two_sum, two_product, two_sum
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.numerics.vectors import LAST, NEXT, components_first, components_last

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

OF_A_SUM = 8.0 * UNIT_ROUNDOFF**2
OF_A_PRODUCT = 16.0 * UNIT_ROUNDOFF**2
TINY = 1e-307  # a product loses less to underflow, by some 16 orders
NORMAL = float(np.finfo(float).tiny)  # below it a number has fewer digits
HALVINGS, TERMS = 6, 11  # |angle| below 0.05 after them: terms of 1e-49 are left out
STEPS, FARTHEST = 256.0, 805  # of a table of angles, and how many of them reach beyond pi
# Components of both factors of a vector product: of what is added, then of what is taken off.
BOTH_WAYS = np.concatenate([NEXT, LAST]), np.concatenate([LAST, NEXT])


@dataclass(frozen=True)
class Enclosed:
    """high + low and their radii.

    Attributes:
        high, low: of any shape.
        radius: the proven and the expected one, of that shape with 2 before it and 1 for what shares them.
        size: at least |high| of all that share a radius, of the shape of one.
    """

    high: Array
    low: Array
    radius: Array
    size: Array

    @classmethod
    def sharing(cls, high: Array, low: Array, radius: Array) -> Enclosed:
        """From numbers and radii, |low| <= u |high|."""
        return cls(high, low, radius, largest(np.abs(high), radius.shape[1:]))

    @classmethod
    def of(
        cls, high: ArrayLike, low: ArrayLike = 0.0, proven: ArrayLike = 0.0, expected: ArrayLike = 0.0
    ) -> Enclosed:
        """From its parts, broadcast to one shape; an exact number unless radii are given."""
        number, *others = (np.asarray(part, dtype=float) for part in (high, low, proven, expected))
        if any(part.ndim and part.shape != number.shape for part in others):
            number, *others = np.broadcast_arrays(number, *others)
        total, rest = two_sum(number, others[0])
        radius = np.empty((2, *number.shape))
        radius[0], radius[1] = others[1:]
        return cls(total, rest, radius, np.abs(total))

    def __add__(self, other: Enclosed) -> Enclosed:
        total, carry = two_sum(self.high, other.high)
        high, low = quick_two_sum(total, carry + (self.low + other.low))
        mine, its = aligned(self.radius, other.radius)
        radius = mine + its
        size = largest(np.abs(high), radius.shape[1:])
        radius += both(OF_A_SUM * (self.size + other.size), UNIT_ROUNDOFF * size)
        return Enclosed(high, low, radius, size)

    def __neg__(self) -> Enclosed:
        return Enclosed(-self.high, -self.low, self.radius, self.size)

    def __sub__(self, other: Enclosed) -> Enclosed:
        return self + -other

    def __mul__(self, other: Enclosed) -> Enclosed:
        product, carry = two_product(self.high, other.high)
        high, low = quick_two_sum(product, carry + (self.high * other.low + self.low * other.high))
        mine, its = aligned(self.radius, other.radius)
        radius = self.size * its + mine * (other.size + its)
        size = largest(np.abs(high), radius.shape[1:])
        radius += both(OF_A_PRODUCT * size + TINY, UNIT_ROUNDOFF * size + TINY)
        return Enclosed(high, low, radius, size)

    def scaled(self, powers_of_two: ArrayLike) -> Enclosed:
        """Times powers of two, which rounds nothing but what falls below the normal numbers."""
        factor = np.asarray(powers_of_two, dtype=float)
        high, low = self.high * factor, self.low * factor
        radius = self.radius * np.abs(factor)
        if not (np.abs(factor) >= 1.0).all():
            lost = (self.high != 0.0) & (np.abs(high) < NORMAL) | (self.low != 0.0) & (np.abs(low) < NORMAL)
            radius = radius + largest(np.where(lost, TINY, 0.0), radius.shape[1:])
        return Enclosed(high, low, radius, self.size * np.abs(factor))

    def _expecting(self, angle: Enclosed, outside: Array) -> Enclosed:
        """Of a function of an angle; infinite beyond the table."""
        expected = 2.0 * UNIT_ROUNDOFF * self.size + angle.radius[1]
        return Enclosed(self.high, self.low, both(self.radius[0] + outside, expected), self.size)

    def take(self, places: Indices | list[int] | slice) -> Enclosed:
        """Elements of the last dimension; of a slice a view."""
        # The numbers of a place lie side by side in memory, as those of a component do everywhere.
        parts = (self.high, self.low, self.radius, self.size)
        return Enclosed(*(components_last(components_first(part)[places]) for part in parts))

    def component(self, place: int) -> Enclosed:
        """One element of the last dimension."""
        parts = (self.high, self.low, self.radius, self.size)
        return Enclosed(*(part[..., place] for part in parts))

    @property
    def spread_out(self) -> Enclosed:
        """With a last dimension of 1, to multiply vectors."""
        parts = (self.high, self.low, self.radius, self.size)
        return Enclosed(*(part[..., None] for part in parts))

    def cosine_sine(self) -> tuple[Enclosed, Enclosed]:
        """Cosine and sine of an angle between -pi and pi, about the nearest of a table of angles a.

        With d = angle - a, s = sin d and l = 1 - cos d,

            cos = cos a - (l cos a + s sin a),      sin = sin a - (l sin a - s cos a).

        Of s / d and 2 l / d^2 what goes with d^4 is below 1e-12, so that plain doubles do. The expected
        radius is that of functions right to a unit in the last place.
        """
        known = np.nan_to_num(self.high, posinf=0.0, neginf=0.0)
        place = np.clip(np.rint(known * STEPS), -FARTHEST, FARTHEST)
        places = (place + FARTHEST).astype(np.intp)
        cosine, sine = (self._looked_up(whole, places) for whole in _table())
        part = self - self.like(place / STEPS)
        square = part * part
        sines, versines = (
            _less(square, *factors) for factors in ((6.0, 20.0, 42.0, 72.0), (12.0, 30.0, 56.0, 90.0))
        )
        turned, back = part * sines, (square * versines).scaled(0.5)
        outside = np.where(part.size < 1.01 / STEPS, 0.0, np.inf)
        values = (
            cosine - (back * cosine + turned * sine),
            sine - (back * sine - turned * cosine),
        )
        found = (value._expecting(self, outside) for value in values)
        return next(found), next(found)

    @property
    def middle(self) -> Array:
        """high + low, rounded once."""
        return np.asarray(self.high + self.low)

    def apart(self, reported: Array) -> Array:
        """Largest distance of the exact number from a reported one that is close, same shape."""
        distance = np.abs((reported - self.high) - self.low)
        return np.asarray(distance * (1.0 + 4.0 * UNIT_ROUNDOFF) + self.radius[0])

    def errors(self, reported: Array) -> Array:
        """Proven and expected error of a reported number that is close, with a leading dimension of 2."""
        return both(self.apart(reported), self.radius[1])

    def like(self, values: Array, proven: float = 0.0, expected: float = 0.0) -> Enclosed:
        """Other numbers that share radii as these do."""
        shape = self.radius.shape[1:]
        radius = both(np.full(shape, proven), np.full(shape, expected))
        return Enclosed.sharing(values, np.zeros_like(values), radius)

    def corrected(self, values: Array) -> Enclosed:
        """Values that are off by these numbers, which are far smaller, with what they are off added."""
        return Enclosed.sharing(*two_sum(values, self.middle), self.radius)

    def together(self, group: Callable[[Array], Array]) -> Enclosed:
        """Numbers of instants, (N, ...), in groups of m that share their radii, (G, m, ...).

        Args:
            group: puts an array into groups.
        """
        proven, expected = (group(part).max(axis=1, keepdims=True) for part in self.radius)
        return Enclosed.sharing(group(self.high), group(self.low), both(proven, expected))

    def _looked_up(self, table: Enclosed, places: Indices) -> Enclosed:
        """Numbers of a table that share radii as these do."""
        proven, expected = (largest(part[places], self.radius.shape[1:]) for part in table.radius)
        return Enclosed.sharing(table.high[places], table.low[places], both(proven, expected))


def aligned(a: Array, b: Array) -> tuple[Array, Array]:
    """Radii that broadcast as the numbers do, with dimensions put in behind the first."""
    if a.ndim == b.ndim:
        return a, b
    rank = max(a.ndim, b.ndim)
    first, second = (r.reshape(2, *(1,) * (rank - r.ndim), *r.shape[1:]) for r in (a, b))
    return first, second


def both(proven: ArrayLike, expected: ArrayLike) -> Array:
    """Two arrays, broadcast to one shape, as one with a leading dimension of 2.

    Of three dimensions the last is the first in memory: components of groups of instants.
    """
    shape = np.shape(proven)
    if shape != np.shape(expected):
        shape = np.broadcast_shapes(shape, np.shape(expected))
    if len(shape) == 3:
        radius = np.empty((shape[2], 2, *shape[:2])).transpose(1, 2, 3, 0)
    else:
        radius = np.empty((2, *shape))
    radius[0], radius[1] = proven, expected
    return radius


def dot(a: Enclosed, b: Enclosed) -> Enclosed:
    """Scalar product over the last dimension of three."""
    products = a * b
    x, y, z = (products.component(i) for i in range(3))
    return x + y + z


def cross(a: Enclosed, b: Enclosed) -> Enclosed:
    """Vector product over the last dimension of three."""
    # All six products at once: these arrays are so small that calls take most of the time.
    products = a.take(BOTH_WAYS[0]) * b.take(BOTH_WAYS[1])
    return products.take(slice(0, 3)) - products.take(slice(3, 6))


def _less(square: Enclosed, *divisors: float) -> Enclosed:
    """1 - q/a (1 - q/b (1 - q/c (1 - q/d))) of a small square q, its higher powers in plain doubles.

    These are rounded by some 8 u of themselves, and of q below 4e-6 what is left out is less.
    """
    first, second, third, fourth = divisors
    q, most = square.high, square.size
    rest = (q / first) * (q / second) * (1.0 - q / third * (1.0 - q / fourth))
    size = largest(np.abs(rest), square.radius.shape[1:])
    left = 8.0 * UNIT_ROUNDOFF * size + most**5 / (first * second * third * fourth)
    moved = 2.0 * (most / first) / second * square.radius
    tail = Enclosed.sharing(
        rest, np.zeros_like(rest), moved + both(left + UNIT_ROUNDOFF * most**2 / first, left)
    )
    return Enclosed.of(1.0) - square * _inverse(int(first)) + tail


@cache
def _table() -> tuple[Enclosed, Enclosed]:
    """Cosine and sine of the whole parts of 1 / STEPS between -pi and pi.

    By Taylor's series of a 64th of each and six doublings. With c = cos - 1, which keeps its digits where the
    angle is small, a doubling is 2 c (2 + c).
    """
    part = Enclosed.of(np.arange(-FARTHEST, FARTHEST + 1) / STEPS).scaled(2.0**-HALVINGS)
    square = part * part
    one, two = Enclosed.of(1.0), Enclosed.of(2.0)
    even, odd = one, one
    for k in range(TERMS, 0, -1):
        # cos x = 1 - x^2/(1 2) (1 - x^2/(3 4) (...)) and sin x = x (1 - x^2/(2 3) (1 - x^2/(4 5) (...))).
        odd = one - square * _inverse(2 * k * (2 * k + 1)) * odd
        even = one - square * _inverse((2 * k + 1) * (2 * k + 2)) * even
    sine, less = part * odd, -(square * even).scaled(0.5)
    for _ in range(HALVINGS):
        sine, less = (sine * (one + less)).scaled(2.0), (less * (two + less)).scaled(2.0)
    return one + less, sine


def _inverse(number: int) -> Enclosed:
    high = 1.0 / number
    from fractions import Fraction

    return Enclosed.of(high, float(Fraction(1, number) - Fraction(high)), UNIT_ROUNDOFF**2 * high)


def quotient(numerator: Enclosed, divisor: Enclosed) -> Enclosed:
    """Of two numbers, in plain doubles; an infinite radius where the divisor may be 0.

    With n, r the numerator and its radius and d, s the divisor's, the exact quotient differs from n/d by at
    most (r + |n/d| s) / (|d| - s); the two middles and the division are rounded by 4 u of it together.
    """
    n, d = numerator.middle, divisor.middle
    r, s = aligned(numerator.radius, divisor.radius)
    shape = np.broadcast_shapes(r.shape, s.shape)[1:]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        value = n / d
        least, size = -largest(-np.abs(d), shape), largest(np.abs(value), shape)
        left = least - s
        radius = np.where(left > 0.0, (r + size * s) / left, np.inf)
    value = np.where(d != 0.0, value, 0.0)
    return Enclosed.sharing(value, np.zeros_like(value), radius + 4.0 * UNIT_ROUNDOFF * size)


def root(square: Enclosed) -> Enclosed:
    """Square root of what is not negative, in plain doubles.

    |sqrt x - sqrt m| = |x - m| / (sqrt x + sqrt m) <= r / sqrt m, and where m < r it is at most sqrt(m + r);
    the middle and the root are rounded by 2 u of it together.
    """
    value, shape = np.sqrt(np.maximum(square.middle, 0.0)), square.radius.shape[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        least = -largest(-value, shape)
        radius = np.fmin(square.radius / least, np.sqrt(square.size + square.radius))
    return Enclosed.sharing(value, np.zeros_like(value), radius + 2.0 * UNIT_ROUNDOFF * largest(value, shape))


def angle(sine: Enclosed, cosine: Enclosed) -> Enclosed:
    """atan2(sine, cosine), rad, in plain doubles; each has radii of its own, of at most pi."""
    found = np.arctan2(sine.middle, cosine.middle)
    return Enclosed.sharing(found, np.zeros_like(found), angle_error(sine, cosine, found))


def angle_error(sine: Enclosed, cosine: Enclosed, found: Array) -> Array:
    """Proven and expected error of an angle atan2(sine, cosine) that was found, (2, N), rad; at most pi.

    It is off by d with sin d = (sine cos f - cosine sin f) / |(sine, cosine)| where it was found as f.
    """
    c, s = (
        sine.like(part, 2.0 * UNIT_ROUNDOFF, 2.0 * UNIT_ROUNDOFF) for part in (np.cos(found), np.sin(found))
    )
    off = sine * c - cosine * s
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        long = np.hypot(sine.middle, cosine.middle)
        reach = long - 2.0 * np.maximum(sine.radius[0], cosine.radius[0])
        proven = (np.abs(off.middle) + off.radius[0]) / np.where(reach > 0.0, reach, 0.0)
        expected = off.radius[1] / long + 4.0 * EPS
        # The arc of a sine below 1/2 is at most 1 + x^2 times as long as the sine.
        turn = np.stack([proven, expected])
        ahead = sine.middle * np.sin(found) + cosine.middle * np.cos(found) > 0.0
        return np.where((turn < 0.5) & np.stack([ahead, ahead | True]), turn * (1.0 + turn**2), np.pi)
