r"""Drives: how an input of the user becomes a known coordinate of the map, and back.

A coordinate is s x, or s cos(x - quarter pi / 2): the cosine of the input x, or with quarter = 1 the sine.
The scale s is a number of the drawing. Values are power series of shape (..., order + 1); lengths are in
units of the mechanism.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import comb
from operator import methodcaller

import numpy as np

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.constraints.on_line import Line
from pointcoord.linkage.directions import DIRECTIONS, V
from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import Pair, pair_product, pair_quotient
from pointcoord.numerics.enclosure import TURN, Enclosed, within_a_turn
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.time_functions import cosine_and_sine

SIDEWAYS = {"right": "to the right", "left": "to the left"}
EXTREME = 8.0
"""In sizes of the mechanism: a rod drawn within one size cannot reach as far."""
NO_LIMITS = -np.inf, np.inf
# Rounding errors in units of rounding. ROUNDED: of a computed cosine, 1 unit in the last place at worst.
# OF_A_TERM: additional for each term of its series; in the recursion only half / k times the previous term's
# error is left, plus a product and a quotient.
ROUNDED, OF_A_TERM = 2.0, 2.0


@dataclass(frozen=True)
class Drive:
    """One driven coordinate and its input; the functions below make each kind.

    Attributes:
        coordinate: name of the known coordinate. input: name of the input.
        unit: unit of the input, rad or mm.
        sign: direction in which the input is positive, in words.
        scale: s as high and low part, shape (...).
        drawn: value of the coordinate in the drawing.
        exact: whether s is a power of two, so that multiplying by it is exact.
        quarter: 0 for a cosine, 1 for a sine; None where the coordinate is proportional to the input.
        limits, allowed: smallest and largest valid value, and the valid range in words.
        of_slide: whether the coordinate is the travel of a slide, which steers the car.
        pushed: the point that slides along a direction of the car, if any.
        by_travel: the drive by the slide's travel, mm, where the input, a steering wheel, stands for one.
    """

    coordinate: str
    input: str
    unit: str
    sign: str
    scale: Callable[[Drawing], Pair] = field(compare=False)
    drawn: Callable[[Drawing], Array] = field(compare=False)
    exact: bool = True
    quarter: int | None = None
    limits: tuple[float, float] = NO_LIMITS
    allowed: str = ""
    of_slide: bool = False
    pushed: str = ""
    by_travel: Drive | None = None

    @property
    def travel(self) -> Drive:
        """The drive of this coordinate by a travel if there is one, else this drive."""
        return self.by_travel or self

    @property
    def is_turn(self) -> bool:
        """Whether the input is a rotation without limits, which has two coordinates."""
        return self.quarter is not None and not self.allowed

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The coordinate's series from the input's.

        Raises:
            InputOutOfRange: a value outside the valid range.
        """
        if self.allowed:
            first = np.ravel(value[..., 0])
            outside = first[~((first >= self.limits[0]) & (first <= self.limits[1]))]
            if len(outside):
                raise InputOutOfRange(self.input, float(outside[0]), self._allowed(float(outside[0])))
        with np.errstate(over="ignore", invalid="ignore"):
            own = value if self.quarter is None else cosine_and_sine(value)[self.quarter]
        return np.asarray(self.scale(drawing)[0][..., None] * own)

    def _allowed(self, worst: float) -> str:
        if self.unit == "rad" and 2.0 * np.pi < worst <= 180.0:
            in_degrees = f"if {worst:.10g} is meant in degrees, it is {np.radians(worst):.10g} rad"
            return f"{self.allowed} ({in_degrees})"
        return self.allowed

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """The coordinate's series where the input is middle + half s, for all |s| <= 1.

        Args:
            middle, half: shape (...). order: 3 or more, and at least the largest half.
        Returns:
            The series, shape (..., order + 1), and error bounds of its value and its first and second
            derivative by s over |s| <= 1, each (...). The error that `rounding` returns for the first term
            comes in addition.
        """
        value, k = np.zeros((*np.shape(middle), order + 1)), np.arange(order + 1)
        value[..., 0], value[..., 1] = middle, half
        series, scale = self.series(value, drawing), self.scale(drawing)[0]
        # s has an error of at most 2 units, and the product adds one.
        units, left_out = np.full(order + 1, 0.0 if self.exact else 3.0), [0.0 * half] * 3
        if self.quarter is not None:
            units += ROUNDED + OF_A_TERM * k
            # Terms are half^k / k! cos(middle + k pi / 2): the remainder falls faster than the powers of
            # half / (order + 1).
            for d in range(3):
                first = half ** (order + 1) / float(np.prod(np.arange(1.0, order + 2.0 - d)))
                left_out[d] = 1.01 * first / (1.0 - half / (order + 2.0 - d))
        rounded = _units(units) * np.abs(series)
        rounded[..., 0] = self.rounding(series[..., 0], drawing, 0.0)[1]
        value_off, rate_off, bend_off = (
            (rounded * falling).sum(axis=-1) + scale * left
            for falling, left in zip((np.ones(order + 1), k, k * (k - 1.0)), left_out, strict=True)
        )
        return series, (value_off, rate_off, bend_off)

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """Rounding error of a computed coordinate, to be added to it, and the uncertainty that then remains.

        The error is in proportion to that of s; the cosine and the product add rounding. An error of the
        input counts at most s times.

        Args:
            law: error bound of the input's value, in its unit.
        """
        scale, rest = self.scale(drawing)
        change = np.broadcast_to(scale * law, coordinate.shape)
        if self.exact and self.quarter is None:
            return np.zeros_like(coordinate), change
        units = (0.0 if self.quarter is None else ROUNDED) + (0.0 if self.exact else 1.0)
        return coordinate * (rest / scale), _units(units) * np.abs(coordinate) + 1.01 * change

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> list[Enclosed]:
        """The exact coordinate and its time derivatives, enclosed.

        Args:
            law: the input's enclosed value and time derivatives, each (N,), in its unit per s^d.
        """
        values = list(law)
        if self.quarter is not None:
            cosine, sine = within_a_turn(law[0]).cosine_sine()
            slopes = turn_slopes(cosine, sine, Enclosed.of(1.0) - cosine, law[1:])
            # cos and versine 1 - cos have opposite derivatives.
            cosines, sines = [cosine, *(-versine for _, versine in slopes[1:])], [own for own, _ in slopes]
            values = sines if self.quarter else cosines
        scale, rest = self.scale(drawing)
        if self.exact:
            return [value.scaled(scale) for value in values]
        # The rest of s is of the order of u^2, so double rounding of it is enough.
        size = np.abs(scale)
        whole = Enclosed.of(scale, rest, 256 * UNIT_ROUNDOFF**2 * size, 2 * UNIT_ROUNDOFF * size)
        return [value * whole for value in values]

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The input that gives a coordinate.

        For a cosine it is between 0 and pi, for a sine between -pi / 2 and pi / 2.
        """
        value = coordinate / self.scale(drawing)[0]
        if self.quarter is None:
            return value
        value = np.clip(value, -1.0, 1.0)
        return np.asarray(np.arcsin(value) if self.quarter else np.arccos(value))

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Smallest and largest value of the coordinate that can make sense, each of shape (...)."""
        travel = self.travel
        farthest = travel.scale(drawing)[0] * (EXTREME * drawing.unit if self.quarter is None else 1.0)
        return (0.0 if self.quarter is None and self.allowed else -1.0) * farthest, farthest


def turn_slopes(cosine: V, sine: V, versine: V, rates: Sequence[V]) -> list[tuple[V, V]]:
    """Sine and versine of an angle, and their time derivatives, from the rates of the angle.

    Both change with the angle: sin' = cos angle', (1 - cos)' = sin angle', and cos' = -(1 - cos)'.
    """
    found = [(sine, versine)]
    for d in range(1, len(rates) + 1):
        along, across = cosine * rates[d - 1], sine * rates[d - 1]
        for i in range(1, d):
            along = along - times(comb(d - 1, i), found[i][1] * rates[d - 1 - i])
            across = across + times(comb(d - 1, i), found[i][0] * rates[d - 1 - i])
        found.append((along, across))
    return found


def times(count: int, product: V) -> V:
    """A product times a whole number, in either arithmetic."""
    return product.times(count) if isinstance(product, Enclosed) else product * count


def _units(count: Array | float) -> Array:
    """Relative error of `count` roundings in sequence; zero for none."""
    return np.where(np.asarray(count) > 0.0, np.asarray(count) + 0.01, 0.0) * UNIT_ROUNDOFF


def arm_angle(coordinate: str, input: str, pivot: str, point: str, direction: str) -> Drive:
    """rise = d cos(angle), d the drawn length from pivot to point (paper eq. 12); angle in rad.

    The cosine is unique between 0 and pi only, so other angles are not allowed.
    """
    line = "the upward vertical" if direction == "up" else f"the direction {direction}"
    return Drive(
        coordinate,
        input,
        "rad",
        f"from the arm pointing {direction}",
        methodcaller("length", pivot, point),
        methodcaller("along", pivot, point, direction),
        exact=False,
        quarter=0,
        limits=(0.0, np.pi),
        allowed=f"0 to pi rad, measured from {line}",
    )


def travel(
    coordinate: str, input: str, origin: str, point: str, direction: str, *, slides: bool = True
) -> Drive:
    """A displacement of a point from an origin along a direction of the car; mm.

    Args:
        origin: point from which it is measured; the point itself if measured from its own drawn place.
        slides: whether the point is pushed along a line, inboard of the point linked to it.
    """
    sign, drawn = SIDEWAYS.get(direction, direction), methodcaller("along", origin, point, direction)
    pushed = point if slides else ""
    return Drive(coordinate, input, "mm", sign, _size, drawn, of_slide=slides, pushed=pushed)


def travel_along(coordinate: str, input: str, line: Line, point: str) -> Drive:
    """A displacement of a point along a line, which may be drawn between two other points; mm.

    The coordinate is the place along a vector d of the line, travel / |d|, with |d| constant.
    """
    if line.head in DIRECTIONS:
        return travel(coordinate, input, line.origin, point, line.head)
    sign, drawn = f"along the {line.name}", partial(line.foot, point)
    return Drive(coordinate, input, "mm", sign, partial(_by_length, line), drawn, exact=False, of_slide=True)


def steered(of: Drive, per_turn: float) -> Drive:
    """The rotation of a steering wheel whose pinion moves a slide by per_turn / 2 pi mm per rad.

    Args:
        of: the drive by the slide's travel. per_turn: mm per turn; negative reverses the direction.
    """
    scale, sign = partial(_per_turn, per_turn, of), f"{'' if per_turn > 0.0 else 'against '}{of.sign}"
    return replace(of, unit="rad", sign=sign, scale=scale, exact=False, by_travel=of)


def distance_of(coordinate: str, input: str, start: str, end: str) -> Drive:
    """The distance between two points; mm."""
    above_zero, drawn = (float(np.nextafter(0.0, 1.0)), np.inf), methodcaller("distance", start, end)
    allowed = "a distance above 0 mm"
    return Drive(coordinate, input, "mm", "apart", _size, drawn, limits=above_zero, allowed=allowed)


def turned_by(coordinate: str, input: str, part: int) -> Drive:
    """One coordinate of a rotation measured from the drawing: its cosine (part 0) or sine (part 1); rad."""
    sign = "right-handed about the hinge"
    return Drive(coordinate, input, "rad", sign, _one, partial(_turned, part), quarter=part)


def _exactly(scale: Array) -> Pair:
    return np.asarray(scale), np.zeros_like(scale)


def _one(drawing: Drawing) -> Pair:
    return _exactly(np.ones_like(drawing.unit))


def _size(drawing: Drawing) -> Pair:
    """1 / unit."""
    return _exactly(1.0 / drawing.unit)


def _by_length(line: Line, drawing: Drawing) -> Pair:
    """1 / (unit |d|)."""
    return pair_quotient(_size(drawing), line.length(drawing))


def _per_turn(per_turn: float, of: Drive, drawing: Drawing) -> Pair:
    """The scale of the travel, times per_turn / 2 pi."""
    turn = np.asarray(TURN[0]), np.asarray(TURN[1])
    return pair_product(pair_quotient(_exactly(np.asarray(per_turn)), turn), of.scale(drawing))


def _turned(part: int, drawing: Drawing) -> Array:
    return (1.0 - part) * np.ones_like(drawing.unit)
