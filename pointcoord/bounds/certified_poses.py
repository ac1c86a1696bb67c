"""What is certified of the poses of a motion, in groups of neighbours that share an inverse.

A group is as large as its poses lie close enough together for: the inverse of the middle one then costs the
others a few per cent of their bounds (see `kantorovich`). A pose without close neighbours is a group of one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.kantorovich import Certificate, certify, defect_of
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

# Poses of a group, and what sharing an inverse may cost their bounds: this part of the error.
SIZES, SHARED = (256, 64, 16, 4, 1), 0.02
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

    def most(self, array: Array) -> Array:
        """The largest of each group, (G, ...), of numbers (N, ...)."""
        return np.asarray(self.together(array).max(axis=1))


@dataclass(frozen=True)
class Known:
    """What a driven coordinate lacks of what the user's numbers mean, and its doubt.

    Attributes:
        lacking: (N,).
        doubt, expected: how uncertain it still is with that added, proven and expected, (N,).
    """

    lacking: Array
    doubt: Array
    expected: Array


@dataclass(frozen=True)
class CertifiedPoses:
    """Poses by group, with their certificate; lengths in the mechanism's units.

    Attributes:
        y: coordinates, (G, m, size).
        low: what the known ones of these lack, (G, m, size).
        doubt, expected: how uncertain each coordinate is with that added, proven and expected, (G, size).
        factors: of the middle pose of each group.
    """

    groups: Groups
    y: Array
    low: Array
    doubt: Array
    expected: Array
    factors: Factors
    certificate: Certificate

    @classmethod
    def of(cls, mechanism: Mechanism, y: Array, driven: Mapping[int, Known]) -> CertifiedPoses:
        """Certify poses.

        Args:
            y: coordinates of consecutive instants, (N, size).
            driven: what is known of the driven coordinates, by place in y.
        """
        system = mechanism.map
        low = np.empty((system.size, len(y)))
        low[:] = mechanism.drawn_lacks[:, None]
        for place, known in driven.items():
            low[place] = known.lacking
        doubt = mechanism.drawn_doubt.copy()
        for place, known in driven.items():
            doubt[place] = known.doubt.max(initial=0.0)
        groups, factors = _grouped(system, y, np.abs(low).max(axis=-1, initial=0.0) + doubt)
        number = len(factors.condition)
        proven = np.tile(mechanism.drawn_doubt, (number, 1))
        expected = np.tile(mechanism.drawn_doubt + np.abs(mechanism.drawn_lacks), (number, 1))
        for place, known in driven.items():
            proven[:, place], expected[:, place] = groups.most(known.doubt), groups.most(known.expected)
        together, missing = groups.together(y), groups.together(low.T)
        certificate = certify(system, together, factors, proven[:, None], missing)
        return cls(groups, together, missing, proven, expected, factors, certificate)

    @property
    def condition(self) -> Array:
        """Condition number of the Jacobian of each group's middle pose, (G,)."""
        return self.factors.condition


def _grouped(system: QuadraticMap, y: Array, data: Array) -> tuple[Groups, Factors]:
    """As few groups as can share an inverse, all of one size, with the factors of their middle poses.

    Args:
        data: how far any coordinate may be off, (size,).
    """
    for size in SIZES:
        if size > 1 and FEWEST * size > len(y):
            continue
        groups = Groups(len(y), size)
        together = groups.together(y)
        factors = factorise(system.jacobian(together[:, size // 2]))
        with np.errstate(invalid="ignore", over="ignore"):
            inverse = factors.preconditioner
            if size == 1 or (defect_of(system, together, inverse, data).sum(axis=-1) <= SHARED).all():
                break
    return groups, factors


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of the solved points of poses, shape (...,), mm.

    The shift to the user's origin rounds each coordinate once more.
    """
    lacking, uncertainty = mechanism.known_data(y)
    y, uncertainty, lacking = (part[..., None, :] for part in (y, uncertainty, lacking))
    certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
    points = certificate.coordinates[..., 0, : 3 * len(mechanism.topology.moving)].max(axis=-1)
    return np.asarray(points * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))
