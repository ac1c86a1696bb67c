r"""Enclosures: numbers in twice the working precision with two error bounds, kept through every operation.

An `Enclosed` is high + low with two radii:

- *proven*: the exact number lies within this distance of high + low, with all rounding counted;
- *expected*: the largest error to expect if the same formula is evaluated in plain doubles, by running error
  analysis (Higham, Accuracy and Stability, section 3.3): each operation adds u of its result.

Both follow the same rules, such as |x| s + r |y| + r s for a product, so they are stored as one array with a
leading dimension of 2.

Numbers that lie close together, such as a point's coordinate at neighbouring instants, share an anchor,
high + low, and radii. Each number is high + low + change, |change| <= reach; the anchor's arrays have size 1
in the shared dimensions. A change is a plain double with a rounding of u of itself: less than u of the
number, since the numbers differ little. This takes one to four operations instead of thirty. A product
changes by

    (x + dx)(y + dy) - x y = dx (y + dy) + x dy,

where leaving out both low parts, two sums and two products cost 4 u (|dx| (|y| + |dy|) + |x| |dy|).

Operations keep |low| <= u |high|, up to u^2 of their operands. With that, a sum has a rounding of 5 u^2 of
its operands and a product 8 u^2 of itself; underflow costs less than TINY.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.numerics.arrays import Array, Indices
from pointcoord.numerics.double_double import quick_two_sum, two_product, two_sum
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.numerics.vectors import LAST, NEXT, components_first, components_last

OF_A_SUM = 8.0 * UNIT_ROUNDOFF**2
OF_A_PRODUCT = 16.0 * UNIT_ROUNDOFF**2
# Rounding of changes relative to their reach: for a sum; a product; a difference between two instants; a
# rotation, by its sine and versine; a distance from a reported number.
SUM_OF_CHANGES, PRODUCT_OF_CHANGES, CHANGE_OF_INSTANTS, TURN_OF_CHANGES, DISTANCE_OF_CHANGES = (
    count * UNIT_ROUNDOFF for count in (1.0, 4.1, 3.0, 8.0, 3.0)
)
TINY = 1e-307  # a product loses less than this to underflow, by some 16 orders of magnitude
NORMAL = float(np.finfo(float).tiny)  # below this a number has fewer digits
HALVINGS, TERMS = 6, 11  # halved so often, |angle| is below 0.05: omitted terms are below 1e-49
STEPS, FARTHEST = 256.0, 805  # steps per radian of the table of angles; the step count that exceeds pi
TURN = 6.283185307179586, 2.4492935982947064e-16
"""2 pi as high and low part."""
# Components of both factors of a vector product: first for the added products, then for the subtracted ones.
BOTH_WAYS = np.concatenate([NEXT, LAST]), np.concatenate([LAST, NEXT])


@dataclass(frozen=True)
class Enclosed:
    """Numbers high + low + change with their radii.

    Attributes:
        high, low: of the anchors, of any shape.
        radius: proven and expected radius, of the anchors' shape with 2 in front.
        change: from the anchors; of their shape, where a dimension of 1 may have any size.
        reach: at least |change|, of the anchors' shape.
    """

    high: Array
    low: Array
    radius: Array
    change: Array
    reach: Array

    @classmethod
    def of(
        cls, high: ArrayLike, low: ArrayLike = 0.0, proven: ArrayLike = 0.0, expected: ArrayLike = 0.0
    ) -> Enclosed:
        """An enclosure from its parts, broadcast to one shape; an exact number unless radii are given."""
        number, *others = (np.asarray(part, dtype=float) for part in (high, low, proven, expected))
        if any(part.ndim and part.shape != number.shape for part in others):
            number, *others = np.broadcast_arrays(number, *others)
        total, rest = two_sum(number, others[0])
        radius = np.empty((2, *number.shape))
        radius[0], radius[1] = others[1:]
        still = np.zeros_like(total)
        return cls(total, rest, radius, still, still)

    def __add__(self, other: Enclosed) -> Enclosed:
        return self._sum(other, other.high, other.low, self.change + other.change)

    def __sub__(self, other: Enclosed) -> Enclosed:
        return self._sum(other, -other.high, -other.low, self.change - other.change)

    def __neg__(self) -> Enclosed:
        return Enclosed(-self.high, -self.low, self.radius, -self.change, self.reach)

    def _sum(self, other: Enclosed, its_high: Array, its_low: Array, change: Array) -> Enclosed:
        total, carry = two_sum(self.high, its_high)
        high, low = quick_two_sum(total, carry + (self.low + its_low))
        mine, its = aligned(self.radius, other.radius)
        radius, reach = mine + its, self.reach + other.reach
        radius[0] += OF_A_SUM * (np.abs(self.high) + np.abs(its_high)) + SUM_OF_CHANGES * reach
        radius[1] += UNIT_ROUNDOFF * (np.abs(high) + reach)
        return Enclosed(high, low, radius, change, reach)

    def __mul__(self, other: Enclosed) -> Enclosed:
        product, carry = two_product(self.high, other.high)
        high, low = quick_two_sum(product, carry + (self.high * other.low + self.low * other.high))
        mine, its = aligned(self.radius, other.radius)
        its_size = other.size
        radius, reach = self.size * its, self.reach * its_size + np.abs(self.high) * other.reach
        radius += mine * (its_size + its)
        size = np.abs(high)
        radius[0] += OF_A_PRODUCT * size + PRODUCT_OF_CHANGES * reach + TINY
        radius[1] += UNIT_ROUNDOFF * (size + reach) + TINY
        change = other.high + other.change
        change = self.change * change
        change += self.high * other.change
        return Enclosed(high, low, radius, change, reach)

    def times(self, count: int) -> Enclosed:
        """The product with a whole number."""
        if count & (count - 1):
            return self * Enclosed.of(float(count))
        return self.scaled(float(count))

    def scaled(self, powers_of_two: ArrayLike) -> Enclosed:
        """The product with powers of two, which is exact except below the normal numbers."""
        factor = np.asarray(powers_of_two, dtype=float)
        high, low, change = self.high * factor, self.low * factor, self.change * factor
        factor = np.abs(factor)
        radius, reach = self.radius * factor, self.reach * factor
        if not (factor >= 1.0).all():
            lost = (self.high != 0.0) & (np.abs(high) < NORMAL) | (self.low != 0.0) & (np.abs(low) < NORMAL)
            radius += np.where(lost | (self.reach > 0.0), TINY, 0.0)
        return Enclosed(high, low, radius, change, reach)

    @property
    def size(self) -> Array:
        """At least the magnitude of the numbers at each anchor."""
        return np.asarray(np.abs(self.high) + self.reach)

    @property
    def parts(self) -> tuple[Array, Array, Array, Array, Array]:
        """All arrays."""
        return self.high, self.low, self.radius, self.change, self.reach

    def take(self, places: Indices | list[int] | slice) -> Enclosed:
        """Elements of the last dimension; a view for a slice."""
        # Numbers of one component are contiguous in memory everywhere.
        return Enclosed(*(components_last(components_first(part)[places]) for part in self.parts))

    def component(self, place: int) -> Enclosed:
        """One element of the last dimension."""
        return Enclosed(*(part[..., place] for part in self.parts))

    @property
    def spread_out(self) -> Enclosed:
        """The numbers with a last dimension of 1, to multiply vectors."""
        return Enclosed(*(part[..., None] for part in self.parts))

    def cosine_sine(self) -> tuple[Enclosed, Enclosed]:
        """Cosine and sine of an angle between -pi and pi, expanded about the nearest table angle a.

        With d = angle - a, s = sin d and l = 1 - cos d,

            cos = cos a - (l cos a + s sin a),      sin = sin a - (l sin a - s cos a).

        In s / d and 2 l / d^2, terms from d^4 on are below 1e-12, so plain doubles are enough for them.
        Changes follow the same formulas, in plain doubles and from the anchors. The expected radius is that
        of library functions with an error of one unit in the last place.
        """
        anchor = Enclosed.of(self.high, self.low, *self.radius)
        known = np.nan_to_num(self.high, posinf=0.0, neginf=0.0)
        place = np.clip(np.rint(known * STEPS), -FARTHEST, FARTHEST)
        places = (place + FARTHEST).astype(np.intp)
        cosine, sine = (Enclosed(*(part[..., places] for part in table.parts)) for table in _table())
        part = anchor - Enclosed.of(place / STEPS)
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
        turn, versine = np.sin(self.change), 2.0 * np.sin(0.5 * self.change) ** 2
        changes = (
            -(values[0].high * versine + values[1].high * turn),
            values[0].high * turn - values[1].high * versine,
        )
        # A sine or cosine changes by at most the change of its angle.
        proven = outside + self.reach * (values[0].radius[0] + values[1].radius[0] + TURN_OF_CHANGES)
        first, second = (
            Enclosed(
                value.high,
                value.low,
                both(value.radius[0] + proven, 2.0 * UNIT_ROUNDOFF * value.size + self.radius[1]),
                change,
                self.reach,
            )
            for value, change in zip(values, changes, strict=True)
        )
        return first, second

    @property
    def members(self) -> list[Enclosed]:
        """The numbers that make up a stack (see `stacked`), as views."""
        high, low, radius, change, reach = self.parts
        return [Enclosed(high[i], low[i], radius[:, i], change[i], reach[i]) for i in range(len(self.high))]

    @property
    def middle(self) -> Array:
        """high + low + change, rounded twice."""
        return np.asarray((self.high + self.low) + self.change)

    @property
    def alone(self) -> Enclosed:
        """The numbers without anchors, each with its own radii."""
        # The anchor's radii plus the rounding of the middle.
        return Enclosed.of(self.middle, 0.0, *(self.radius + 2.0 * UNIT_ROUNDOFF * self.size))

    def apart(self, reported: Array) -> Array:
        """Upper bound of the distance of the exact number from a close reported one, shape of the change."""
        distance = reported - self.high
        distance -= self.low
        distance -= self.change
        np.abs(distance, out=distance)
        distance *= 1.0 + 8.0 * UNIT_ROUNDOFF
        distance += self.radius[0] + DISTANCE_OF_CHANGES * self.reach
        return np.asarray(distance)

    def errors(self, reported: Array) -> Array:
        """Proven and expected error of a close reported number, with a leading dimension of 2."""
        return both(self.apart(reported), self.radius[1])

    def like(self, values: Array, proven: float = 0.0, expected: float = 0.0) -> Enclosed:
        """Plain numbers with anchors and radii of the same shape as these."""
        return anchored(values, self.high.shape, proven, expected)

    def corrected(self, values: Array) -> Enclosed:
        """Values corrected by these far smaller numbers, which are the values' errors."""
        total = self.like(values) + self
        return replace(total, radius=both(total.radius[0], self.radius[1]))

    def together(self, group: Callable[[Array], Array]) -> Enclosed:
        """Numbers of separate instants, (N, ...), in groups of m, (G, m, ...), about each group's middle.

        Args:
            group: reshapes an array into groups.
        """
        high, low = group(self.high), group(self.low)
        middle = slice(high.shape[1] // 2, high.shape[1] // 2 + 1)
        less = low - low[:, middle]
        change = (high - high[:, middle]) + less
        reach, lost = (np.abs(part).max(axis=1, keepdims=True) for part in (change, less))
        proven, expected = (group(part).max(axis=1, keepdims=True) for part in self.radius)
        # The two differences may cancel: each has its own rounding.
        radius = both(proven + CHANGE_OF_INSTANTS * (reach + lost), expected)
        return Enclosed(high[:, middle], low[:, middle], radius, change, reach)


def anchored(
    values: Array, shape: tuple[int, ...], proven: ArrayLike = 0.0, expected: ArrayLike = 0.0
) -> Enclosed:
    """Plain numbers as enclosures about the middle ones; `shape` has 1 where numbers share an anchor."""
    middle = tuple(
        slice(n // 2, n // 2 + 1) if kept == 1 else slice(None)
        for n, kept in zip(values.shape, shape, strict=True)
    )
    shared = tuple(axis for axis, kept in enumerate(shape) if kept == 1)
    high = values[middle]
    change = values - high
    reach = np.maximum(change.max(axis=shared, keepdims=True), -change.min(axis=shared, keepdims=True))
    # The difference of two numbers is exact if neither exceeds twice the other (Sterbenz).
    lost = np.where(2.0 * reach <= np.abs(high), 0.0, SUM_OF_CHANGES * reach)
    radius = both(proven + lost, np.broadcast_to(expected, reach.shape))
    return Enclosed(high, np.zeros_like(high), radius, change, reach)


def stacked(numbers: Sequence[Enclosed]) -> Enclosed:
    """Vectors of one shape in one enclosure, with a dimension for them in front; stored as by `both`."""

    def joined(parts: Sequence[Array], axis: int = 0) -> Array:
        return components_last(np.stack([components_first(part) for part in parts], axis=axis + 1))

    high, low, radius, change, reach = zip(*(number.parts for number in numbers), strict=True)
    return Enclosed(joined(high), joined(low), joined(radius, 1), joined(change), joined(reach))


def aligned(a: Array, b: Array) -> tuple[Array, Array]:
    """Radii reshaped to broadcast as the numbers do, with dimensions inserted after the first."""
    if a.ndim == b.ndim:
        return a, b
    rank = max(a.ndim, b.ndim)
    first, second = (r.reshape(2, *(1,) * (rank - r.ndim), *r.shape[1:]) for r in (a, b))
    return first, second


def both(proven: ArrayLike, expected: ArrayLike) -> Array:
    """Two arrays, broadcast to one shape, as one with a leading dimension of 2.

    Arrays of three dimensions are stored with the last one, the components, outermost: the values of one
    component at all groups of instants are contiguous.
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
    """1 - q/a (1 - q/b (1 - q/c (1 - q/d))) for a small square q, with its higher powers in plain doubles.

    The higher powers have a rounding of some 8 u of themselves; for q below 4e-6 the omitted part is smaller.
    """
    first, second, third, fourth = divisors
    q, most = square.high, square.size
    rest = (q / first) * (q / second) * (1.0 - q / third * (1.0 - q / fourth))
    size = np.abs(rest)
    left = 8.0 * UNIT_ROUNDOFF * size + most**5 / (first * second * third * fourth)
    moved = 2.0 * (most / first) / second * square.radius
    tail = Enclosed.of(rest, 0.0, *(moved + both(left + UNIT_ROUNDOFF * most**2 / first, left)))
    return Enclosed.of(1.0) - square * _inverse(int(first)) + tail


@cache
def _table() -> tuple[Enclosed, Enclosed]:
    """Cosine and sine of the multiples of 1 / STEPS between -pi and pi.

    By Taylor's series for a 64th of each angle and six doublings. With c = cos - 1, which keeps its digits
    for small angles, a doubling is 2 c (2 + c).
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
    """The quotient of two numbers, in plain doubles; an infinite radius where the divisor may be 0.

    If divisors that share an anchor lie on both sides of 0, each quotient is treated separately.

    With n, r the numerator and its radius and d, s the divisor's, the exact quotient differs from n/d by at
    most (r + |n/d| s) / (|d| - s). Each middle has a rounding of 2 u of itself, and the quotient one of u.
    """
    if ((divisor.reach > 0.0) & (np.abs(divisor.high) <= divisor.reach + divisor.radius[0])).any():
        numerator, divisor = numerator.alone, divisor.alone
    n, d = numerator.middle, divisor.middle
    r, s = aligned(numerator.radius, divisor.radius)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = _about(np.where(d != 0.0, n / d, 0.0), numerator, divisor)
        left = np.abs(divisor.high) - divisor.reach - s
        off = r + 2.0 * UNIT_ROUNDOFF * numerator.size + found.size * (s + 2.0 * UNIT_ROUNDOFF * divisor.size)
        radius = np.where(left > 0.0, off / left + UNIT_ROUNDOFF * found.size, np.inf)
    return Enclosed(found.high, found.low, found.radius + radius, found.change, found.reach)


def root(square: Enclosed) -> Enclosed:
    """Square root of a number that is not negative, in plain doubles.

    |sqrt x - sqrt m| = |x - m| / (sqrt x + sqrt m) <= r / sqrt m, or, where this is smaller, at most
    sqrt(m + r). The middle has a rounding of 2 u of itself, and the root one of u.
    """
    found = _about(np.sqrt(np.maximum(square.middle, 0.0)), square)
    off = square.radius + 2.0 * UNIT_ROUNDOFF * square.size
    with np.errstate(divide="ignore", invalid="ignore"):
        by_slope = off / np.maximum(found.high - found.reach, 0.0)
    radius = np.fmin(by_slope, np.sqrt(square.size + off)) + UNIT_ROUNDOFF * found.size
    return Enclosed(found.high, found.low, found.radius + radius, found.change, found.reach)


def angle(sine: Enclosed, cosine: Enclosed) -> Enclosed:
    """atan2(sine, cosine), rad, in plain doubles; each number has its own radii, of at most pi."""
    found = np.arctan2(sine.middle, cosine.middle)
    return Enclosed.of(found, 0.0, *angle_error(sine, cosine, found))


def within_a_turn(angle: Enclosed) -> Enclosed:
    """An angle minus whole turns, between -pi and pi."""
    turns = np.rint(np.nan_to_num(angle.high, posinf=0.0, neginf=0.0) / TURN[0])
    if not turns.any():
        return angle
    high, low = two_product(turns, np.full_like(turns, TURN[0]))
    # The two parts of TURN differ from 2 pi by less than 1e-32 of it.
    error = 1e-31 * np.abs(turns) + 4 * UNIT_ROUNDOFF**2 * np.abs(high)
    return angle - Enclosed.of(high, low + turns * TURN[1], error, error)


def _about(values: Array, *operands: Enclosed) -> Enclosed:
    """Plain numbers with anchors of the same shape as those of the operands."""
    return anchored(values, np.broadcast_shapes(*(operand.high.shape for operand in operands)))


def angle_error(sine: Enclosed, cosine: Enclosed, found: Array) -> Array:
    """Proven and expected error of a computed angle atan2(sine, cosine), (2, N), rad; at most pi.

    If the computed angle is f, its error d satisfies sin d = (sine cos f - cosine sin f) / |(sine, cosine)|.
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
        # For a sine x below 1/2, the arc is at most 1 + x^2 times as long as the sine.
        turn = np.stack([proven, expected])
        ahead = sine.middle * np.sin(found) + cosine.middle * np.cos(found) > 0.0
        return np.where((turn < 0.5) & np.stack([ahead, ahead | True]), turn * (1.0 + turn**2), np.pi)
