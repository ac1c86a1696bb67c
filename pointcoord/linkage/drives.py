r"""How an input of the user becomes a known coordinate of the map, and back.

A coordinate is s x or s cos(x - quarter pi / 2) of the input x, the cosine or with quarter = 1 the sine, with
a number s of the drawing. Values are power series of shape (..., order + 1); lengths are in units of the
mechanism.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.double_double import Pair, pair_product, pair_quotient
from pointcoord.numerics.enclosure import TURN, Enclosed, within_a_turn
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.time_functions import cosine_and_sine

Array = NDArray[np.float64]

SIDEWAYS = {"right": "to the right", "left": "to the left"}
EXTREME = 8.0
"""Sizes of the mechanism: no rod that is drawn within one size reaches as far."""
# Of a computed cosine, in units of rounding: 1 unit in the last place, at worst. Of a term of its series by
# so many more than of the one before: of the recursion only half / k times that is left, a product and a
# quotient.
ROUNDED, OF_A_TERM = 2.0, 2.0


@dataclass(frozen=True)
class Drive(ABC):
    """One driven coordinate and the input that drives it.

    Attributes:
        coordinate: name of the known coordinate. input: name of the input.
        unit: of the input, rad or mm.
        exact: whether s is a power of two, so that a product with it rounds nothing.
        of_slide: whether it is the travel of a slide, by which a car is steered.
        quarter: None where the coordinate is proportional to the input.
    """

    coordinate: str
    input: str

    unit: ClassVar[str] = "mm"
    exact: ClassVar[bool] = True

    @property
    def of_slide(self) -> bool:
        return False

    @property
    def quarter(self) -> int | None:
        return None

    @property
    def travel(self) -> Drive:
        """What drives the coordinate by a travel, mm, where the input stands for one; else this itself."""
        return self

    @property
    @abstractmethod
    def sign(self) -> str:
        """Where the input is positive, in words."""

    @abstractmethod
    def scale(self, drawing: Drawing) -> Pair:
        """s as high and low, shape (...)."""

    @abstractmethod
    def drawn(self, drawing: Drawing) -> Array:
        """The coordinate at which the drawing itself stands."""

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The coordinate's series from the input's.

        Raises:
            InputOutOfRange: a value that has no meaning for this kind.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            own = value if self.quarter is None else cosine_and_sine(value)[self.quarter]
        return np.asarray(self.scale(drawing)[0][..., None] * own)

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """The coordinate's series where the input is middle + half s, for all of |s| <= 1.

        Args:
            middle, half: shape (...). order: 3 or more, and at least the largest half.
        Returns:
            The series, shape (..., order + 1), and how far it and its first and second derivative by s may be
            off anywhere there, each (...); what `rounding` says of its first term is lacking apart from that.
        """
        value, k = np.zeros((*np.shape(middle), order + 1)), np.arange(order + 1)
        value[..., 0], value[..., 1] = middle, half
        series, scale = self.series(value, drawing), self.scale(drawing)[0]
        # s is off by at most 2 units, and the product by one.
        units, left_out = np.full(order + 1, 0.0 if self.exact else 3.0), [0.0 * half] * 3
        if self.quarter is not None:
            units += ROUNDED + OF_A_TERM * k
            # Terms half^k / k! cos(middle + k pi / 2): what is left out falls faster than the powers of
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
        """What the computed coordinate of an input lacks, and how uncertain it is with that added.

        The coordinate lacks in proportion what s does; a cosine and the product are rounded. It changes by no
        more than s times what the input does.

        Args:
            law: how far the input's value may be off, in its unit.
        """
        scale, rest = self.scale(drawing)
        change = np.broadcast_to(scale * law, coordinate.shape)
        if self.exact and self.quarter is None:
            return np.zeros_like(coordinate), change
        units = (0.0 if self.quarter is None else ROUNDED) + (0.0 if self.exact else 1.0)
        return coordinate * (rest / scale), _units(units) * np.abs(coordinate) + 1.01 * change

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> list[Enclosed]:
        """Where the coordinate and its time derivatives exactly are.

        Args:
            law: the input's value and its time derivatives, each (N,), in its unit per s^d.
        """
        values = list(law) if self.quarter is None else _cosine(law, self.quarter)
        scale, rest = self.scale(drawing)
        if self.exact:
            return [value.scaled(scale) for value in values]
        # What is left of s is of the order of u^2, and plain doubles round it once or twice.
        size = np.abs(scale)
        whole = Enclosed.of(scale, rest, 256 * UNIT_ROUNDOFF**2 * size, 2 * UNIT_ROUNDOFF * size)
        return [value * whole for value in values]

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The input that gives a coordinate.

        Of a cosine it is between 0 and pi, of a sine between -pi / 2 and pi / 2.
        """
        value = coordinate / self.scale(drawing)[0]
        if self.quarter is None:
            return value
        value = np.clip(value, -1.0, 1.0)
        return np.asarray(np.arcsin(value) if self.quarter else np.arccos(value))

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Two values of the coordinate beyond which no input makes sense, each of shape (...)."""
        farthest = self.scale(drawing)[0] * (EXTREME * drawing.unit if self.quarter is None else 1.0)
        return -farthest, farthest


def _cosine(law: Sequence[Enclosed], quarter: int) -> list[Enclosed]:
    """F = cos(x - quarter pi / 2), g x' and so on, g the slope of f, whose own slope is -f."""
    angle, *rates = law
    cosine, sine = within_a_turn(angle).cosine_sine()
    values, slopes = ([sine], [cosine]) if quarter else ([cosine], [-sine])
    for order in range(len(rates)):
        value, slope = _leibniz(slopes, rates, order), -_leibniz(values, rates, order)
        values.append(value)
        slopes.append(slope)
    return values


def _leibniz(one: Sequence[Enclosed], other: Sequence[Enclosed], order: int) -> Enclosed:
    """A time derivative of a product, from those of its factors."""
    first, *others = ((one[i] * other[order - i]).times(comb(order, i)) for i in range(order + 1))
    return sum(others, first)


def _units(count: Array | float) -> Array:
    """So many roundings in a row; none of none."""
    return np.where(np.asarray(count) > 0.0, np.asarray(count) + 0.01, 0.0) * UNIT_ROUNDOFF


def _exactly(scale: Array) -> Pair:
    return np.asarray(scale), np.zeros_like(scale)


@dataclass(frozen=True)
class ArmAngle(Drive):
    """rise = d cos(angle), d the drawn length from pivot to point (paper eq. 12); angle in rad.

    The cosine tells angles apart between 0 and pi only, so only these are allowed.
    """

    pivot: str
    point: str
    direction: str

    unit = "rad"
    quarter = 0
    exact = False

    @property
    def sign(self) -> str:
        return f"from the arm pointing {self.direction}"

    def scale(self, drawing: Drawing) -> Pair:
        return drawing.length(self.pivot, self.point)

    def drawn(self, drawing: Drawing) -> Array:
        return drawing.along(self.pivot, self.point, self.direction)

    def series(self, value: Array, drawing: Drawing) -> Array:
        angle = value[..., 0]
        inside = (angle >= 0.0) & (angle <= np.pi)
        if not inside.all():
            worst = float(np.atleast_1d(angle[~inside])[0])
            line = "the upward vertical" if self.direction == "up" else f"the direction {self.direction}"
            allowed = f"0 to pi rad, measured from {line}"
            if 2.0 * np.pi < worst <= 180.0:
                allowed += f" (if {worst:.10g} is meant in degrees, it is {np.radians(worst):.10g} rad)"
            raise InputOutOfRange(self.input, worst, allowed)
        return super().series(value, drawing)


@dataclass(frozen=True)
class Travel(Drive):
    """A displacement of a point from an origin along a direction of the car; mm.

    Attributes:
        origin: where it counts from; the point itself where that is its own drawn place.
        slides: whether the point is pushed along a line, inboard of what is linked to it.
    """

    origin: str
    point: str
    direction: str
    slides: bool = True

    @property
    def sign(self) -> str:
        """Along the direction."""
        return SIDEWAYS.get(self.direction, self.direction)

    @property
    def of_slide(self) -> bool:
        return self.slides

    def scale(self, drawing: Drawing) -> Pair:
        """1 / unit."""
        return _exactly(1.0 / drawing.unit)

    def drawn(self, drawing: Drawing) -> Array:
        """The travel at which the drawn point stands."""
        return drawing.along(self.origin, self.point, self.direction)


@dataclass(frozen=True)
class TravelAlong(Drive):
    """A displacement of a point along a line that is drawn between two others; mm.

    The coordinate is the place along a vector d of the line, travel / |d|, whose length is a constant.
    """

    line: OnLine

    exact = False
    of_slide = True

    @property
    def sign(self) -> str:
        return f"along the {self.line.line}"

    def scale(self, drawing: Drawing) -> Pair:
        """1 / (unit |d|)."""
        return pair_quotient(_exactly(1.0 / drawing.unit), self.line.length(drawing))

    def drawn(self, drawing: Drawing) -> Array:
        return self.line.foot(drawing)


@dataclass(frozen=True)
class Steered(Drive):
    """The turn of a steering wheel whose pinion makes a travel, per_turn / 2 pi of it; rad.

    Attributes:
        of: the travel. per_turn: mm of it for a whole turn.
    """

    of: Travel | TravelAlong
    per_turn: float

    unit = "rad"
    exact = False
    of_slide = True

    @property
    def travel(self) -> Drive:
        return self.of

    @property
    def sign(self) -> str:
        """As that of its travel, unless that is per turn the other way."""
        return f"{'' if self.per_turn > 0.0 else 'against '}{self.of.sign}"

    def scale(self, drawing: Drawing) -> Pair:
        """The travel's, times per_turn / 2 pi."""
        turn = np.asarray(TURN[0]), np.asarray(TURN[1])
        ratio = pair_quotient(_exactly(np.asarray(self.per_turn)), turn)
        return pair_product(ratio, self.of.scale(drawing))

    def drawn(self, drawing: Drawing) -> Array:
        return self.of.drawn(drawing)

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """The travel's."""
        return self.of.extremes(drawing)


@dataclass(frozen=True)
class DistanceOf(Drive):
    """The distance of two points; mm."""

    start: str
    end: str

    @property
    def sign(self) -> str:
        return "apart"

    def scale(self, drawing: Drawing) -> Pair:
        """1 / unit."""
        return _exactly(1.0 / drawing.unit)

    def drawn(self, drawing: Drawing) -> Array:
        return drawing.distance(self.start, self.end)

    def series(self, value: Array, drawing: Drawing) -> Array:
        if not (value[..., 0] > 0.0).all():
            worst = float(np.atleast_1d(value[..., 0][~(value[..., 0] > 0.0)])[0])
            raise InputOutOfRange(self.input, worst, "a distance above 0 mm")
        return super().series(value, drawing)

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        _, farthest = super().extremes(drawing)
        return 0.0 * farthest, farthest


@dataclass(frozen=True)
class TurnedBy(Drive):
    """A turn from the drawing on; one of its coordinates is the cosine, another the sine; rad.

    Attributes:
        part: 0 for the cosine, 1 for the sine.
    """

    part: int

    unit = "rad"

    @property
    def quarter(self) -> int:
        return self.part

    @property
    def sign(self) -> str:
        return "right-handed about the hinge"

    def scale(self, drawing: Drawing) -> Pair:
        return _exactly(np.ones_like(drawing.unit))

    def drawn(self, drawing: Drawing) -> Array:
        return (1.0 - self.part) * np.ones_like(drawing.unit)
