r"""Inputs as functions of time, given by their power series about any instant.

A time function f returns the coefficients f_k of

    f(t + h) = sum_k f_k h^k,      f_0 = f(t), f_1 = f'(t), f_2 = f''(t) / 2, ...

which positions, velocities, accelerations and whole motions are computed from.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from math import comb, factorial, perm
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import two_product, two_sum
from pointcoord.numerics.enclosure import TURN, Enclosed, within_a_turn
from pointcoord.numerics.infinitesimal import slope_of, with_slope
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline


# rad. The cosine of a smaller angle is 1 to rounding, and its sine adds less than one rounding.
SMALL_ANGLE = 2.0**-27


class TimeFunction(ABC):
    """A scalar function of time that is analytic between its breaks.

    A coefficient that overflows is infinite; the caller must check.
    """

    @abstractmethod
    def series(self, instants: ArrayLike, order: int) -> Array:
        """Coefficients about each instant, shape (..., order + 1), unit / s**k."""

    @abstractmethod
    def rounding(self, instants: Array, derivative: int = 0) -> Array:
        """Rounding error of the computed value or derivative, over one rounding of the exact one, (N,)."""

    @abstractmethod
    def exact(self, instants: Array, derivatives: int = 2) -> list[Enclosed]:
        """The exact value and time derivatives of the law, enclosed, each (N,)."""

    def enclosed(self, instants: Array, derivatives: int = 2) -> list[Enclosed]:
        """The exact value and time derivatives of the law, each rounded once, (N,).

        A series does not round its value to a double, so one rounding is expected in addition to `rounding`.
        """
        values = enumerate(self.exact(instants, derivatives))
        return [self._rounded_once(value, instants, derivative) for derivative, value in values]

    def _rounded_once(self, exact: Enclosed, instants: Array, derivative: int) -> Enclosed:
        """The exact value rounded to the nearest double: certain, unless the value lies next to a tie.

        Next to a tie either neighbour is possible. Where twice the working precision is less certain than
        the computed value, the computed value is taken, which may also be a neighbour.
        """
        nearest, radius = exact.high, exact.radius[0]
        gap = 0.5 * np.abs(np.nextafter(nearest, np.copysign(np.inf, exact.low)) - nearest)
        proven = np.where(np.abs(exact.low) + radius < gap, 0.0, radius + 2.0 * gap)
        computed = factorial(derivative) * self.series(instants, derivative)[..., derivative]
        coarse = self.rounding(instants, derivative)
        neighbours = coarse + 2.0 * UNIT_ROUNDOFF * np.abs(computed)
        sharp = proven <= neighbours
        values = np.where(sharp, nearest, computed)
        expected = coarse + UNIT_ROUNDOFF * np.abs(values)
        return Enclosed.of(values, 0.0, np.where(sharp, proven, neighbours), expected)

    @abstractmethod
    def values_over(self, first: Array, last: Array) -> tuple[Array, Array]:
        """Lower and upper bound of every computed value over spans of time, each (N,).

        The bounds approach the least and the largest value with the square of a span's length. Where the law
        is constant, both bounds are its value.

        Args:
            first, last: ends of each span, (N,), s; no break lies between them.
        """

    @property
    def breaks(self) -> tuple[float, ...]:
        """Instants where a derivative jumps, s; a power series must not be used across them."""
        return ()

    @property
    @abstractmethod
    def still(self) -> bool:
        """Whether the law is constant at all times by its form."""


@lru_cache(maxsize=1024)
def _shifted(coefficients: tuple[float, ...], k: int) -> tuple[list[float], list[float]]:
    """binomial(j, k) c_j as high and low parts, for all j from k."""
    factors = [float(comb(j, k)) for j in range(k, len(coefficients))]
    high, low = two_product(np.array(factors), np.array(coefficients[k:]))
    return high.tolist(), low.tolist()


@dataclass(frozen=True)
class Polynomial(TimeFunction):
    """f(t) = sum_j coefficients[j] t^j.

    >>> Polynomial((1.0, 2.0, 3.0)).series(2.0, 2)  # value, rate and half the acceleration at 2 s
    array([17., 14.,  3.])
    """

    coefficients: tuple[float, ...]

    def series(self, instants: ArrayLike, order: int) -> Array:
        """Taylor shift: f_k = sum_{j >= k} binomial(j, k) c_j t^(j - k).

        Horner's rule in twice the working precision: terms may cancel, as where a motion comes to rest.
        """
        t = np.asarray(instants, dtype=float)
        result = np.zeros((*t.shape, order + 1))
        # A Python float in place of an array without dimensions, which takes five times as long.
        numbers: Any = t if t.ndim else t.item()
        count = min(order + 1, len(self.coefficients))
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(count):
                result[..., k] = _doubled_horner(*_shifted(self.coefficients, k), numbers)
            if not np.isfinite(result).all():
                # Splitting a number above 1e300 overflows; the plain sum does not.
                for k in range(count):
                    plain = np.polyval(_shifted(self.coefficients, k)[0][::-1], t)
                    np.copyto(result[..., k], plain, where=~np.isfinite(result[..., k]))
        return result

    def rounding(self, instants: Array, derivative: int = 0) -> Array:
        """4 n^2 u^2 times the sum of n terms' sizes (Graillat, Langlois, Louvet); zero for a constant."""
        law = [abs(c) * float(perm(j, derivative)) for j, c in enumerate(self.coefficients)][derivative:]
        count = len(law)
        with np.errstate(over="ignore"):
            terms = np.polyval(law[::-1], np.abs(instants))
        return np.asarray(4 * count**2 * UNIT_ROUNDOFF**2 * terms if count > 1 else np.zeros_like(instants))

    def exact(self, instants: Array, derivatives: int = 2) -> list[Enclosed]:
        """Horner's rule in twice the working precision, with the bound of its rounding."""
        t, found = Enclosed.of(instants), []
        for derivative in range(derivatives + 1):
            total = Enclosed.of(np.zeros_like(instants))
            for j in range(len(self.coefficients) - 1, derivative - 1, -1):
                factor = Enclosed.of(float(perm(j, derivative)))
                total = total * t + factor * Enclosed.of(self.coefficients[j])
            found.append(total)
        return found

    def values_over(self, first: Array, last: Array) -> tuple[Array, Array]:
        """Bounds from the series about the middle, with each term at its largest."""
        middle, half = middle_and_half(first, last)
        order = len(self.coefficients) - 1
        series = self.series(middle, order)
        errors = [self.rounding(middle, k) / factorial(k) for k in range(order + 1)]
        # The rounding of a value is largest at one of the ends: it grows with the distance from zero.
        at_ends = np.maximum(self.rounding(first), self.rounding(last))
        return _about(series, np.stack(errors, axis=-1), half, at_ends)

    @property
    def still(self) -> bool:
        return not any(self.coefficients[1:])


@dataclass(frozen=True)
class Sine(TimeFunction):
    """f(t) = offset + amplitude sin(angular_frequency t + phase); rad/s and rad."""

    amplitude: float
    angular_frequency: float
    phase: float = 0.0
    offset: float = 0.0

    def series(self, instants: ArrayLike, order: int) -> Array:
        """f_k = amplitude w^k sin(w t + phase + k pi / 2) / k!, plus the offset for k = 0."""
        with np.errstate(over="ignore", invalid="ignore"):
            angle, *rests = self._angle(np.asarray(instants, dtype=float))
            sine, cosine = np.sin(angle), np.cos(angle)
            for low in rests:
                if not low.any():
                    continue
                # The sine of a small angle is the angle itself, to the last digit.
                small = bool((np.abs(low) <= SMALL_ANGLE).all())
                across, along = (low, 1.0) if small else (np.sin(low), np.cos(low))
                sine, cosine = sine * along + cosine * across, cosine * along - sine * across
            quarter_turns = np.array((sine, cosine, -sine, -cosine))
            powers = np.float64(self.angular_frequency) ** np.arange(order + 1)
            factors = self.amplitude * powers / _factorials(order)
            result = np.empty((*np.shape(angle), order + 1))
            for turn in range(min(4, order + 1)):
                result[..., turn::4] = quarter_turns[turn][..., None] * factors[turn::4]
            # The offset may nearly cancel a large swing: product and sum are rounded once together.
            swing, rest = two_product(np.array(self.amplitude), sine)
            value, carry = two_sum(swing, np.array(self.offset))
            exact = value + (carry + rest)
            result[..., 0] = np.where(np.isfinite(exact), exact, swing + self.offset)
        return result

    def _angle(self, instants: Array) -> tuple[Array, ...]:
        """The angle as an unrounded sum of three numbers.

        In a single double a large phase would lose digits of the time, and the values would no longer change
        with their rates; a large frequency would lose digits of the phase.
        """
        turned, rest = two_product(np.array(self.angular_frequency), instants)
        angle, low = two_sum(turned, np.array(self.phase))
        return angle, *(np.where(np.isfinite(part), part, 0.0) for part in (rest, low))

    def rounding(self, instants: Array, derivative: int = 0) -> Array:
        """4 u times the amplitude for sine and sum; 6 u more for each further part of the angle that exceeds
        SMALL_ANGLE, for two products more; 4 u more for a derivative's factor: a power and two products.

        The value may lie next to a tie and be rounded the other way, so 2 u of the value are added.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            _, *rests = self._angle(np.asarray(instants, dtype=float))
            parts = sum((np.abs(low) > SMALL_ANGLE).astype(float) for low in rests)
            count = (8.0 if derivative else 4.0) + 6.0 * parts
            swing = abs(self.amplitude) * np.abs(np.float64(self.angular_frequency)) ** derivative * count
            computed = factorial(derivative) * self.series(instants, derivative)[..., derivative]
            turned = np.where(swing > 0.0, 2.0 * np.abs(computed), 0.0)
        return np.asarray(UNIT_ROUNDOFF * (swing + turned))

    def exact(self, instants: Array, derivatives: int = 2) -> list[Enclosed]:
        """The formulas of `series` in twice the working precision, without whole turns of the angle."""
        speed, swing = Enclosed.of(self.angular_frequency), Enclosed.of(self.amplitude)
        angle = speed * Enclosed.of(instants) + Enclosed.of(self.phase)
        cosine, sine = within_a_turn(angle).cosine_sine()
        quarter_turns, found = (sine, cosine, -sine, -cosine), []
        for derivative in range(derivatives + 1):
            found.append(swing * quarter_turns[derivative % 4])
            swing = swing * speed
        found[0] = Enclosed.of(self.offset) + found[0]
        return found

    def values_over(self, first: Array, last: Array) -> tuple[Array, Array]:
        """Bounds from the values at the ends, and from the crest or trough where the angle may pass one.

        The rounding of the angle in turns is at most 8 units relative to the sum of its magnitudes.
        """
        ends = [self.series(t, 0)[..., 0] for t in (first, last)]
        least, most = np.minimum(*ends), np.maximum(*ends)
        swing = abs(self.amplitude)
        if swing == 0.0 or self.angular_frequency == 0.0:
            return least, most
        with np.errstate(over="ignore", invalid="ignore"):
            angles = [self.angular_frequency * t + self.phase for t in (first, last)]
            sizes = np.maximum(np.abs(self.angular_frequency * first), np.abs(self.angular_frequency * last))
            error = 8.0 * UNIT_ROUNDOFF * (sizes + abs(self.phase) + 1.0)
            low, high = np.minimum(*angles) - error, np.maximum(*angles) + error
            quarter = np.copysign(0.25, self.amplitude)
            # The negated comparison is true for overflow: then the angle may pass both.
            crest, trough = (
                ~(np.ceil(low / TURN[0] - turned) > high / TURN[0] - turned) for turned in (quarter, -quarter)
            )
            most = np.where(crest, self.offset + swing, most)
            least = np.where(trough, self.offset - swing, least)
            rounded = np.maximum(self.rounding(first), self.rounding(last))
            rounded = 2.0 * (rounded + 8.0 * UNIT_ROUNDOFF * (swing + np.abs(most) + np.abs(least)))
        return least - rounded, most + rounded

    @property
    def still(self) -> bool:
        return not (self.amplitude and self.angular_frequency)


@dataclass(frozen=True)
class Table(TimeFunction):
    """The cubic spline through (times, values), not-a-knot at its ends.

    Value, rate and acceleration are continuous; the third derivative jumps at the times, where the piece that
    begins there counts. The law is defined as what scipy's CubicSpline computes: rounding in the spline's own
    equations is not counted as an error.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    def series(self, instants: ArrayLike, order: int) -> Array:
        """The cubic piece that starts at or before each instant, shifted to the instant."""
        t = np.asarray(instants, dtype=float)
        result = np.zeros((*t.shape, order + 1))
        for k in range(min(order, 3) + 1):
            result[..., k] = self._spline(t, nu=k) / factorial(k)
        return result

    def rounding(self, instants: Array, derivative: int = 0) -> Array:
        """Zero: the computed spline is the law."""
        return np.zeros_like(instants)

    def exact(self, instants: Array, derivatives: int = 2) -> list[Enclosed]:
        return [Enclosed.of(self._spline(instants, nu=derivative)) for derivative in range(derivatives + 1)]

    def values_over(self, first: Array, last: Array) -> tuple[Array, Array]:
        """Bounds from the cubic about the middle, with each term at its largest.

        A cubic is computed from the start of its piece. The rounding is at most 8 units relative to the sum
        of the terms there.
        """
        middle, half = middle_and_half(first, last)
        knots, cubics = self._spline.x, np.abs(self._spline.c[::-1])
        place = np.clip(np.searchsorted(knots, middle, side="right") - 1, 0, len(knots) - 2)
        reach = np.maximum(last - knots[place], 0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            rounded = sum(cubics[k][place] * reach**k for k in range(4))
            errors = np.zeros((len(middle), 4))
            for k in range(4):
                falling = (comb(j, k) * cubics[j][place] * reach ** (j - k) for j in range(k, 4))
                errors[:, k] = 8.0 * UNIT_ROUNDOFF * sum(falling)
            return _about(self.series(middle, 3), errors, half, 8.0 * UNIT_ROUNDOFF * rounded)

    @property
    def finite(self) -> bool:
        """Whether the spline exists in floating point: huge values or close times overflow its slopes."""
        try:
            return bool(np.isfinite(self._spline.c).all())
        except ValueError:
            return False

    @cached_property
    def _spline(self) -> CubicSpline:
        # Imported here: it takes seven times as long as numpy, and few scenes have a table.
        from scipy.interpolate import CubicSpline

        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return CubicSpline(self.times, self.values, bc_type="not-a-knot", extrapolate=False)

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.times[1:-1]

    @property
    def still(self) -> bool:
        """Whether all values are equal and the spline gives that value everywhere."""
        return len(set(self.values)) == 1 and not self._spline.c[:-1].any()


@dataclass(frozen=True)
class Sum(TimeFunction):
    """f(t) = sum_i terms[i](t)."""

    terms: tuple[TimeFunction, ...]

    def series(self, instants: ArrayLike, order: int) -> Array:
        return np.asarray(sum(term.series(instants, order) for term in self.terms))

    def rounding(self, instants: Array, derivative: int = 0) -> Array:
        """The terms' rounding, one rounding of each term, and one for each sum that it takes part in."""
        factor = factorial(derivative)
        sizes = (factor * np.abs(term.series(instants, derivative)[..., derivative]) for term in self.terms)
        sums = (len(self.terms) + 1) * UNIT_ROUNDOFF * sum(sizes)
        return np.asarray(sums + sum(term.rounding(instants, derivative) for term in self.terms))

    def exact(self, instants: Array, derivatives: int = 2) -> list[Enclosed]:
        first, *others = (term.exact(instants, derivatives) for term in self.terms)
        for other in others:
            first = [one + another for one, another in zip(first, other, strict=True)]
        return first

    def values_over(self, first: Array, last: Array) -> tuple[Array, Array]:
        """The sums of the terms' lower and upper bounds.

        Where terms change in opposite directions, the bounds approach with the span's length, not its square.
        """
        lows, highs = zip(*(term.values_over(first, last) for term in self.terms), strict=True)
        low, high = sum(lows), sum(highs)
        sizes = sum(np.maximum(np.abs(a), np.abs(b)) for a, b in zip(lows, highs, strict=True))
        # Counts the rounding of a value and of these sums.
        edge = 2.0 * (len(self.terms) + 1) * UNIT_ROUNDOFF * sizes
        return np.asarray(low - edge), np.asarray(high + edge)

    @property
    def breaks(self) -> tuple[float, ...]:
        return tuple(sorted({instant for term in self.terms for instant in term.breaks}))

    @property
    def still(self) -> bool:
        return all(term.still for term in self.terms)


@cache
def _factorials(order: int) -> Array:
    return np.array([float(factorial(k)) for k in range(order + 1)])


def middle_and_half(first: Array, last: Array) -> tuple[Array, Array]:
    """Middles of spans, and half lengths enlarged to reach both ends despite rounding."""
    middle = first + 0.5 * (last - first)
    return middle, np.maximum(last - middle, middle - first) * (1.0 + 4.0 * UNIT_ROUNDOFF)


def _about(series: Array, errors: Array, half: Array, rounded: Array) -> tuple[Array, Array]:
    """Lower and upper bound of a series' sum at most `half` from its middle, each (N,).

    Args:
        series: coefficients about the middles, (N, order + 1). errors: their error bounds, (N, order + 1).
        rounded: further rounding in computing a value, (N,).
    """
    powers = half[:, None] ** np.arange(series.shape[-1])
    with np.errstate(over="ignore", invalid="ignore"):
        spread = (np.abs(series) + errors)[:, 1:] * powers[:, 1:]
        moved = spread.sum(axis=-1)
        value = series[:, 0]
        # Twice the rounding of the value, of the sums here and of the powers.
        count = 4.0 * series.shape[-1] + 8.0
        edge = moved + errors[:, 0] + rounded
        edge += count * UNIT_ROUNDOFF * (np.abs(value) + moved)
        still = moved == 0.0
        return np.where(still, value, value - edge), np.where(still, value, value + edge)


def _doubled_horner(highs: list[Any], lows: list[Any], t: Any) -> Any:
    """sum_j (high_j + low_j) t^j for an array or a number, in twice the working precision."""
    high, low = highs[-1], lows[-1]
    for c, c_low in zip(highs[-2::-1], lows[-2::-1], strict=True):
        product, rest = two_product(high, t)
        rest = rest + low * t
        high, carry = two_sum(product, c)
        low = carry + (rest + c_low)
    return high + low


def cosine_and_sine(angle: Array) -> tuple[Array, Array]:
    r"""Series of cos(a) and sin(a) from the series of a, all of shape (..., order + 1).

    Both are parts of e = exp(i a), and e' = i a' e gives, term by term,
    e_k = (i/k) sum_{j=1..k} j a_j e_{k-j}.

    An angle with a slope (see `infinitesimal`) gives both with theirs, -sin(a) a' and cos(a) a'.
    """
    count = angle.shape[-1]
    if np.iscomplexobj(angle):
        cosine, sine = cosine_and_sine(angle.real)
        own = slope_of(angle)[..., ::-1]

        def moved(series: Array) -> Array:
            terms = [np.vecdot(series[..., : k + 1], own[..., count - 1 - k :]) for k in range(count)]
            return np.stack(terms, axis=-1)

        return with_slope(cosine, -moved(sine)), with_slope(sine, moved(cosine))
    # Stored from last to first, so that the terms in each sum are one slice.
    terms = np.zeros(angle.shape, dtype=complex)
    terms.real[..., -1], terms.imag[..., -1] = np.cos(angle[..., 0]), np.sin(angle[..., 0])
    turned = -1j * np.arange(count) * angle  # minus sign: `vecdot` conjugates its first argument
    for k in range(1, count):
        terms[..., -1 - k] = np.vecdot(turned[..., 1 : k + 1], terms[..., -k:]) / k
    return terms.real[..., ::-1], terms.imag[..., ::-1]
