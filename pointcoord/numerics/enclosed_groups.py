r"""Enclosed numbers of neighbouring instants: one in twice the working precision, and plain changes from it.

The m instants of a group share an anchor, high + low; the number of each is

    x_i = high + low + change_i,      |change_i| <= reach,

to within radii that hold for the whole group. A change is a plain double, and what rounds it is u of the
change: less than u of the number by what the instants lie apart. So a group whose instants lie near one
another knows its numbers to a small part of u, for one or four operations each where twice the working
precision takes thirty. A product changes by

    (x + dx)(y + dy) - x y = dx (y + dy) + x dy,

of which leaving out the two low parts, two sums and two products round 5 u (|dx| (|y| + |dy|) + |x| |dy|).
Every change is counted as rounded once more than it is, which is the rounding of looking at it.

A number that is one for all instants, such as a direction, may stand in every operation as an `Enclosed`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.numerics.enclosure import TINY, Enclosed, aligned, both
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# A sum of two changes and looking at it; a product and looking at it; a sine and a cosine; a distance.
OF_A_SUM, OF_A_PRODUCT, OF_A_TURN, OF_A_DISTANCE = (count * UNIT_ROUNDOFF for count in (2.1, 6.5, 16.0, 4.0))
MORE = 1.0 + 16.0 * UNIT_ROUNDOFF  # makes up for what rounds a reach
WIDE = 0.5  # rad; no group turns as far


@dataclass(frozen=True)
class EnclosedGroups(Enclosed):
    """Numbers of G groups of m instants.

    Dimensions are those that an `Enclosed` of all instants would have, with (G, m) for them; the anchors and
    the radii have (G, 1). Memory has the instants of a group side by side.

    Attributes:
        change: (G, m, ...).
        reach: at least |change|, (G, 1, ...).
    """

    change: Array
    reach: Array

    @classmethod
    def around(cls, anchor: Enclosed, change: Array, lost: ArrayLike = 0.0) -> EnclosedGroups:
        """From anchors whose radii hold for their groups but for what the changes lost, (G, 1, ...)."""
        reach = np.maximum(change.max(axis=1, keepdims=True), -change.min(axis=1, keepdims=True))
        radius = anchor.radius.copy()
        radius[0] += lost + UNIT_ROUNDOFF * reach
        radius[1] += UNIT_ROUNDOFF * reach
        return cls(anchor.high, anchor.low, radius, change, reach)

    @classmethod
    def of_instants(cls, numbers: Enclosed, groups: tuple[int, int]) -> EnclosedGroups:
        """Scalars that are enclosed at each of G m instants one after the other, (G m,)."""
        high, low = numbers.high.reshape(groups), numbers.low.reshape(groups)
        middle = slice(groups[1] // 2, groups[1] // 2 + 1)
        less = low - low[:, middle]
        change = (high - high[:, middle]) + less
        radius = numbers.radius.reshape(2, *groups).max(axis=-1, keepdims=True)
        # The two differences may cancel: each is rounded by what it is.
        lost = UNIT_ROUNDOFF * (3.0 * np.abs(change) + 3.0 * np.abs(less)).max(axis=1, keepdims=True)
        return cls.around(Enclosed(high[:, middle], low[:, middle], radius), change, lost)

    @classmethod
    def of_one(cls, number: Enclosed, groups: tuple[int, int]) -> EnclosedGroups:
        """Scalars of instants: themselves if they are numbers of groups, or one for all instants, (...)."""
        if isinstance(number, EnclosedGroups):
            return number
        shape = (groups[0], 1)
        high, low = np.broadcast_to(number.high, shape), np.broadcast_to(number.low, shape)
        radius = np.broadcast_to(number.radius.reshape(2, 1, 1), (2, *shape))
        return cls(high, low, radius, np.zeros(groups), np.zeros(shape))

    def __add__(self, other: Enclosed) -> EnclosedGroups:
        anchor = Enclosed.__add__(self, other)
        if isinstance(other, EnclosedGroups):
            return _made(anchor, self.change + other.change, self.reach + other.reach, OF_A_SUM)
        return _made(anchor, self.change, self.reach, OF_A_SUM)

    __radd__ = __add__

    def __neg__(self) -> EnclosedGroups:
        return EnclosedGroups(-self.high, -self.low, self.radius, -self.change, self.reach)

    def __sub__(self, other: Enclosed) -> EnclosedGroups:
        anchor = Enclosed.__add__(self, Enclosed(-other.high, -other.low, other.radius))
        if isinstance(other, EnclosedGroups):
            return _made(anchor, self.change - other.change, self.reach + other.reach, OF_A_SUM)
        return _made(anchor, self.change, self.reach, OF_A_SUM)

    def __rsub__(self, other: Enclosed) -> EnclosedGroups:
        return -(self - other)

    def __mul__(self, other: Enclosed) -> EnclosedGroups:
        anchor = Enclosed.__mul__(self, other)
        mine, its = aligned(self.radius, other.radius)
        if not isinstance(other, EnclosedGroups):
            reach = self.reach * np.abs(other.high)
            found = _made(anchor, _product(self.change, other.high), reach, OF_A_PRODUCT)
            return found._with(self.reach * its)
        reach = self.reach * (np.abs(other.high) + other.reach) + np.abs(self.high) * other.reach
        change = _product(self.change, other.change + other.high)
        change += self.high * other.change
        return _made(anchor, change, reach, OF_A_PRODUCT)._with(self.reach * its + mine * other.reach)

    __rmul__ = __mul__

    def scaled(self, powers_of_two: ArrayLike) -> EnclosedGroups:
        """Times powers of two, one for each group or for all."""
        factor = np.asarray(powers_of_two, dtype=float)
        anchor = Enclosed.scaled(self, factor)
        tiny = np.where(self.reach > 0.0, TINY, 0.0)
        reach = self.reach * np.abs(factor) + tiny
        return EnclosedGroups(anchor.high, anchor.low, anchor.radius + tiny, self.change * factor, reach)

    def take(self, places: Indices | list[int]) -> EnclosedGroups:
        """Elements of the last dimension."""
        anchor, chosen = Enclosed.take(self, places), [int(place) for place in places]
        run: slice | list[int] = chosen
        if chosen == list(range(chosen[0], chosen[0] + len(chosen))):
            run = slice(chosen[0], chosen[0] + len(chosen))
        change = self.change.transpose(2, 0, 1)[run].transpose(1, 2, 0)
        return EnclosedGroups(*_parts(anchor), change, self.reach[..., run])

    def component(self, place: int) -> EnclosedGroups:
        """One element of the last dimension."""
        anchor = Enclosed.component(self, place)
        return EnclosedGroups(*_parts(anchor), self.change[..., place], self.reach[..., place])

    @property
    def spread_out(self) -> EnclosedGroups:
        """With a last dimension of 1, to multiply vectors."""
        return EnclosedGroups(
            *_parts(Enclosed.spread_out.__get__(self)), self.change[..., None], self.reach[..., None]
        )

    @property
    def middle(self) -> Array:
        """high + low + change, rounded twice."""
        return np.asarray((self.high + self.low) + self.change)

    @property
    def typical(self) -> Array:
        """Of each group's anchor."""
        return np.asarray(self.high + self.low)

    def apart(self, reported: Array) -> Array:
        """Largest distance of the exact numbers from reported ones that are close, (G, m, ...)."""
        distance = np.abs(((reported - self.high) - self.low) - self.change)
        return np.asarray(
            distance * (1.0 + 8.0 * UNIT_ROUNDOFF) + (self.radius[0] + OF_A_DISTANCE * self.reach)
        )

    def errors(self, reported: Array) -> Array:
        """Proven and expected error of reported numbers that are close, (2, G, m, ...)."""
        if reported.ndim != 3:
            return both(self.apart(reported), self.radius[1])
        found = np.empty((reported.shape[2], 2, *reported.shape[:2])).transpose(1, 2, 3, 0)
        distance = np.subtract(reported, self.high, out=found[0])
        distance -= self.low
        distance -= self.change
        np.abs(distance, out=distance)
        distance *= 1.0 + 8.0 * UNIT_ROUNDOFF
        distance += self.radius[0] + OF_A_DISTANCE * self.reach
        found[1] = self.radius[1]
        return np.asarray(found)

    def like(self, values: Array, proven: float = 0.0, expected: float = 0.0) -> EnclosedGroups:
        """Other numbers of the same instants, (G, m, ...), with radii."""
        middle = values.shape[1] // 2
        anchor = Enclosed.of(values[:, middle : middle + 1], 0.0, proven, expected)
        return EnclosedGroups.around(anchor, values - anchor.high)

    def corrected(self, values: Array, off: Enclosed) -> EnclosedGroups:
        """Values (G, m, ...) with what they are off added; radii are those of that."""
        total = self.like(values) + off
        radius = total.radius.copy()
        radius[1] = off.radius[1]
        return EnclosedGroups(total.high, total.low, radius, total.change, total.reach)

    def found(self, values: Array, radius: Array) -> EnclosedGroups:
        """Small plain numbers of the same instants, (G, m, ...), with radii of each."""
        largest = radius.max(axis=2, keepdims=True)
        zero = np.zeros(largest.shape[1:])
        reach = np.abs(values).max(axis=1, keepdims=True)
        return EnclosedGroups(zero, zero, largest, values, reach)

    def cosine_sine(self) -> tuple[EnclosedGroups, EnclosedGroups]:
        """Cosine and sine, by the sine and the versine of the change.

        No sine or cosine changes by more than its angle, and the functions are right to a unit in the last
        place, as for single numbers.
        """
        cosine, sine = Enclosed.cosine_sine(self)
        turned, half = np.sin(self.change), np.sin(0.5 * self.change)
        back = -2.0 * half * half
        changes = (
            cosine.high * back - sine.high * turned,
            sine.high * back + cosine.high * turned,
        )
        more = self.reach * self.radius + np.where(self.reach < WIDE, 0.0, np.inf)
        first, second = (
            _made(anchor, change, self.reach, OF_A_TURN)._with(more)
            for anchor, change in zip((cosine, sine), changes, strict=True)
        )
        return first, second

    def _with(self, more: Array) -> EnclosedGroups:
        """With larger radii, (2, G, 1, ...)."""
        return EnclosedGroups(self.high, self.low, self.radius + more, self.change, self.reach)


def _product(a: Array, b: Array) -> Array:
    """a b, with the instants of a group side by side in memory whatever the two are."""
    shape = np.broadcast_shapes(a.shape, b.shape)
    if len(shape) != 3:
        return np.asarray(a * b)
    product = np.empty((shape[2], *shape[:2])).transpose(1, 2, 0)
    return np.asarray(np.multiply(a, b, out=product))


def _parts(anchor: Enclosed) -> tuple[Array, Array, Array]:
    return anchor.high, anchor.low, anchor.radius


def _made(anchor: Enclosed, change: Array, reach: Array, rounded: float) -> EnclosedGroups:
    """From anchors and changes that are rounded by a part of their reach, which is rounded as well."""
    reach = reach * MORE
    if reach.shape != anchor.high.shape:
        reach = np.broadcast_to(reach, anchor.high.shape)
    lost = rounded * reach
    radius = anchor.radius + lost
    radius[0] += (lost > 0.0) * TINY
    return EnclosedGroups(anchor.high, anchor.low, radius, change, reach)
