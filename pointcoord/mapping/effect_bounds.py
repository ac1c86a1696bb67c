r"""Error bounds of the numbers of all effects that a kinematic map gives, for each pose.

A patch bounds the error e of its series and the errors e_i and e_ij of their derivatives by the inputs
everywhere on the patch, rounding of the sums included. So the errors of position, velocity and acceleration
of a point, for given rates of the inputs, are at most

    |e|,    sum_i |e_i| |x_i'|,    sum_i |e_i| |x_i''| + sum_ij |e_ij| |x_i'| |x_j'|.

With these as radii of the points, each effect computes the error bounds of its numbers, as for a motion (see
`results.proof`). The given inputs and chassis inputs count as exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers
from pointcoord.numerics.arrays import Array, Integers
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.patches.patches import Patches
from pointcoord.patches.reported_points import moving_points
from pointcoord.results.proof import bounds_of_numbers, enclosed_poses
from pointcoord.results.readout import Readout

# Poses of a block: a hundred arrays for each point stay in a cache.
BLOCK = 1024


@dataclass(frozen=True)
class Evaluated:
    """Poses that a map was evaluated at.

    Attributes:
        patches: the patches of the map.
        readout: computed the numbers from states.
        patch: number of the patch of each pose, (N,).
        inputs: rates and accelerations of the map's inputs, if given, each (N, p).
        moving: sums of the patches' series, by derivative, each (3 points, N), mm per s^d.
        laws: given values and rates of chassis inputs, by input and derivative, each (N,).
        numbers: the reported numbers, by quantity and name, each (N, 3) or (N,).
    """

    patches: Patches
    readout: Readout
    patch: Integers
    inputs: Sequence[Array]
    moving: Sequence[Array]
    laws: Mapping[str, Sequence[Array]]
    numbers: Numbers

    def bounds(self, shape: tuple[int, ...]) -> dict[str, dict[str, Array]]:
        """Proven error bound of every number, for poses of a shape; infinite where nothing is proven."""
        found = {
            q: {n: np.empty_like(a) for n, a in part.items()} for q, part in self.numbers.items() if part
        }
        # Without poses there is one empty block, so that the arrays still get their names.
        for low in range(0, max(len(self.patch), 1), BLOCK):
            here = slice(low, low + BLOCK)
            with np.errstate(all="ignore"):  # an overflow gives an infinite bound
                numbers = {q: {n: a[here] for n, a in arrays.items()} for q, arrays in self.numbers.items()}
                proven, _ = bounds_of_numbers(self._enclosed(here), self.readout.plan.computed, numbers)
            for quantity, bounds in proven.items():
                for name, bound in bounds.items():
                    found[quantity][name][here] = bound
        return {
            q: {n: a.reshape((*shape, *a.shape[1:])) for n, a in part.items()} for q, part in found.items()
        }

    def _enclosed(self, here: slice) -> EnclosedPoses:
        """Enclosures of the points of some poses."""
        mechanism = self.readout.mechanism
        topology, vectors, unit = mechanism.topology, mechanism.drawing.vectors, float(mechanism.unit)
        count = len(self.patch[here])
        found: list[dict[str, Enclosed]] = []
        for d, (state, radius) in enumerate(zip(self.moving, self._radii(here), strict=True)):
            sums = Enclosed.of(state[:, here].T, 0.0, radius, radius).scaled(1.0 / unit)
            points = {
                name: Enclosed.of(np.broadcast_to(vectors[name] * (d == 0), (count, 3)))
                for name in topology.chassis
            }
            for i, name in enumerate(moving_points(topology)):
                points[name] = sums.take([3 * i, 3 * i + 1, 3 * i + 2])
            found.append(points)
        laws = {name: [Enclosed.of(rate[here]) for rate in law] for name, law in self.laws.items()}
        return enclosed_poses(self.readout, found, laws, [np.ones(count)] * len(found))

    def _radii(self, here: slice) -> list[Array]:
        """Error bounds of the sums, by derivative, each (N, 3 points), mm per s^d."""
        patch, off = self.patch[here], self.patches.off
        # The few roundings of these products and sums are covered by the inflation of bounds.
        found = [off.value[patch]]
        rates = [np.abs(rate[here]) / self.patches.boxes[1][patch] for rate in self.inputs]
        if rates:
            found.append(np.einsum("ni,nim->nm", rates[0], off.first[patch]))
        if len(rates) > 1:
            bent = np.einsum("ni,nj,nijm->nm", rates[0], rates[0], off.second[patch])
            found.append(bent + np.einsum("ni,nim->nm", rates[1], off.first[patch]))
        return found
