"""Certifies the poses of a motion, in groups of neighbours that share an inverse.

A group is as large as its poses lie close enough together for: the inverse of the middle one then costs the
others a few per cent of their bounds (see `kantorovich`). A pose without close neighbours is a group of one.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed, anchored, both
from pointcoord.numerics.kantorovich import Certificate, certify, defect_of
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import components_last

Array = NDArray[np.float64]

# Poses of a group at most, and what sharing an inverse may cost their bounds: this part of the error.
LARGEST, SHARED = 256, 0.02
# Groups below which a larger size saves no time: what is done for each array takes longer than its numbers.
FEWEST = 16


@dataclass(frozen=True)
class Groups:
    """N instants as G groups of m consecutive ones; the last instant is repeated to fill the last group."""

    count: int
    size: int

    def together(self, array: Array) -> Array:
        """Numbers of the instants, (N, ...), by group, (G, m, ...)."""
        number = -(-self.count // self.size)
        if number * self.size == self.count:
            return array.reshape(number, self.size, *array.shape[1:])
        places = np.minimum(np.arange(number * self.size), self.count - 1).reshape(number, self.size)
        return np.moveaxis(np.moveaxis(array, 0, -1)[..., places], (-2, -1), (0, 1))

    def apart(self, array: Array) -> Array:
        """Numbers by group, (G, m, ...), as those of the instants, (N, ...)."""
        return array.reshape(-1, *array.shape[2:])[: self.count]


@dataclass(frozen=True)
class CertifiedPoses:
    """Poses by group, with their certificate; lengths in the mechanism's units.

    Attributes:
        pose: coordinates, the known ones where they exactly are, (G, m, size).
        factors: of the anchor of each group.
    """

    groups: Groups
    pose: Enclosed
    factors: Factors
    certificate: Certificate

    @classmethod
    def of(
        cls, mechanism: Mechanism, groups: Groups, factors: Factors, y: Array, driven: Mapping[int, Enclosed]
    ) -> CertifiedPoses:
        """Certify poses.

        Args:
            groups, factors: as `grouped` gives them.
            y: coordinates, (G, m, size).
            driven: where the driven coordinates exactly are, by place in y, (G, m).
        """
        system = mechanism.map
        pose = with_known(y, system.unknowns, driven, mechanism.drawn_lacks, mechanism.drawn_doubt)
        return cls(groups, pose, factors, certify(system, pose, factors))


def grouped(system: QuadraticMap, y: Array, driven: Collection[int]) -> tuple[Groups, Factors]:
    """As few groups as can share an inverse, all of one size, with the factors of their middle poses.

    Args:
        y: coordinates of consecutive instants, (N, size).
        driven: places of those that are known and move.
    """
    size = _power_of_two(min(LARGEST, len(y) / FEWEST))
    while True:
        groups = Groups(len(y), size)
        together = groups.together(y)
        factors = factorise(system.jacobian(together[:, size // 2]))
        if size == 1:
            break
        moving = {place: anchored(together[..., place], (len(together), 1)) for place in driven}
        pose = with_known(together, system.unknowns, moving)
        with np.errstate(all="ignore"):
            z = defect_of(system, pose, factors.preconditioner).sum(axis=-1).max(initial=0.0)
            if z <= SHARED:
                break
            size = _power_of_two(size * SHARED / z)  # z falls about as the size does
    return groups, factors


def _power_of_two(most: float) -> int:
    """The largest power of two that is no larger, but at least 1; 1 of what is no number."""
    return int(2 ** int(np.log2(max(1.0, most))))


def with_known(
    state: Array,
    unknowns: int,
    driven: Mapping[int, Enclosed],
    lacks: ArrayLike = 0.0,
    doubt: ArrayLike = 0.0,
) -> Enclosed:
    """Computed coordinates, or their rates, the unknown ones as they are and the known ones where they are.

    Args:
        state: (G, m, size).
        driven: by place, (G, m).
        lacks, doubt: of the others that are known, which stand still.
    """
    middle = state.shape[1] // 2
    high = state[:, middle : middle + 1].copy(order="K")
    low, reach = np.zeros_like(high), np.zeros_like(high)
    low[..., unknowns:] = np.broadcast_to(lacks, high.shape)[..., unknowns:]
    radius = both(np.broadcast_to(doubt, high.shape), doubt + np.abs(lacks))
    change = components_last(np.zeros((state.shape[-1], *state.shape[:-1])))
    result = Enclosed(high, low, radius, change, reach)
    own = anchored(state[..., :unknowns], (*high.shape[:-1], unknowns))
    moving: list[tuple[int | slice, Enclosed]] = [(slice(unknowns), own), *driven.items()]
    for place, number in moving:
        for whole, part in zip(result.parts, number.parts, strict=True):
            whole[..., place] = part
    return result


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of the solved points of poses, shape (...,), mm.

    The shift to the user's origin rounds each coordinate once more.
    """
    pose = Enclosed.of(*(part[..., None, :] for part in (y, *mechanism.known_data(y))))
    certificate = certify(mechanism.map, pose, factors)
    points = certificate.coordinates[..., 0, : 3 * len(mechanism.topology.moving)].max(axis=-1)
    return np.asarray(points * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))
