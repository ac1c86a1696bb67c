r"""A proof of many neighbouring poses by the inverse of one of them.

C is quadratic, so of a pose a and one that lies by d beside it

    C(a + d) = C(a) + sum_t c_t [ (L_t(a) + L_t(d)) R_t(d) + L_t(d) R_t(a) ],

L and R the two differences of a term. The first part is taken once in twice the working precision. Of the
second, plain doubles round some u |d|, which is less than u by what the two poses lie apart; so what is left
of C(a + d) is seen as sharply as by looking at that pose alone, for a fraction of the work.

X close to C_u(a)^-1 serves all neighbours: with D >= |L(d)| and |R(d)| of all of them, term by term,

    z >= |I - X C_u(a)| + |X| |C_u|(D),

and each pose is proven as in `kantorovich`. A group whose poses lie so far apart that this costs their bounds
a few per cent is not sound, and has to be divided.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.double_double import doubled_residual
from pointcoord.numerics.kantorovich import ball
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# What neighbours may cost a bound: this part of the error for the inverse that they share, and for rounding
# this part of u, which any number near 1 is rounded by when it is reported.
SHARED, ROUNDED = 0.02, 0.1


@dataclass(frozen=True)
class Neighbours:
    """G groups of m poses each; lengths in the units of y, and dimensions (coordinates, G, m).

    Attributes:
        sound: groups whose bounds are as sharp as those of each pose alone, to some per cent, (G,).
        contraction: z + omega radius, (G,), of groups that are not sound too: it tells how much nearer their
            poses have to be.
        step: e, (unknowns, G, m).
        spread: uncertainty of each component of e, (unknowns, G, 1).
        tail: what is left, for every coordinate, (G, m).
        radius: exactly one assembly lies within it, (G, m).
        residual: C(y) about what the known coordinates mean, (rows, G, m).
        condition: condition number of the Jacobian of each group's anchor, (G,).
        inverse: X, of each group's anchor, (G, unknowns, rows).
        defect: at least |I - X C_u| at each pose of the group, element by element, (G, unknowns, unknowns).
    """

    sound: NDArray[np.bool_]
    contraction: Array
    step: Array
    spread: Array
    tail: Array
    radius: Array
    residual: Array
    condition: Array
    inverse: Array
    defect: Array


@dataclass(frozen=True)
class Terms:
    """The terms of a map, as they change where only some of its coordinates do.

    Attributes:
        moving: places of these coordinates in y.
        sums: coefficients of the terms that change, by row, (rows, terms that change).
        lengths: terms of each row, (rows,).
        differences: the differences that change, as two rows of an array of changes, (moving + 1, ...), whose
            last row is zero.
        changing: of each term that changes, its number and those of its two differences; -1 of one that
            stands.
    """

    system: QuadraticMap
    moving: Indices
    sums: Array
    lengths: Indices
    differences: tuple[tuple[int, int], ...]
    changing: tuple[tuple[int, int, int], ...]

    @cached_property
    def squares(self) -> NDArray[np.bool_]:
        """The terms whose two differences are one, (terms,)."""
        (a, b), (c, d) = self.system.terms[2]
        return np.asarray((a == c) & (b == d))

    @classmethod
    def of(cls, system: QuadraticMap, moving: Indices) -> Terms:
        """Those of a map of which the coordinates at some places move."""
        coefficients, starts, ((a, b), (c, d)) = system.terms
        lengths = np.diff(starts, append=len(coefficients))
        zero = len(moving)
        row = np.full(system.size, zero, dtype=np.intp)
        row[moving] = np.arange(zero)
        numbers: dict[tuple[int, int], int] = {(zero, zero): -1}
        changing = []
        for term, ends in enumerate(zip(*(row[each].tolist() for each in (a, b, c, d)), strict=True)):
            left, right = (numbers.setdefault(pair, len(numbers) - 1) for pair in (ends[:2], ends[2:]))
            if max(left, right) >= 0:
                changing.append((term, left, right))
        terms = [term for term, _, _ in changing]
        sums = np.zeros((len(starts), len(terms)))
        sums[np.repeat(np.arange(len(starts)), lengths)[terms], np.arange(len(terms))] = coefficients[terms]
        return cls(system, moving, sums, lengths, tuple(numbers)[1:], tuple(changing))

    def certify(self, anchors: Array, low: Array, data: Array, change: Array, lost: Array) -> Neighbours:
        """Prove groups of poses.

        Args:
            anchors: coordinates y of a pose of each group, (G, size).
            low: what the known ones of these lack, (G, size).
            data: uncertainty of each coordinate anywhere in the group with that added, (G, size).
            change: from the anchor, with what its known coordinates lack added, to each pose with what its
                own lack, (moving + 1, G, m); the last row is zero.
            lost: rounding of the change, (G, moving + 1).
        """
        system, n = self.system, self.system.unknowns
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            matrix = system.jacobian(anchors)
            factors = factorise(matrix)
            inverse = factors.preconditioner
            magnitude = np.abs(inverse)
            own = system.factors(anchors)
            changes = np.empty((len(self.differences), *change.shape[1:]))
            for made, (first, second) in zip(changes, self.differences, strict=True):
                np.subtract(change[first], change[second], out=made)
            reach = self.of_terms(np.maximum(changes.max(axis=-1), -changes.min(axis=-1)).T)
            rows = (self.sums @ self._products(own, changes)).reshape(n, *change.shape[1:])
            start, doubt = doubled_residual(system, anchors, low, data)
            rows += start.T[..., None]
            largest = np.abs(rows).max(axis=-1).T
            rounded = self._rounded(own, low, reach, lost) + 3.0 * UNIT_ROUNDOFF * largest
            doubt = doubt + self._doubted(data, reach) + rounded + (n + 2) * EPS * largest
            spread = np.swapaxes(magnitude @ doubt[..., None], 0, 1)
            step = np.empty_like(rows)
            np.matmul(inverse, rows.swapaxes(0, 1), out=step.swapaxes(0, 1))
            eta = (np.abs(step) + spread).max(axis=0)
            doubted = (n + 2) * EPS * np.abs(matrix) + system.jacobian_uncertainty(data + np.abs(low))
            doubted += system.jacobian_change(*(part * (1.0 + 4.0 * UNIT_ROUNDOFF) for part in reach))
            doubted += system.jacobian_uncertainty(self._everywhere(lost))
            defect = np.abs(np.eye(n) - inverse @ matrix) + magnitude @ doubted
            z = defect.sum(axis=-1).max(axis=-1, keepdims=True)
            found = ball(eta, z, self._lipschitz(magnitude)[..., None])
            seen = (magnitude @ rounded[..., None]).max(axis=(-2, -1))
            contraction = found.contraction.max(axis=-1)
            sound = (contraction <= SHARED) & found.proven.all(axis=-1)
            sound &= seen <= ROUNDED * UNIT_ROUNDOFF
        return Neighbours(
            sound=sound,
            contraction=np.maximum(contraction, z[:, 0]),
            step=step,
            spread=spread,
            tail=found.tail,
            radius=found.radius,
            residual=rows,
            condition=factors.condition,
            inverse=inverse,
            defect=defect,
        )

    def _products(self, own: tuple[Array, Array], changes: Array) -> Array:
        """What each term that changes does by, without its coefficient, (terms that change, G m)."""
        left_own, right_own = (part.T[..., None] for part in own)
        products = np.empty((len(self.changing), *changes.shape[1:]))
        other = np.empty_like(changes[0])
        for product, (term, left, right) in zip(products, self.changing, strict=True):
            if right < 0:
                np.multiply(changes[left], right_own[term], out=product)
                continue
            if left < 0:
                np.multiply(changes[right], left_own[term], out=product)
                continue
            np.add(changes[left], left_own[term], out=other)
            if left == right:
                other += right_own[term]
                np.multiply(other, changes[left], out=product)
                continue
            other *= changes[right]
            np.multiply(changes[left], right_own[term], out=product)
            product += other
        return products.reshape(len(products), -1)

    def of_terms(self, differences: Array) -> tuple[Array, Array]:
        """Numbers of the differences that change, (G, differences), as those of all terms, (G, terms)."""
        left, right = (np.zeros((len(differences), int(self.lengths.sum()))) for _ in range(2))
        for term, first, second in self.changing:
            if first >= 0:
                left[:, term] = differences[:, first]
            if second >= 0:
                right[:, term] = differences[:, second]
        return left, right

    def _rounded(
        self, own: tuple[Array, Array], low: Array, reach: tuple[Array, Array], lost: Array
    ) -> Array:
        """How far the computed C(a + d) - C(a) may be from the exact one, (G, rows).

        The factors of the anchor are off by a rounding and by what its known coordinates lack, those of the
        change by a rounding and by what the change is off. Two products and two sums are rounded by u of
        their magnitudes each, and a row of k terms by k u of the sum of its terms'.
        """
        coefficients, starts, ends = self.system.terms
        missing = np.abs(low)
        sizes = [np.abs(part) for part in own]
        off = [
            UNIT_ROUNDOFF * size + missing.take(a, axis=-1) + missing.take(b, axis=-1)
            for size, (a, b) in zip(sizes, ends, strict=True)
        ]
        ends_lost = [lost[:, first] + lost[:, second] for first, second in self.differences]
        wrong = [
            UNIT_ROUNDOFF * part + more
            for part, more in zip(reach, self.of_terms(np.stack(ends_lost, axis=-1)), strict=True)
        ]
        (left, right), (left_off, right_off) = reach, off
        left_wrong, right_wrong = wrong
        spread = (left_off + left_wrong) * (right + right_wrong) + (sizes[0] + left) * right_wrong
        spread += left_wrong * (sizes[1] + right_off) + left * right_off
        terms = (sizes[0] + left) * right + left * sizes[1]
        spread += (np.repeat(self.lengths, self.lengths) + 5) * UNIT_ROUNDOFF * terms
        return np.asarray(np.add.reduceat(1.01 * spread * np.abs(coefficients), starts, axis=-1))

    def _doubted(self, data: Array, reach: tuple[Array, Array]) -> Array:
        """What the uncertainty of C(a) grows by where the factors differ from the anchor's, (G, rows)."""
        coefficients, starts, ends = self.system.terms
        left, right = (data.take(a, axis=-1) + data.take(b, axis=-1) for a, b in ends)
        more = 1.01 * np.abs(coefficients) * (reach[0] * right + left * reach[1])
        return np.asarray(np.add.reduceat(more, starts, axis=-1))

    def _everywhere(self, lost: Array) -> Array:
        """A number of each moving coordinate as one of each coordinate, (G, size)."""
        whole = np.zeros((len(lost), self.system.size))
        whole[:, self.moving] = lost[:, :-1]
        return whole

    def _lipschitz(self, magnitude: Array) -> Array:
        """A Lipschitz constant of X C_u, (G,): a term c of a row adds at most 8 |c| to it, in 8 places."""
        coefficients, starts, _ = self.system.terms
        rows = np.add.reduceat(8.0 * np.abs(coefficients), starts)
        return np.asarray((magnitude @ rows).max(axis=-1))
