r"""Where the coordinates of a pose and their rates exactly are: a correction, and two radii about it.

The certificate of a pose gives y* = y - e to within its spread and tail. Its rates solve

    2 B(y*, v*) = 0,        2 B(y*, a*) + 2 B(v*, v*) = 0,

with known rates w', w''. For a computed v with the exact w' in it, r = 2 B(y*, v), and X close to C_u^-1,

    C_u(y*) (v* - v) = -r,        v* - v = -X r + E (v* - v),        E = I - X C_u(y*).

With q >= |X r|, rounding and doubt of r included, and z' = z + omega r_pose >= |E| of the certificate,

    |v* - v| <= max q / (1 - z') = d,    |v* - v| <= q + F d,    |v* - v| <= q + F (q + F d),

element by element, F = |I - X C_u(y)| + |X| |C_u(y*) - C_u(y)| >= |E|; so a coordinate that does not depend
on another does not share its error. The same for a with r = 2 B(y*, a) + 2 B(v*, v*). r is taken in twice the
working precision of numbers that are known to twice the working precision, so nothing is left of rounding but
what the data have; and it sees whatever a series left out.

What looking at an equation rounds, the expected radius, is |X| times what a plain evaluation of r rounds,
with the pose (and the velocity) off by as much as rounding makes them and as the solver left on purpose; and
of a series what it leaves out on purpose, of each derivative apart, because the series of a rate is cut where
the pose's is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import Certificate
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Summed:
    """How a derivative of the coordinates was summed from a series, (N, size), units per s^d.

    Attributes:
        last, before: the magnitudes of the last two terms, and of the two before them.
        terms: the magnitudes of all terms. Their own rounding goes with them and with the condition number,
            also where they cancel.
    """

    last: Array
    before: Array
    terms: Array

    def expected(self, value: Array, condition: Array, time: Array) -> Array:
        """Error of the sum by what is left out and by rounding, beside that of its value, (N, size).

        Terms that go on as they did, by a factor of q every two, leave out last q / (1 - q); the last two
        are counted with it, and q as at most 0.95.

        Args:
            value: the sum, per `time` s^d.
        """
        terms = self.terms * time[:, None]
        cancelled = np.maximum(terms - np.abs(value), 0.0).max(axis=-1)
        rounded = EPS * (terms + (condition * cancelled)[:, None])
        largest = [part.max(axis=-1) for part in (self.last, self.before)]
        with np.errstate(divide="ignore", invalid="ignore"):
            falling = np.clip(np.nan_to_num(largest[0] / largest[1], posinf=1.0), 0.0, 0.95)
        return np.asarray(self.last * (time / (1.0 - falling))[:, None] + rounded)


def enclosed_coordinates(
    mechanism: Mechanism,
    factors: Factors,
    certificate: Certificate,
    states: Sequence[Array],
    data: tuple[Array, Array, Array],
    driven: Mapping[int, Sequence[Enclosed]],
    summed: Sequence[Summed],
    unsolved: Array,
    powers: Sequence[Array],
) -> list[Enclosed]:
    """The exact coordinates y* and as many of their time derivatives as were solved for, each (N, size).

    Args:
        states: computed y and its time derivatives, (N, size), units per unit of time^d.
        data: what the known coordinates of y lack, their uncertainty and the one expected, (N, size).
        driven: by place in y each driven coordinate with its first and second derivative, each (N,).
        summed: how each of the states was summed; empty if they were solved for.
        unsolved: how far from its assembly each pose was left on purpose, (N,).
        powers: of the unit of time, s^d, each (N,).
    """
    system, n = mechanism.map, mechanism.map.unknowns
    y, (lacking, uncertainty, expected) = states[0], data
    inverse = factors.preconditioner
    magnitude = np.abs(inverse)
    proven = uncertainty.copy()
    rounded = certificate.spread + 32 * UNIT_ROUNDOFF * np.abs(certificate.step)
    proven[:, :n] = rounded + _tail(system, certificate, magnitude)
    rounded = _applied(magnitude, system.uncertainty(y, expected))
    expected = expected + UNIT_ROUNDOFF * np.abs(y)
    expected[:, :n] += rounded + unsolved[:, None]
    lacking = lacking.copy()
    lacking[:, :n] = -certificate.step
    pose = Enclosed.of(y, lacking, proven, expected)
    moved = np.abs(lacking) + pose.radius[0]
    spoilt = certificate.defect + magnitude @ system.jacobian_uncertainty(moved)
    result = [pose]
    known = [_known_rate(y.shape, driven, derivative) for derivative in range(1, len(states))]
    for derivative in range(1, len(states)):
        computed = _with_known(states[derivative], known[derivative - 1], n)
        rest = twice_polar(system, pose, computed)
        if derivative == 2:
            rest = rest + twice_polar(system, result[1], result[1])
        result.append(_corrected(computed, rest, factors, certificate, spoilt))
    if summed:
        for derivative, state in enumerate(result):
            made = summed[derivative].expected(states[derivative], factors.condition, powers[derivative])
            state.radius[1, :, :n] += made[:, :n]
    return result


def _tail(system: QuadraticMap, certificate: Certificate, magnitude: Array) -> Array:
    """What is left of the error of each coordinate beside e and its spread, (N, unknowns).

    By the mean value form of `kantorovich`, with r the error of each coordinate instead of the largest:
    |I - X C_u| r + |X| |C_u(y + r) - C_u(y)| r / 2, first for the largest and then for what that gives.
    """
    radius = np.broadcast_to(certificate.radius[:, None], certificate.step.shape)
    tail = radius
    for _ in range(2):
        moved = np.concatenate([radius, np.zeros((len(radius), system.size - system.unknowns))], axis=-1)
        bent = 0.5 * magnitude @ system.jacobian_uncertainty(moved)
        tail = np.minimum(_applied(certificate.defect + bent, radius), certificate.tail[:, None])
        radius = np.minimum(radius, np.abs(certificate.step) + certificate.spread + tail)
    return tail


def _corrected(
    computed: Enclosed, rest: Enclosed, factors: Factors, certificate: Certificate, spoilt: Array
) -> Enclosed:
    """The rates that leave no rest, from computed ones that leave `rest` = 2 B(y*, .) + ...

    Args:
        spoilt: F, (N, unknowns, unknowns).
    """
    inverse = factors.preconditioner
    n = inverse.shape[-1]
    gamma = (n + 2) * EPS
    middle, magnitude = rest.middle, np.abs(inverse)
    step = -_applied(inverse, middle)
    proven = _applied(magnitude, rest.radius[0] + gamma * np.abs(middle))
    whole = np.abs(step) + proven
    room = 1.0 - certificate.contraction
    largest = np.where(room > 0.0, whole.max(axis=-1) / room, np.inf)[:, None]
    tail = _applied(spoilt, whole + _applied(spoilt, np.broadcast_to(largest, whole.shape)))
    low, radius = computed.low.copy(), computed.radius.copy()
    low[:, :n] = step
    radius[0, :, :n] = proven + tail
    rounded = _applied(magnitude, rest.radius[1])
    # A rate that does not depend on the others is solved for with them, and has a rounding of theirs left
    # after one refinement.
    shared = gamma * factors.condition * rounded.max(axis=-1)
    radius[1, :, :n] = rounded + shared[:, None]
    radius[1] += UNIT_ROUNDOFF * np.abs(computed.high)
    return Enclosed.of(computed.high, low, *radius)


def _with_known(rate: Array, known: Enclosed, unknowns: int) -> Enclosed:
    """Computed rates of the unknown coordinates, exact as they are, beside those of the known ones."""
    high = known.high.copy()
    high[:, :unknowns] = rate[:, :unknowns]
    return Enclosed(high, known.low, known.radius)


def _known_rate(
    shape: tuple[int, ...], driven: Mapping[int, Sequence[Enclosed]], derivative: int
) -> Enclosed:
    """A derivative of the known coordinates, (N, size): zero but where an input drives one."""
    parts = [np.zeros(shape) for _ in range(4)]
    for place, series in driven.items():
        rate = series[derivative]
        for array, values in zip(parts, (rate.high, rate.low, *rate.radius), strict=True):
            array[:, place] = values
    return Enclosed.of(*parts)


def twice_polar(system: QuadraticMap, a: Enclosed, b: Enclosed) -> Enclosed:
    """2 B(a, b), shape (..., rows)."""
    coefficients, starts, (left, right) = system.terms
    left_a, right_a = (a.take(first) - a.take(second) for first, second in (left, right))
    if a is b:
        terms = (left_a * right_a).scaled(2.0)
    else:
        left_b, right_b = (b.take(first) - b.take(second) for first, second in (left, right))
        terms = left_a * right_b + left_b * right_a
    return row_sums(terms * Enclosed.of(coefficients), starts)


def row_sums(terms: Enclosed, starts: NDArray[np.intp]) -> Enclosed:
    """Sums of runs of terms."""
    lengths = np.diff(starts, append=terms.high.shape[-1])
    total = terms.take(starts)
    for place in range(1, int(lengths.max())):
        more = (lengths > place).astype(float)
        total = total + terms.take(np.where(lengths > place, starts + place, 0)).scaled(more)
    return total


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])
