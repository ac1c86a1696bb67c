"""Certificates of many poses of a motion: neighbours share the inverse of one, the others have their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.kantorovich import Certificate, certify
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.neighbours import SHARED, Neighbours, Terms
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Poses that share an inverse, by turns: as many as lie near enough for it.
TOGETHER = (1024, 256, 64, 16, 4)
# Poses with an inverse of their own at a time: their matrices (four of n x n and two of n x pairs each) stay
# below 40 MB.
ALONE = 1024


@dataclass
class CertifiedPoses:
    """What is proven of N poses, in the mechanism's units; a row of instants for each number.

    Attributes:
        step: e, (unknowns, N).
        spread: uncertainty of each component of e, (unknowns, N).
        tail: what is left, for every coordinate, (N,); infinite where nothing could be proven.
        radius: exactly one assembly lies within it, (N,); likewise.
        residual: largest row of C(y) about what the known coordinates mean, (N,).
        condition: condition number of the Jacobian, (N,).
    """

    step: Array
    spread: Array
    tail: Array
    radius: Array
    residual: Array
    condition: Array

    @classmethod
    def empty(cls, unknowns: int, count: int) -> CertifiedPoses:
        """Room for those of some poses."""
        step, spread = np.empty((2, unknowns, count))
        return cls(step, spread, *np.empty((4, count)))

    def put(self, members: Indices, found: Neighbours, sound: NDArray[np.bool_]) -> None:
        """Write those of some groups.

        Args:
            members: numbers of their poses, (groups that are sound, m).
        """
        self.step[:, members] = found.step[:, sound]
        self.spread[:, members] = found.spread[:, sound]
        self.tail[members] = found.tail[sound]
        self.radius[members] = found.radius[sound]
        self.residual[members] = np.abs(found.residual[:, sound]).max(axis=0)

    def put_alone(self, members: Indices, found: Certificate, factors: Factors) -> None:
        """Write those of poses that have their own certificate, members (k,)."""
        self.step[:, members], self.spread[:, members] = found.step.T, found.spread.T
        self.tail[members], self.radius[members] = found.tail, found.radius
        self.residual[members] = np.abs(found.residual).max(axis=-1)
        self.condition[members] = factors.condition


@dataclass
class Certifier:
    """Certifies poses of a mechanism, and remembers how far apart neighbours may lie.

    Attributes:
        stiffness: z of a group over how far its poses lie from its anchor, as far as it is known.
    """

    mechanism: Mechanism
    stiffness: float = 1.0

    @cached_property
    def terms(self) -> Terms:
        """What moves: the unknown coordinates and those that are driven."""
        return Terms.of(self.mechanism.map, np.array([*range(self.mechanism.map.unknowns), *self.driven]))

    @cached_property
    def driven(self) -> list[int]:
        """Places of the driven coordinates."""
        return [self.mechanism.layout.scalar(drive.coordinate) for drive in self.mechanism.topology.drives]

    def certify(self, times: Array, y: Array, laws: Mapping[str, Array]) -> CertifiedPoses:
        """Prove poses.

        Args:
            times: (N,), s; they do not decrease.
            y: coordinates, (size, N).
            laws: how far the value of each driving input may be off, (N,), rad or mm.
        """
        mechanism = self.mechanism
        data = np.empty((2, len(self.driven), len(times)))
        for i, drive in enumerate(mechanism.topology.drives):
            data[:, i] = drive.rounding(y[self.driven[i]], mechanism.drawing, laws[drive.input])
        found = CertifiedPoses.empty(mechanism.map.unknowns, len(times))
        left = np.arange(len(times))
        anchors, conditions = [times[:0]], [times[:0]]
        for size in TOGETHER:
            if len(left) < size:
                continue
            count = len(left) // size * size
            groups, rest = left[:count].reshape(-1, size), left[count:]
            middle = groups[:, size // 2]
            sound, certified = self._together(y, data, groups)
            if certified is not None:
                good = sound.copy()
                good[sound] = certified.sound
                found.put(groups[good], certified, certified.sound)
                anchors.append(times[middle[good]])
                conditions.append(certified.condition[certified.sound])
                sound = good
            left = np.concatenate([groups[~sound].ravel(), rest])
        at, values = np.concatenate(anchors), np.concatenate(conditions)
        if at.size:
            order = np.argsort(at, kind="stable")
            found.condition[:] = np.interp(times, at[order], values[order])
        for low in range(0, len(left), ALONE):
            part = left[low : low + ALONE]
            found.put_alone(part, *self._alone(y, data, part))
        return found

    def _together(
        self, y: Array, data: Array, groups: Indices
    ) -> tuple[NDArray[np.bool_], Neighbours | None]:
        """Groups that were tried, (G,), and what was found of them; None if none was worth trying.

        Args:
            data: what the driven coordinates lack and their uncertainty, (2, driven, N).
        """
        terms, middle = self.terms, groups.shape[1] // 2
        moving = y[terms.moving][:, groups]
        change = np.zeros((len(moving) + 1, *groups.shape))
        with np.errstate(invalid="ignore", over="ignore"):
            np.subtract(moving, moving[..., middle, None], out=change[:-1])
            reach = np.maximum(change.max(axis=-1), -change.min(axis=-1))
            farthest = reach.max(axis=0)
            near = self.stiffness * farthest <= 2.0 * SHARED
        if not near.any():
            return near, None
        if not near.all():
            groups, change, reach, farthest = groups[near], change[:, near], reach[:, near], farthest[near]
        anchors = np.ascontiguousarray(y[:, groups[:, middle]].T)
        # A difference of two numbers of which neither is twice the other is exact (Sterbenz).
        exact = 2.0 * reach[:-1] <= np.abs(anchors[:, terms.moving].T)
        lost = np.zeros_like(reach)
        lost[:-1] = np.where(exact, 0.0, UNIT_ROUNDOFF * reach[:-1])
        lacking, doubt = data[0][:, groups], data[1][:, groups].max(axis=-1)
        low, uncertainty = self._known(anchors, lacking[..., middle], doubt)
        more, driven = lacking - lacking[..., middle, None], slice(self.mechanism.map.unknowns, -1)
        change[driven] += more
        lost[driven] += UNIT_ROUNDOFF * (reach[driven] + 3.0 * np.abs(more).max(axis=-1))
        found = terms.certify(anchors, low, uncertainty, change, lost.T)
        with np.errstate(divide="ignore", invalid="ignore"):
            stiffness = found.contraction / farthest
        known = np.isfinite(stiffness)
        if known.any():
            self.stiffness = float(stiffness[known].min())
        return near, found

    def _alone(self, y: Array, data: Array, members: Indices) -> tuple[Certificate, Factors]:
        """Of each of some poses by its own inverse."""
        own = np.ascontiguousarray(y[:, members].T)
        low, uncertainty = self._known(own, *data[:, :, members])
        factors = factorise(self.mechanism.map.jacobian(own))
        return certify(self.mechanism.map, own, factors, uncertainty, low), factors

    def _known(self, y: Array, lacking: Array, uncertainty: Array) -> tuple[Array, Array]:
        """What all coordinates lack and are uncertain by, (k, size), from the driven ones' (driven, k)."""
        low, data = (
            np.broadcast_to(drawn, y.shape).copy()
            for drawn in (self.mechanism.drawn_lacks, self.mechanism.drawn_doubt)
        )
        low[:, self.driven], data[:, self.driven] = lacking.T, uncertainty.T
        return low, data
