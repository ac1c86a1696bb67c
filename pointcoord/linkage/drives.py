"""How an input of the user becomes a known coordinate of the map, and back.

Values are power series of shape (..., order + 1); lengths are in units of the mechanism.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.double_double import exact_square, two_product
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.time_functions import cosine, cosine_of_one

Array = NDArray[np.float64]


OPPOSITE_WORDS = {"right": "to the left", "up": "down"}
EXTREME = 8.0  # sizes of the mechanism


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
        if value.ndim == 1 and drawing.unit.ndim == 0 and 0.0 <= float(value[0]) <= np.pi:
            length = float(drawing.distance(self.pivot, self.point))
            return np.array([length * term for term in cosine_of_one(value)])
        angle = value[..., 0]
        inside = (angle >= 0.0) & (angle <= np.pi)
        if not inside.all():
            worst = float(np.atleast_1d(angle[~inside])[0])
            allowed = "0 to pi rad, measured from the upward vertical"
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
        length, middle, half = drawing.distance(self.pivot, self.point), np.asarray(middle), np.asarray(half)
        k = np.arange(order + 1)
        turned = np.stack([np.cos(middle), -np.sin(middle), -np.cos(middle), np.sin(middle)], axis=-1)
        factorials = np.cumprod(np.maximum(k, 1), dtype=float)
        sizes = length[..., None] * half[..., None] ** k / factorials
        series = sizes * turned[..., k % 4]
        rounded = (2.0 * k + 5.0) * UNIT_ROUNDOFF * np.abs(series)
        rounded[..., 0] = self.rounding(series[..., 0], drawing, 0.0)[1]
        doubts: list[Array] = []
        for d, falling in enumerate((np.ones(order + 1), k, k * (k - 1.0))):
            first = length * half ** (order + 1) / float(np.prod(np.arange(1.0, order + 2.0 - d)))
            beyond = first / (1.0 - half / (order + 2.0 - d))
            doubts.append((rounded * falling).sum(axis=-1) + 1.01 * beyond)
        return series, (doubts[0], doubts[1], doubts[2])

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
    """A displacement along a direction; mm."""

    coordinate: str
    input: str
    origin: str
    point: str
    direction: str

    @property
    def unit(self) -> str:
        """Millimetres."""
        return "mm"

    @property
    def sign(self) -> str:
        """Against the direction (eq. 14)."""
        return OPPOSITE_WORDS.get(self.direction, f"against {self.direction}")

    @property
    def pushes(self) -> str:
        """The point that slides."""
        return self.point

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
        """The travel at which the drawn point stands: against the direction is positive (eq. 14)."""
        return -drawing.along(self.origin, self.point, self.direction)

    def input_value(self, coordinate: Array, drawing: Drawing) -> Array:
        """The displacement in mm."""
        return np.asarray(coordinate * drawing.unit)

    def extremes(self, drawing: Drawing) -> tuple[Array, Array]:
        """Eight sizes to either side: no rod that is drawn within one size reaches as far."""
        return -EXTREME * np.ones_like(drawing.unit), EXTREME * np.ones_like(drawing.unit)
