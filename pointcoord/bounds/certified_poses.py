"""Certifies the poses of a motion, in groups of neighbours that share an inverse.

The poses of a group are so close together that the inverse at the middle pose makes the bounds of the others
only a few per cent larger (see `kantorovich`). A pose without close neighbours is a group of one.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.enclosure import Enclosed, anchored, both
from pointcoord.numerics.kantorovich import Certificate, certify, defect_of
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import components_last

# Most poses of a group, and the share by which a shared inverse may enlarge the bounds.
LARGEST, SHARED = 256, 0.02
# With fewer groups larger groups save no time: the overhead of each array operation dominates.
FEWEST = 16


@dataclass(frozen=True)
class Groups:
    """N instants as G groups of m consecutive ones; the last instant is repeated to fill the last group."""

    count: int
    size: int

    def together(self, array: Array) -> Array:
        """Values at the instants, (N, ...), as values by group, (G, m, ...)."""
        number = -(-self.count // self.size)
        if number * self.size == self.count:
            return array.reshape(number, self.size, *array.shape[1:])
        places = np.minimum(np.arange(number * self.size), self.count - 1).reshape(number, self.size)
        return np.moveaxis(np.moveaxis(array, 0, -1)[..., places], (-2, -1), (0, 1))

    def apart(self, array: Array) -> Array:
        """Values by group, (G, m, ...), as values at the instants, (N, ...)."""
        return array.reshape(-1, *array.shape[2:])[: self.count]


@dataclass(frozen=True)
class CertifiedPoses:
    """Poses by group, with their certificate; lengths in the mechanism's units.

    Attributes:
        pose: coordinates with exact values of the known ones, (G, m, size).
        factors: factorisation of C_u at the middle pose of each group.
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
            groups, factors: result of `grouped`.
            y: coordinates, (G, m, size).
            driven: exact values of the driven coordinates, by place in y, (G, m).
        """
        system = mechanism.map
        pose = with_known(y, system.unknowns, driven, mechanism.drawn_lacks, mechanism.drawn_doubt)
        return cls(groups, pose, factors, certify(system, pose, factors))


def grouped(system: QuadraticMap, y: Array, driven: Collection[int]) -> tuple[Groups, Factors]:
    """The largest groups of one size whose poses can share an inverse, and the factors of their middle poses.

    Args:
        y: coordinates of consecutive instants, (N, size).
        driven: places in y of the driven coordinates.
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
    """The largest power of two up to a number; 1 if the number is below 1 or NaN."""
    return int(2 ** int(np.log2(max(1.0, most))))


def with_known(
    state: Array,
    unknowns: int,
    driven: Mapping[int, Enclosed],
    lacks: ArrayLike = 0.0,
    doubt: ArrayLike = 0.0,
) -> Enclosed:
    """Coordinates, or their rates, with the unknown ones as computed and exact values of the known ones.

    Args:
        state: computed coordinates or rates, (G, m, size).
        unknowns: number of unknown coordinates.
        driven: exact values of the driven coordinates, by place, (G, m).
        lacks, doubt: rounding error of the other known coordinates, which stand still, to be added to them;
            and their uncertainty after that correction.
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
    """Proven error bound of every coordinate of the solved points of poses, shape (...,), mm.

    The bound includes one rounding of each coordinate by the shift to the user's origin.
    """
    pose = Enclosed.of(*(part[..., None, :] for part in (y, *mechanism.known_data(y))))
    certificate = certify(mechanism.map, pose, factors)
    points = certificate.coordinates[..., 0, : 3 * len(mechanism.topology.moving)].max(axis=-1)
    return np.asarray(points * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))
