"""Bounds of every number of many instants: neighbours are proven together, as long as that costs little."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.certified_poses import TOGETHER, CertifiedPoses, Certifier
from pointcoord.bounds.enclosed_points import EnclosedPoses, enclosed_points
from pointcoord.bounds.neighbouring_rates import (
    NOTHING,
    GroupState,
    neighbouring_poses,
    neighbouring_rates,
)
from pointcoord.bounds.reported_bounds import (
    Numbers,
    Reported,
    bounds_of_numbers,
    driven_coordinates,
    unit_of_time,
)
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosed_groups import EnclosedGroups
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.neighbours import SHARED, Neighbours
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
# Instants below which what is done for groups takes longer than what each takes by itself.
FEW = 400
Laws = Mapping[str, Sequence[Enclosed]]


@dataclass(frozen=True)
class Instants:
    """Some consecutive instants of a motion, with all that is to be proven of them.

    Attributes:
        times: (N,), s; they do not decrease.
        states: computed coordinates y and their time derivatives, (size, N), units per s^d.
        laws: by input, where its value, rate and acceleration exactly are, each (N,).
    """

    times: Array
    states: Sequence[Array]
    laws: Laws
    reported: Reported

    @classmethod
    def of(cls, times: Array, reported: Reported) -> Instants:
        """With the coordinates as they were solved for."""
        states = [np.ascontiguousarray(state.T) for state in reported.solved.coordinates(times, 2)]
        return cls(times, states, reported.enclosed_laws(times), reported)


@dataclass(frozen=True)
class ProvenGroups:
    """Groups of m instants whose numbers are bounded.

    Attributes:
        members: numbers of the instants, (G, m).
        poses: what is proven of the poses, and which groups are sound, (G,).
        proven, expected: bounds of every number, (G, m, ...).
    """

    members: Indices
    poses: Neighbours
    sound: NDArray[np.bool_]
    proven: Numbers
    expected: Numbers


@dataclasses.dataclass
class GroupProver:
    """Proves groups of a mechanism's poses, and remembers how far apart the members of one may lie.

    Attributes:
        stiffness, dearness: z of a group and what it costs its rates, in parts of what it may, over how far
            its poses lie from their anchor, as far as they are known.
    """

    mechanism: Mechanism
    certifier: Certifier
    stiffness: float = 1.0
    dearness: float = 1.0

    def prove(self, asked: Instants, certified: CertifiedPoses) -> tuple[list[ProvenGroups], Indices]:
        """Prove what can be proven together; also the numbers of the instants that are left."""
        found: list[ProvenGroups] = []
        left = np.arange(len(asked.times))
        # Poses of a car that turns do not lie on straight lines: each is proven by itself.
        if len(left) < FEW or asked.reported.chassis.turns:
            return found, left
        anchors, conditions = [asked.times[:0]], [asked.times[:0]]
        for size in TOGETHER:
            if len(left) < size:
                continue
            count = len(left) // size * size
            groups = left[:count].reshape(-1, size)
            near = self._near(asked, groups)
            part = self._together(asked, groups[near]) if near.any() else None
            if part is not None:
                found.append(part)
                certified.put(part.members[part.sound], part.poses, part.sound)
                anchors.append(asked.times[part.members[part.sound, size // 2]])
                conditions.append(part.poses.condition[part.sound])
                left = np.setdiff1d(left, part.members[part.sound], assume_unique=True)
        at, values = np.concatenate(anchors), np.concatenate(conditions)
        if at.size:
            order = np.argsort(at, kind="stable")
            certified.condition[:] = np.interp(asked.times, at[order], values[order])
        return found, left

    def _near(self, asked: Instants, groups: Indices) -> NDArray[np.bool_]:
        """Groups that are worth a try, (G,): a pose alone takes as long as some groups do."""
        worst = max(self.stiffness / (1.5 * SHARED), self.dearness / 1.5)
        with np.errstate(invalid="ignore", over="ignore"):
            return np.asarray(worst * self._farthest(asked, groups) <= 1.0)

    def _farthest(self, asked: Instants, groups: Indices) -> Array:
        """How far a pose of each group lies from its first or its last, about, (G,)."""
        y = asked.states[0][self.certifier.terms.moving]
        first, last, middle = (y[:, groups[:, place]] for place in (0, -1, groups.shape[1] // 2))
        return np.asarray(np.maximum(np.abs(first - middle), np.abs(last - middle)).max(axis=0))

    def _together(self, asked: Instants, groups: Indices) -> ProvenGroups | None:
        """What is proven of those of some groups whose poses can be; None if of none."""
        mechanism, terms, reported = self.mechanism, self.certifier.terms, asked.reported
        with np.errstate(all="ignore"):  # what overflows comes out infinite, which proves nothing
            some = _Grouped.of(mechanism, asked, groups)
            certified = neighbouring_poses(mechanism, terms, some.states[0], some.driven[0])
            self.stiffness = _learnt(self.stiffness, certified.contraction, self._farthest(asked, groups))
            if not certified.sound.any():
                return None
            if not certified.sound.all():
                groups = groups[certified.sound]
                some = _Grouped.of(mechanism, asked, groups)
                certified = neighbouring_poses(mechanism, terms, some.states[0], some.driven[0])
            unsolved = reported.solved.unsolved(asked.times[some.here]).reshape(groups.shape).max(axis=-1)
            found = neighbouring_rates(mechanism, terms, certified, some.states, some.driven, unsolved)
            self.dearness = _learnt(self.dearness, found.cost, self._farthest(asked, groups))
            self._leave_out(asked, groups, some.states, some.powers, certified.condition, found.states)
            coordinates = [state.numbers(terms) for state in found.states]
            poses = EnclosedPoses(
                mechanism,
                reported.axes,
                enclosed_points(mechanism, coordinates),
                reported.chassis.enclosed(some.laws, mechanism.origin),
                [power[:, None] for power in some.powers],
            )
            numbers = some.numbers(reported)
            proven, expected = bounds_of_numbers(poses, reported.effects, numbers)
            sound = certified.sound & (found.cost <= 1.0) & _credible(numbers, proven, expected)
        return ProvenGroups(groups, certified, sound, proven, expected)

    def _leave_out(
        self,
        asked: Instants,
        groups: Indices,
        states: Sequence[Array],
        powers: Sequence[Array],
        condition: Array,
        exact: Sequence[GroupState],
    ) -> None:
        """Add to what is expected of each group what summing a series leaves out there.

        Terms grow with the distance from where their series starts, so that they are largest at an end, of
        the group or of a series.
        """
        solved, unknowns, count = asked.reported.solved, self.mechanism.map.unknowns, groups.shape[1]
        pieces = solved.pieces(asked.times[groups.ravel()]).reshape(groups.shape)
        chosen = np.zeros(groups.shape, dtype=bool)
        chosen[:, [0, -1]] = True
        over = pieces[:, 1:] != pieces[:, :-1]
        chosen[:, 1:] |= over
        chosen[:, :-1] |= over
        places = np.flatnonzero(chosen)
        of, starts = places // count, np.searchsorted(places, count * np.arange(len(groups)))
        for d, summed in enumerate(solved.summed(asked.times[groups.ravel()[places]])[: len(exact)]):
            values = states[d].reshape(len(states[d]), -1)[:, places].T
            made = summed.expected(values, condition[of], powers[d][of])
            exact[d].anchor.radius[1, :, :unknowns] += np.maximum.reduceat(made[:, :unknowns], starts)


@dataclass(frozen=True)
class _Grouped:
    """What is known of groups of instants before anything is proven of them.

    Attributes:
        here: the instants.
        shape: of the groups, (G, m).
        powers: of the unit of time of each group, s^d, each (G,).
        states: coordinates and their derivatives in that, (size, G, m).
        laws: by input its value and its derivatives, (G, m).
        driven: by time derivative and place, each driven coordinate in that unit, (G, m).
    """

    here: slice | Indices
    shape: tuple[int, int]
    powers: Sequence[Array]
    states: Sequence[Array]
    laws: Mapping[str, Sequence[EnclosedGroups]]
    driven: Sequence[Mapping[int, EnclosedGroups]]

    @classmethod
    def of(cls, mechanism: Mechanism, asked: Instants, groups: Indices) -> _Grouped:
        """Those of some groups of the instants."""
        here, shape = _run(groups), (groups.shape[0], groups.shape[1])
        states = [state[:, here].reshape(-1, *shape) for state in asked.states]
        time = unit_of_time([state.swapaxes(0, 1) for state in states])
        powers = [time**d for d in range(3)]
        laws = {
            name: [EnclosedGroups.of_instants(_part(law, here), shape) for law in parts]
            for name, parts in asked.laws.items()
        }
        coordinates = driven_coordinates(mechanism, laws)
        driven = [
            {
                place: EnclosedGroups.of_one(parts[d], shape).scaled(power[:, None])
                for place, parts in coordinates.items()
            }
            for d, power in enumerate(powers)
        ]
        scaled = [states[0], *(s * p[:, None] for s, p in zip(states[1:], powers[1:], strict=False))]
        return cls(here, shape, powers, scaled, laws, driven)

    def numbers(self, reported: Reported) -> dict[str, dict[str, Array]]:
        """What is reported of them, (G, m, ...)."""
        return {
            quantity: {name: _side_by_side(array[self.here], self.shape) for name, array in part.items()}
            for quantity, part in reported.numbers.items()
        }


def _credible(numbers: Numbers, proven: Numbers, expected: Numbers) -> NDArray[np.bool_]:
    """Groups of which every number is one, and is off by no more than is expected, (G,).

    A single number that is wrong, or none at all, spoils the bounds of its neighbours; each is then proven by
    itself. What is left of a number that is exact is some u^2 of the others.
    """
    sound: NDArray[np.bool_] = np.array(True)
    for quantity, part in proven.items():
        for name, bound in part.items():
            most, least = bound.max(axis=1), expected[quantity][name].min(axis=1)
            spare = UNIT_ROUNDOFF * least.max(axis=-1, keepdims=True) if least.ndim > 1 else 0.0
            fine = (most <= least + spare + NOTHING) & np.isfinite(numbers[quantity][name].sum(axis=1))
            sound = sound & (fine.all(axis=-1) if fine.ndim > 1 else fine)
    return sound


def _learnt(known: float, values: Array, farthest: Array) -> float:
    """The least of values over how far the poses of groups lie from their anchor, as far as there is one."""
    ratio = values / farthest
    finite = ratio[np.isfinite(ratio)]
    return float(finite.min()) if finite.size else known


def _run(groups: Indices) -> slice | Indices:
    """The instants of groups, as a slice where they follow one another."""
    members = groups.ravel()
    first, last = int(members[0]), int(members[-1])
    return slice(first, last + 1) if last - first + 1 == len(members) else members


def _part(law: Enclosed, here: slice | Indices) -> Enclosed:
    return Enclosed(law.high[here], law.low[here], law.radius[:, here])


def _side_by_side(numbers: Array, shape: tuple[int, int]) -> Array:
    """Numbers (G m, ...) as (G, m, ...), with those of a group side by side in memory."""
    if numbers.ndim == 1:
        return numbers.reshape(shape)
    return np.moveaxis(np.ascontiguousarray(numbers.T).reshape(-1, *shape), 0, -1)
