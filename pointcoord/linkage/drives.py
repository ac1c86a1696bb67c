"""How an input of the user becomes a known coordinate of the map, and back.

Values are power series of shape (..., order + 1); lengths are in units of the mechanism.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.double_double import Pair, exact_square, pair_quotient, two_product
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.time_functions import cosine

Array = NDArray[np.float64]


SIDEWAYS = {"right": "to the right", "left": "to the left"}
TURN = 6.283185307179586, 2.4492935982947064e-16
"""2 pi as high and low."""
EXTREME = 8.0  # sizes of the mechanism


class Line(Protocol):
    """A line along which something slides, by a vector d."""

    @property
    def name(self) -> str:
        """What messages call it."""
        ...

    def length(self, drawing: Drawing) -> Pair:
        """|d| as high and low, shape (...,)."""
        ...

    def foot(self, drawing: Drawing) -> Array:
        """The place at which the drawing stands, in parts of d, shape (...,)."""
        ...


class Drive(Protocol):
    """One driven coordinate and the input that drives it."""

    @property
    def coordinate(self) -> str:
        """Name of the known coordinate."""
        ...

    @property
    def input(self) -> str:
        """Name of the input."""
        ...

    @property
    def unit(self) -> str:
        """Unit of the input, rad or mm."""
        ...

    @property
    def sign(self) -> str:
        """Where the input is positive, in words."""
        ...

    @property
    def pushes(self) -> str:
        """The point that it slides, inboard of what is linked to it; empty if it slides none."""
        ...

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The coordinate's series from the input's."""
        ...

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """The coordinate's series where the input is middle + half s, for all of |s| <= 1.

        Args:
            middle, half: shape (...).
        Returns:
            The series, shape (..., order + 1), and how far it and its first and second derivative by s may be
            off anywhere there, each (...); what `rounding` says of its first term is lacking apart from that.
        """
        ...

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """What the computed coordinate of an input lacks, and how uncertain it is with that added.

        Args:
            law: how far the input's value may be off, in its unit.
        """
        ...

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> tuple[Enclosed, Enclosed, Enclosed]:
        """Where the coordinate and its first and second derivative exactly are.

        Args:
            law: the input's value, rate and acceleration, each (N,), in its unit per s^d.
        """
        ...

    def drawn(self, drawing: Drawing) -> Array:
        """The coordinate at which the drawing itself stands."""
        ...

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The input that gives a coordinate."""
        ...

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Two values of the coordinate beyond which no input makes sense, each of shape (...)."""
        ...


def within_a_turn(angle: Enclosed) -> Enclosed:
    """An angle less whole turns, between -pi and pi."""
    turns = np.rint(np.nan_to_num(angle.high, posinf=0.0, neginf=0.0) / TURN[0])
    high, low = two_product(turns, np.full_like(turns, TURN[0]))
    # What the two parts of a turn leave out is below 1e-32 of it.
    doubt = 1e-31 * np.abs(turns) + 4 * UNIT_ROUNDOFF**2 * np.abs(high)
    return angle - Enclosed.of(high, low + turns * TURN[1], doubt, doubt)


def _circle_over(
    middle: Array, half: Array, order: int, length: Array, extra: float, own: Callable[[Array], Array]
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Terms length half^k / k! by cos(middle + k pi/2), |k| <= order, order 3 or more; and their doubts.

    A term is rounded 2 k times by its powers and factorials and `extra` times beside. What is left out falls
    faster than the powers of half / (order + 1), which is below 1.

    Args:
        own: the doubt of the first term.
    """
    k = np.arange(order + 1)
    turned = np.stack([np.cos(middle), -np.sin(middle), -np.cos(middle), np.sin(middle)], axis=-1)
    factorials = np.cumprod(np.maximum(k, 1), dtype=float)
    sizes = length[..., None] * half[..., None] ** k / factorials
    series = sizes * turned[..., k % 4]
    rounded = (2.0 * k + extra) * UNIT_ROUNDOFF * np.abs(series)
    rounded[..., 0] = own(series[..., 0])
    doubts: list[Array] = []
    for d, falling in enumerate((np.ones(order + 1), k, k * (k - 1.0))):
        first = length * half ** (order + 1) / float(np.prod(np.arange(1.0, order + 2.0 - d)))
        beyond = first / (1.0 - half / (order + 2.0 - d))
        doubts.append((rounded * falling).sum(axis=-1) + 1.01 * beyond)
    return series, (doubts[0], doubts[1], doubts[2])


@dataclass(frozen=True)
class ArmAngle:
    """rise = d cos(angle), d the drawn length from pivot to point (paper eq. 12); angle in rad.

    The cosine tells angles apart between 0 and pi only, so only these are allowed.
    """

    coordinate: str
    input: str
    pivot: str
    point: str
    direction: str

    @property
    def unit(self) -> str:
        """Radians."""
        return "rad"

    @property
    def sign(self) -> str:
        """From the arm along the direction on."""
        return f"from the arm pointing {self.direction}"

    @property
    def pushes(self) -> str:
        """None: an arm turns."""
        return ""

    def series(self, value: Array, drawing: Drawing) -> Array:
        """d cos of the angle's series.

        Raises:
            InputOutOfRange: an angle outside 0 .. pi.
        """
        angle = value[..., 0]
        inside = (angle >= 0.0) & (angle <= np.pi)
        if not inside.all():
            worst = float(np.atleast_1d(angle[~inside])[0])
            line = "the upward vertical" if self.direction == "up" else f"the direction {self.direction}"
            allowed = f"0 to pi rad, measured from {line}"
            if 2.0 * np.pi < worst <= 180.0:
                allowed += f" (if {worst:.10g} is meant in degrees, it is {np.radians(worst):.10g} rad)"
            raise InputOutOfRange(self.input, worst, allowed)
        with np.errstate(over="ignore", invalid="ignore"):
            return drawing.distance(self.pivot, self.point)[..., None] * cosine(value)

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """Terms d half^k / k! by cos(middle + k pi/2), |k| <= order, order 3 or more.

        A term is rounded 2 k times by its powers and factorials and 4 times beside, and the length lacks u of
        itself. What is left out falls faster than the powers of half / (order + 1), which is below 1.
        """
        length = drawing.distance(self.pivot, self.point)
        return _circle_over(
            np.asarray(middle), np.asarray(half), order, length, 5.0, self._own_doubt(drawing)
        )

    def _own_doubt(self, drawing: Drawing) -> Callable[[Array], Array]:
        return lambda coordinate: self.rounding(coordinate, drawing, 0.0)[1]

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """The length's rounding is known, so the rise lacks it in proportion.

        The cosine is rounded to 1 unit in the last place at worst, which is 2 u, and the product by u; its
        angle's uncertainty enters as the sine, at most 1.
        """
        length, lacking = self._length(drawing)
        return coordinate * lacking, 3.01 * UNIT_ROUNDOFF * np.abs(coordinate) + 1.01 * length * law

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> tuple[Enclosed, Enclosed, Enclosed]:
        """d cos(angle), -d sin(angle) angle' and -d (sin(angle) angle'' + cos(angle) angle'^2)."""
        angle, rate, acceleration = law
        length, lacking = self._length(drawing)
        # What is left of the length is of the order of u^2, and plain doubles round it once or twice.
        arm = Enclosed.of(
            length, length * lacking, 256 * UNIT_ROUNDOFF**2 * length, 2 * UNIT_ROUNDOFF * length
        )
        cosine, sine = angle.cosine_sine()
        second = sine * acceleration + cosine * rate * rate
        return arm * cosine, -(arm * sine * rate), -(arm * second)

    def _length(self, drawing: Drawing) -> tuple[Array, Array]:
        """The drawn length and the part of it that it lacks."""
        length = drawing.distance(self.pivot, self.point)
        square, rest = exact_square(drawing.vectors[self.point], drawing.vectors[self.pivot])
        own, own_rest = two_product(length, length)
        return length, ((square - own) + (rest - own_rest)) / (2.0 * length * length)

    def drawn(self, drawing: Drawing) -> Array:
        """Height of the drawn point over its pivot."""
        return drawing.along(self.pivot, self.point, self.direction)

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """arccos(rise / d)."""
        ratio = coordinate / drawing.distance(self.pivot, self.point)
        return np.asarray(np.arccos(np.clip(ratio, -1.0, 1.0)))

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """The arm straight up and straight down."""
        length = drawing.distance(self.pivot, self.point)
        return length, -length


@dataclass(frozen=True)
class Travel:
    """A displacement of a point from an origin along a direction of the car; mm.

    Attributes:
        origin: where it counts from; the point itself where that is its own drawn place.
        slides: whether the point is pushed along a line, inboard of what is linked to it.
    """

    coordinate: str
    input: str
    origin: str
    point: str
    direction: str
    slides: bool = True

    @property
    def unit(self) -> str:
        """Millimetres."""
        return "mm"

    @property
    def sign(self) -> str:
        """Along the direction."""
        return SIDEWAYS.get(self.direction, self.direction)

    @property
    def pushes(self) -> str:
        """The point that slides."""
        return self.point if self.slides else ""

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The displacement in the mechanism's units."""
        return value / np.asarray(drawing.unit)[..., None]

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """Two terms, exactly."""
        series = np.zeros((*np.shape(middle), order + 1))
        series[..., 0], series[..., 1] = middle / drawing.unit, half / drawing.unit
        exact = np.zeros(np.shape(middle))
        return series, (exact, exact, exact)

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """None of its own: a quotient by a power of two."""
        return np.zeros_like(coordinate), np.broadcast_to(law / drawing.unit, coordinate.shape)

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> tuple[Enclosed, Enclosed, Enclosed]:
        """The input's own, in the mechanism's units."""
        value, rate, acceleration = (part.scaled(1.0 / drawing.unit) for part in law)
        return value, rate, acceleration

    def drawn(self, drawing: Drawing) -> Array:
        """The travel at which the drawn point stands."""
        return drawing.along(self.origin, self.point, self.direction)

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The displacement in mm."""
        return np.asarray(coordinate * drawing.unit)

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Eight sizes to either side: no rod that is drawn within one size reaches as far."""
        return -EXTREME * np.ones_like(drawing.unit), EXTREME * np.ones_like(drawing.unit)


@dataclass(frozen=True)
class TravelAlong:
    """A displacement of a point along a line that is drawn between two others; mm.

    The coordinate is the place along a vector d of the line, travel / |d|, whose length is a constant.
    """

    coordinate: str
    input: str
    point: str
    line: Line

    @property
    def unit(self) -> str:
        """Millimetres."""
        return "mm"

    @property
    def sign(self) -> str:
        """Along the line."""
        return f"along the {self.line.name}"

    @property
    def pushes(self) -> str:
        """None: such a line may point anywhere."""
        return ""

    def _inverse(self, drawing: Drawing) -> Pair:
        """1 / (unit |d|)."""
        length, rest = self.line.length(drawing)
        return pair_quotient((1.0 / drawing.unit, np.zeros_like(drawing.unit)), (length, rest))

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The displacement by the line's length."""
        return np.asarray(value * self._inverse(drawing)[0][..., None])

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """Two terms; each lacks u of itself by its product, and u more by the inverse."""
        series, inverse = np.zeros((*np.shape(middle), order + 1)), self._inverse(drawing)[0]
        series[..., 0], series[..., 1] = middle * inverse, half * inverse
        slope = 3.0 * UNIT_ROUNDOFF * np.abs(series[..., 1])
        own = self.rounding(series[..., 0], drawing, 0.0)[1]
        return series, (own + slope, slope, np.zeros_like(slope))

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """The place lacks in proportion what the inverse does; the product is rounded by u."""
        inverse, rest = self._inverse(drawing)
        doubt = 1.01 * UNIT_ROUNDOFF * np.abs(coordinate) + 1.01 * inverse * law
        return coordinate * (rest / inverse), doubt

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> tuple[Enclosed, Enclosed, Enclosed]:
        """The input's own by the line's length."""
        inverse, rest = self._inverse(drawing)
        scale = Enclosed.of(
            inverse, rest, 256 * UNIT_ROUNDOFF**2 * np.abs(inverse), 2 * UNIT_ROUNDOFF * np.abs(inverse)
        )
        value, rate, acceleration = (part * scale for part in law)
        return value, rate, acceleration

    def drawn(self, drawing: Drawing) -> Array:
        """The place at which the drawn point stands."""
        return self.line.foot(drawing)

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The displacement in mm."""
        return np.asarray(coordinate * drawing.unit * self.line.length(drawing)[0])

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Eight sizes to either side, as of `Travel`."""
        farthest = EXTREME / self.line.length(drawing)[0]
        return -farthest, farthest


@dataclass(frozen=True)
class DistanceOf:
    """The distance of two points; the coordinate is its square; mm."""

    coordinate: str
    input: str
    start: str
    end: str

    @property
    def unit(self) -> str:
        """Millimetres."""
        return "mm"

    @property
    def sign(self) -> str:
        """A distance is positive."""
        return "apart"

    @property
    def pushes(self) -> str:
        """None: both may move."""
        return ""

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The square of the distance in the mechanism's units.

        Raises:
            InputOutOfRange: a distance that is not positive.
        """
        x = value / np.asarray(drawing.unit)[..., None]
        if not (x[..., 0] > 0.0).all():
            worst = float(np.atleast_1d(value[..., 0][~(x[..., 0] > 0.0)])[0])
            raise InputOutOfRange(self.input, worst, "a distance above 0 mm")
        found = np.zeros_like(x)
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(x.shape[-1]):
                found[..., k] = np.sum(x[..., : k + 1] * x[..., k::-1][..., : k + 1], axis=-1)
        return found

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """Three terms, each rounded once or twice."""
        m, h = middle / drawing.unit, half / drawing.unit
        series = np.zeros((*np.shape(middle), order + 1))
        series[..., 0], series[..., 1], series[..., 2] = m * m, 2.0 * m * h, h * h
        own = self.rounding(series[..., 0], drawing, 0.0)[1]
        first, second = (1.01 * UNIT_ROUNDOFF * np.abs(series[..., k]) for k in (1, 2))
        return series, (own + first + second, first + 2.0 * second, 2.0 * second)

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """Rounded once; twice the distance by the law's own doubt."""
        off = law / drawing.unit
        return np.zeros_like(coordinate), 1.01 * (
            UNIT_ROUNDOFF * np.abs(coordinate) + (2.0 * np.sqrt(np.abs(coordinate)) + off) * off
        )

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> tuple[Enclosed, Enclosed, Enclosed]:
        """x^2, 2 x x' and 2 (x'^2 + x x'')."""
        x, v, a = (part.scaled(1.0 / drawing.unit) for part in law)
        return x * x, (x * v).scaled(2.0), (v * v + x * a).scaled(2.0)

    def drawn(self, drawing: Drawing) -> Array:
        """The square of the drawn distance."""
        return np.asarray(drawing.distance(self.start, self.end) ** 2)

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The distance in mm."""
        return np.asarray(np.sqrt(np.maximum(coordinate, 0.0)) * drawing.unit)

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Together, and eight sizes apart."""
        return np.zeros_like(drawing.unit), EXTREME**2 * np.ones_like(drawing.unit)


@dataclass(frozen=True)
class TurnedBy:
    """A turn from the drawing on; one of its coordinates is the cosine, another the sine; rad.

    Attributes:
        quarter: 0 for the cosine, 1 for the sine: cos(angle - quarter pi / 2).
    """

    coordinate: str
    input: str
    quarter: int

    @property
    def unit(self) -> str:
        """Radians."""
        return "rad"

    @property
    def sign(self) -> str:
        """About the hinge."""
        return "right-handed about the hinge"

    @property
    def pushes(self) -> str:
        """None: a body turns."""
        return ""

    def series(self, value: Array, drawing: Drawing) -> Array:
        """The cosine or sine of the angle's series, which c' = -s a' and s' = c a' give term by term."""
        with np.errstate(over="ignore", invalid="ignore"):
            cosine_terms = cosine(value)
            if not self.quarter:
                return cosine_terms
            sine = np.zeros_like(value)
            sine[..., 0] = np.sin(value[..., 0])
            weighted = value * np.arange(value.shape[-1])
            for k in range(1, value.shape[-1]):
                head = weighted[..., 1 : k + 1]
                sine[..., k] = np.sum(head * cosine_terms[..., k - 1 :: -1][..., :k], axis=-1) / k
        return sine

    def series_over(
        self, middle: Array, half: Array, order: int, drawing: Drawing
    ) -> tuple[Array, tuple[Array, Array, Array]]:
        """Terms half^k / k! by cos(middle - quarter pi/2 + k pi/2); the middle itself is not turned."""
        middle, half = np.asarray(middle), np.asarray(half)
        one = np.ones_like(half)
        # sin(x) = cos(x + 3 pi / 2): the series of the cosine with three terms skipped.
        k = np.arange(order + 1)
        _, doubts = _circle_over(
            middle, half, order, one, 5.0, lambda first: 3.0 * UNIT_ROUNDOFF + 0.0 * first
        )
        turned = np.stack([np.cos(middle), -np.sin(middle), -np.cos(middle), np.sin(middle)], axis=-1)
        factorials = np.cumprod(np.maximum(k, 1), dtype=float)
        series = half[..., None] ** k / factorials * turned[..., (k + 3 * self.quarter) % 4]
        rounded = (2.0 * k + 5.0) * UNIT_ROUNDOFF * half[..., None] ** k / factorials
        own = tuple(
            doubt + (rounded * falling).sum(axis=-1)
            for doubt, falling in zip(doubts, (np.ones(order + 1), k, k * (k - 1.0)), strict=True)
        )
        return series, (own[0], own[1], own[2])

    def rounding(self, coordinate: Array, drawing: Drawing, law: Array | float) -> tuple[Array, Array]:
        """Rounded to 1 unit in the last place at worst, which is 2 u; the angle's doubt enters whole."""
        return np.zeros_like(coordinate), 2.01 * UNIT_ROUNDOFF * np.abs(coordinate) + 1.01 * np.broadcast_to(
            law, coordinate.shape
        )

    def enclosed(self, law: Sequence[Enclosed], drawing: Drawing) -> tuple[Enclosed, Enclosed, Enclosed]:
        """f, f' a' and f' a'' + f'' a'^2 with f the cosine or the sine."""
        angle, rate, acceleration = law
        cosine, sine = within_a_turn(angle).cosine_sine()
        value, slope = (sine, cosine) if self.quarter else (cosine, -sine)
        return value, slope * rate, slope * acceleration - value * rate * rate

    def drawn(self, drawing: Drawing) -> Array:
        """The drawing is not turned."""
        return (0.0 if self.quarter else 1.0) * np.ones_like(drawing.unit)

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The angle up to whole turns and, from one of its two coordinates, its sign (see `Mechanism`)."""
        value = np.clip(coordinate, -1.0, 1.0)
        return np.asarray(np.arcsin(value) if self.quarter else np.arccos(value))

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Half a turn to either side."""
        one = np.ones_like(drawing.unit)
        return -one, one
