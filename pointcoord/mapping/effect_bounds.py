r"""How far the numbers that a map gives are off, each at its own pose, whatever effect it is of.

A patch bounds the error e of its series and of their derivatives by the inputs, e_i and e_ij, everywhere on
it, the rounding of the sums included. So the states of a point, composed with the inputs' rates, are off by

    |e|,    sum_i |e_i| |x_i'|,    sum_i |e_i| |x_i''| + sum_ij |e_ij| |x_i'| |x_j'|,

and with these as the radii of where the points are, each effect tells how far its own numbers may be off, as
it does for a motion (see `results.proof`). The inputs and what moves the chassis count as they are
given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.patches.patches import Patches
from pointcoord.patches.reported_points import moving_points
from pointcoord.results.proof import bounds_of_numbers, enclosed_poses
from pointcoord.results.readout import Readout

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# Poses at a time: some hundred arrays of each point stay in a cache.
BLOCK = 1024


@dataclass(frozen=True)
class Evaluated:
    """Poses that a map gave.

    Attributes:
        readout: by which they were read. patch: of each pose, (N,).
        inputs: rates and accelerations of the map's inputs as far as they were given, each (N, p).
        moving: by derivative the sums of the patches' series, each (3 points, N), mm per s^d.
        laws: what moves the chassis as far as it was given, by input and by derivative, each (N,).
        numbers: what was reported, by quantity and name, each (N, 3) or (N,).
    """

    patches: Patches
    readout: Readout
    patch: Whole
    inputs: Sequence[Array]
    moving: Sequence[Array]
    laws: Mapping[str, Sequence[Array]]
    numbers: Numbers

    def bounds(self, shape: tuple[int, ...]) -> dict[str, dict[str, Array]]:
        """Proven error of every number for poses of a shape; infinite where none is known."""
        found = {
            q: {n: np.empty_like(a) for n, a in part.items()} for q, part in self.numbers.items() if part
        }
        # With no pose at all there is one block, of none.
        for low in range(0, max(len(self.patch), 1), BLOCK):
            here = slice(low, low + BLOCK)
            with np.errstate(all="ignore"):  # what overflows comes out infinite, which bounds nothing
                numbers = {q: {n: a[here] for n, a in arrays.items()} for q, arrays in self.numbers.items()}
                proven, _ = bounds_of_numbers(self._enclosed(here), self.readout.plan.computed, numbers)
            for quantity, bounds in proven.items():
                for name, bound in bounds.items():
                    found[quantity][name][here] = bound
        return {
            q: {n: a.reshape((*shape, *a.shape[1:])) for n, a in part.items()} for q, part in found.items()
        }

    def _enclosed(self, here: slice) -> EnclosedPoses:
        """Where the points of some poses are."""
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
        """How far the sums are off, by derivative, each (N, 3 points)."""
        patch, off = self.patch[here], self.patches.off
        # Products and sums of magnitudes round a few times: the inflation of bounds makes up for it.
        found = [off.value[patch]]
        rates = [np.abs(rate[here]) / self.patches.boxes[1][patch] for rate in self.inputs]
        if rates:
            found.append(np.einsum("ni,nim->nm", rates[0], off.first[patch]))
        if len(rates) > 1:
            bent = np.einsum("ni,nj,nijm->nm", rates[0], rates[0], off.second[patch])
            found.append(bent + np.einsum("ni,nim->nm", rates[1], off.first[patch]))
        return found
