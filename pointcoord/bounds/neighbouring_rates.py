r"""Where the coordinates of neighbouring poses and their rates exactly are, by the inverse of one of them.

What `enclosed_rates` does for each pose, for groups of them at once (see `neighbours` for the poses, and
`enclosed_groups` for numbers). The rest of the rate equations is 2 B(y*, v) of the anchor in twice the
working precision, and of each pose what it differs from that,

    sum_t c_t [ dL_t(y) (R_t(v) + dR_t(v)) + L_t(y) dR_t(v) + dL_t(v) (R_t(y) + dR_t(y)) + L_t(v) dR_t(y) ],

in plain doubles, which is rounded in proportion to how far the poses lie apart. F of `enclosed_rates` is one
for all poses of a group, with |X| times what the Jacobian changes by in it. A group that costs the rates of
its poses more than a small part of what is expected of them has to be divided.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_rates import row_sums
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosed_groups import EnclosedGroups
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.neighbours import Neighbours, Terms
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]

# What neighbours may cost a rate beside what they may cost a pose: for rounding this part of what is expected
# of it. An error that is seen exactly is mostly less than a tenth of that.
ROUNDED_RATES = 0.03
NOTHING = 1e-290  # a radius that is made of what underflows


@dataclass(frozen=True)
class GroupState:
    """The exact coordinates of G groups of m poses, or a derivative of them; only some move.

    Attributes:
        anchor: of one pose of each group, with radii for all of them, (G, size).
        change: of those that move, from the anchor, (moving + 1, G, m); the last row is zero.
        reach: at least |change|, (G, moving + 1).
    """

    anchor: Enclosed
    change: Array
    reach: Array

    def moved(self, by: Array, radii: tuple[Array, Array], lost: Array) -> GroupState:
        """With the unknown coordinates moved, (unknowns, G, m), and with radii of these, (G, unknowns) each.

        Args:
            lost: rounding of the changes so far, (G, moving + 1).
        """
        n, middle = len(by), self.change.shape[-1] // 2
        low, radius = self.anchor.low.copy(), self.anchor.radius.copy()
        low[:, :n] += by[:, :, middle].T
        change, reach = self.change.copy(), self.reach.copy()
        change[:n] += by - by[:, :, middle, None]
        reach[:, :n] += 2.0 * np.abs(by).max(axis=-1).T
        proven, expected = radii
        radius[0, :, :n] = proven + lost[:, :n] + 3.0 * UNIT_ROUNDOFF * reach[:, :n]
        radius[1, :, :n] = expected
        return GroupState(Enclosed.of(self.anchor.high, low, *radius), change, reach)

    def numbers(self, terms: Terms) -> NumbersOfGroups:
        """The coordinates as numbers of groups."""
        row = np.full(terms.system.size, -1, dtype=np.intp)
        row[terms.moving] = np.arange(len(terms.moving))
        return NumbersOfGroups(self, row)


@dataclass(frozen=True)
class NumbersOfGroups:
    """Coordinates of groups of poses, of which vectors can be taken.

    Attributes:
        row: of each coordinate that moves among those, (size,); -1 of one that stands.
    """

    state: GroupState
    row: NDArray[np.intp]

    def take(self, places: list[int]) -> Enclosed:
        """Some coordinates, (G, m, places); of those that all stand those of the anchors, (G, 1, places)."""
        own = self.state.anchor.take(places)
        high, low, radius = own.high[:, None], own.low[:, None], own.radius[:, :, None]
        rows = self.row[places]
        if (rows < 0).all():
            return Enclosed(high, low, radius)
        first = int(rows[0])
        follow = first >= 0 and (rows == np.arange(first, first + len(rows))).all()
        change = self.state.change[first : first + len(rows)] if follow else self.state.change[rows]
        return EnclosedGroups(
            high, low, radius, change.transpose(1, 2, 0), self.state.reach[:, rows][:, None]
        )


@dataclass(frozen=True)
class _Factors:
    """The two differences of every term, of a state.

    Attributes:
        anchors: of each group's anchor, with radii for all poses, two of (G, terms).
        reaches: at least what they change by, two of (G, terms).
        changes: of the differences that change, (differences, G, m).
    """

    anchors: tuple[Enclosed, Enclosed]
    reaches: tuple[Array, Array]
    changes: Array

    @classmethod
    def of(cls, terms: Terms, state: GroupState) -> _Factors:
        """Each difference is rounded by u of itself."""
        changes = np.empty((len(terms.differences), *state.change.shape[1:]))
        for made, (first, second) in zip(changes, terms.differences, strict=True):
            np.subtract(state.change[first], state.change[second], out=made)
        reaches = terms.of_terms(np.maximum(changes.max(axis=-1), -changes.min(axis=-1)).T)
        anchors = []
        for reach, (plus, minus) in zip(reaches, terms.system.terms[2], strict=True):
            own = state.anchor.take(plus) - state.anchor.take(minus)
            anchors.append(Enclosed(own.high, own.low, own.radius + 1.01 * UNIT_ROUNDOFF * reach))
        return cls((anchors[0], anchors[1]), reaches, changes)


def _twice_polar(terms: Terms, a: _Factors, b: _Factors) -> tuple[Enclosed, Array]:
    """2 B(a, b): of the anchors with radii for all poses, (G, rows), and the change, (rows, G, m).

    A term's change is two products of two factors. Each of the parts dL (R + dR) and L dR is rounded by
    three operations and what low parts add, their sums and the coefficient by four more, and a row of k
    terms by k u of the sum of theirs.
    """
    coefficients, starts, _ = terms.system.terms
    rounded = (np.repeat(terms.lengths, terms.lengths) + 9.0) * UNIT_ROUNDOFF
    products = []
    for left, right in ((0, 1), (1, 0)):
        part = a.anchors[left] * b.anchors[right]
        dl, dr = a.reaches[left], b.reaches[right]
        mine, its = np.abs(a.anchors[left].high), np.abs(b.anchors[right].high)
        reach = 1.01 * (dl * (its + dr) + mine * dr)
        more = dl * b.anchors[right].radius + a.anchors[left].radius * dr + rounded * reach
        products.append(Enclosed(part.high, part.low, part.radius + more))
    return row_sums((products[0] + products[1]) * Enclosed.of(coefficients), starts), _changed(terms, a, b)


def _changed(terms: Terms, a: _Factors, b: _Factors) -> Array:
    """What each row of 2 B(a, b) changes by, (rows, G, m)."""
    (al, ar), (bl, br) = ([part.high.T[..., None] for part in each.anchors] for each in (a, b))
    products = np.empty((len(terms.changing), *a.changes.shape[1:]))
    other, room = np.empty_like(products[0]), np.empty_like(products[0])
    for product, (term, left, right) in zip(products, terms.changing, strict=True):
        da_l, da_r = (None if each < 0 else a.changes[each] for each in (left, right))
        db_l, db_r = (None if each < 0 else b.changes[each] for each in (left, right))
        _change_of_product((al[term], da_l), (br[term], db_r), product, room)
        if terms.squares[term]:
            product *= 2.0
            continue
        _change_of_product((bl[term], db_l), (ar[term], da_r), other, room)
        product += other
    rows = terms.sums @ products.reshape(len(products), -1)
    return np.asarray(rows.reshape(len(rows), *a.changes.shape[1:]))


def _change_of_product(
    left: tuple[Array, Array | None], right: tuple[Array, Array | None], out: Array, room: Array
) -> None:
    """dL (R + dR) + L dR, with None for what does not change; one of the two does."""
    (own, moved), (its_own, its_moved) = left, right
    if moved is None:
        assert its_moved is not None
        np.multiply(its_moved, own, out=out)
        return
    if its_moved is None:
        np.multiply(moved, its_own, out=out)
        return
    np.add(its_moved, its_own, out=room)
    room *= moved
    np.multiply(its_moved, own, out=out)
    out += room


@dataclass(frozen=True)
class NeighbouringRates:
    """Groups of poses with their rates.

    Attributes:
        cost: what sharing costs the rates, in parts of what it may, (G,).
        states: the exact coordinates and their derivatives, in the unit of time of each group.
    """

    cost: Array
    states: Sequence[GroupState]


def neighbouring_poses(
    mechanism: Mechanism, terms: Terms, y: Array, driven: Mapping[int, EnclosedGroups]
) -> Neighbours:
    """Prove groups of poses.

    Args:
        terms: those in which the unknown and the driven coordinates move.
        y: computed coordinates, (size, G, m). driven: by place in y, where they exactly are, (G, m).
    """
    pose, lost = _computed(mechanism, terms, y, driven, 0)
    return terms.certify(pose.anchor.high, pose.anchor.low, pose.anchor.radius[0], pose.change, lost)


def neighbouring_rates(
    mechanism: Mechanism,
    terms: Terms,
    poses: Neighbours,
    states: Sequence[Array],
    driven: Sequence[Mapping[int, EnclosedGroups]],
    unsolved: Array,
) -> NeighbouringRates:
    """Prove the rates of groups of poses.

    Args:
        poses: what is proven of them.
        states: computed y and its time derivatives, (size, G, m), units per unit of time^d.
        driven: by time derivative and by place in y each driven coordinate, (G, m).
        unsolved: how far from its assembly a pose of each group was left on purpose, at most, (G,).
    """
    computed = [
        _computed(mechanism, terms, state, known, d)
        for d, (state, known) in enumerate(zip(states, driven, strict=False))
    ]
    exact, spoilt = _exact_poses(mechanism, terms, poses, *computed[0], unsolved)
    result, factors = [exact], [_Factors.of(terms, exact)]
    cost = np.zeros(len(spoilt))
    for rate, lost in computed[1:]:
        rest, change = _twice_polar(terms, factors[0], _Factors.of(terms, rate))
        if len(result) == 2:
            own, more = _twice_polar(terms, factors[1], factors[1])
            rest, change = rest + own, change + more
        corrected, part = _corrected(rate, lost, (rest, change), poses, spoilt)
        result.append(corrected)
        cost = np.maximum(cost, part)
        if len(result) < len(computed):
            factors.append(_Factors.of(terms, corrected))
    return NeighbouringRates(cost, result)


def _computed(
    mechanism: Mechanism,
    terms: Terms,
    state: Array,
    driven: Mapping[int, EnclosedGroups],
    derivative: int,
) -> tuple[GroupState, Array]:
    """A computed state with the exact known coordinates in it, and what its changes lost, (G, moving + 1).

    A difference of two numbers of which neither is twice the other is exact (Sterbenz).
    """
    size, groups, count = state.shape
    middle = count // 2
    high = np.ascontiguousarray(state[:, :, middle].T)
    low, radius = np.zeros((groups, size)), np.zeros((2, groups, size))
    if derivative == 0:
        low[:], radius[0] = mechanism.drawn_lacks, mechanism.drawn_doubt
        radius[1] = radius[0] + np.abs(low)
    change = np.zeros((len(terms.moving) + 1, groups, count))
    np.subtract(state[terms.moving], state[terms.moving, :, middle, None], out=change[:-1])
    reach = np.maximum(change.max(axis=-1), -change.min(axis=-1)).T
    lost = np.zeros_like(reach)
    exact = 2.0 * reach[:, :-1] <= np.abs(high[:, terms.moving])
    lost[:, :-1] = np.where(exact, 0.0, UNIT_ROUNDOFF * reach[:, :-1])
    if derivative:
        radius[0][:, terms.moving] = lost[:, :-1]
    rows = {int(place): row for row, place in enumerate(terms.moving)}
    for place, part in driven.items():
        row = rows[place]
        high[:, place], low[:, place] = part.high[:, 0], part.low[:, 0]
        radius[:, :, place] = part.radius[..., 0]
        change[row], reach[:, row], lost[:, row] = part.change, part.reach[:, 0], 0.0
    return GroupState(Enclosed(high, low, radius), change, reach), lost


def _exact_poses(
    mechanism: Mechanism,
    terms: Terms,
    found: Neighbours,
    pose: GroupState,
    lost: Array,
    unsolved: Array,
) -> tuple[GroupState, Array]:
    """Where poses exactly are, and F for their rates, (G, unknowns, unknowns)."""
    system, n, anchor = mechanism.map, mechanism.map.unknowns, pose.anchor
    magnitude = np.abs(found.inverse)
    largest = np.abs(found.step).max(axis=-1).T
    rounded = found.spread[..., 0].T + 32.0 * UNIT_ROUNDOFF * largest
    proven = rounded + _tail(system, found, magnitude, largest)
    looking = _applied(magnitude, system.uncertainty(anchor.high, anchor.radius[1])) + unsolved[:, None]
    exact = pose.moved(-found.step, (proven, looking), lost)
    exact.anchor.radius[1] += UNIT_ROUNDOFF * np.abs(anchor.high)
    exact.anchor.radius[1][:, terms.moving] += UNIT_ROUNDOFF * pose.reach[:, :-1]
    moved = np.abs(anchor.low) + exact.anchor.radius[0]
    moved[:, :n] += largest
    return exact, found.defect + magnitude @ system.jacobian_uncertainty(moved)


def _tail(system: QuadraticMap, found: Neighbours, magnitude: Array, largest: Array) -> Array:
    """What is left of the error of each coordinate beside e and its spread, for all poses, (G, unknowns).

    As for a pose alone, with the largest e and radius of the group.
    """
    tail = radius = np.broadcast_to(found.radius.max(axis=-1)[:, None], largest.shape)
    spread, most = found.spread[..., 0].T, found.tail.max(axis=-1)[:, None]
    for _ in range(2):
        moved = np.concatenate([radius, np.zeros((len(radius), system.size - system.unknowns))], axis=-1)
        bent = 0.5 * magnitude @ system.jacobian_uncertainty(moved)
        tail = np.minimum(_applied(found.defect + bent, radius), most)
        radius = np.minimum(radius, largest + spread + tail)
    return tail


def _corrected(
    rate: GroupState, lost: Array, rest: tuple[Enclosed, Array], poses: Neighbours, spoilt: Array
) -> tuple[GroupState, Array]:
    """The rates that leave no rest, from computed ones, and what sharing costs them, (G,).

    Args:
        rest: 2 B(y*, .) + ... of the anchors, with radii for all poses, and what it changes by.
        spoilt: F, (G, unknowns, unknowns).
    """
    anchor, change = rest
    inverse, magnitude = poses.inverse, np.abs(poses.inverse)
    gamma = (inverse.shape[-1] + 2) * EPS
    middle = change + anchor.middle.T[..., None]
    largest = np.abs(middle).max(axis=-1).T
    step = np.empty_like(middle)
    np.matmul(inverse, middle.swapaxes(0, 1), out=step.swapaxes(0, 1))
    proven = _applied(magnitude, anchor.radius[0] + (gamma + 2.0 * UNIT_ROUNDOFF) * largest)
    whole = np.abs(step).max(axis=-1).T + proven
    room = 1.0 - poses.contraction
    most = np.where(room > 0.0, whole.max(axis=-1) / room, np.inf)[:, None]
    tail = _applied(spoilt, whole + _applied(spoilt, np.broadcast_to(most, whole.shape)))
    rounded = _applied(magnitude, anchor.radius[1])
    looking = rounded + (gamma * poses.condition * rounded.max(axis=-1))[:, None]
    corrected = rate.moved(-step, (proven + tail, looking), lost)
    corrected.anchor.radius[1] += UNIT_ROUNDOFF * np.abs(rate.anchor.high)
    return corrected, proven.max(axis=-1) / (ROUNDED_RATES * looking.max(axis=-1) + NOTHING)


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])
