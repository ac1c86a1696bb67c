r"""How far the numbers that a map gives are off, each at its own pose, whatever effect it is of.

A patch bounds the error e of its series and of their derivatives by the inputs, e_i and e_ij, everywhere on
it, the rounding of the sums included. So the states of a point, composed with the inputs' rates, are off by

    |e|,    sum_i |e_i| |x_i'|,    sum_i |e_i| |x_i''| + sum_ij |e_ij| |x_i'| |x_j'|,

and with these as the radii of where the points are, each effect tells how far its own numbers may be off, as
it does for a motion (see `effects.effect.Effect.errors`). The inputs and what moves the chassis count as they
are given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_points import EnclosedPoses
from pointcoord.data_classes import dataclass
from pointcoord.effects.effect import Effect
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.patches.jet import Jet

Array = NDArray[np.float64]
Whole = NDArray[np.int64]
Numbers = Mapping[str, Mapping[str, Array]]

# Poses at a time: some hundred arrays of each point stay in a cache.
BLOCK = 1024


@dataclass(frozen=True)
class Evaluated:
    """Poses that a map gave.

    Attributes:
        off: errors of each patch's sums, by parts of its half widths, (P, 3 points), mm. half: these, (P, p).
        patch: of each pose, (N,).
        inputs: rates and accelerations of the map's inputs as far as they were given, each (N, p).
        moving: by derivative the states of the points that move, in the order of `off`, (N, points, 3), mm
            per s^d, in the chassis' frame and from the mechanism's origin.
        chassis: how it moves. laws: what moves it as far as it was given, by input and by
            derivative, each (N,).
        numbers: what was reported, by quantity and name, each (N, 3) or (N,).
    """

    mechanism: Mechanism
    axes: CarAxes
    points: Sequence[str]
    off: Jet
    half: Array
    patch: Whole
    inputs: Sequence[Array]
    moving: Array
    chassis: ChassisMotion
    laws: Mapping[str, Sequence[Array]]
    numbers: Numbers

    def bounds(self, effects: Sequence[Effect]) -> dict[str, dict[str, Array]]:
        """Proven error of every number of some effects, of its shape; infinite where none is known."""
        found = {q: {n: np.empty_like(a) for n, a in arrays.items()} for q, arrays in self.numbers.items()}
        for low in range(0, len(self.patch), BLOCK):
            here = slice(low, low + BLOCK)
            with np.errstate(all="ignore"):  # what overflows comes out infinite, which bounds nothing
                poses = self._enclosed(here)
                numbers = {q: {n: a[here] for n, a in arrays.items()} for q, arrays in self.numbers.items()}
                for effect in effects:
                    for quantity, errors in effect.errors(poses, numbers).items():
                        for name, (proven, _) in errors.items():
                            # What cannot be told is not bounded.
                            bound = np.where(np.isnan(proven), np.inf, INFLATION * proven)
                            found[quantity][name][here] = bound
        return found

    def _enclosed(self, here: slice) -> EnclosedPoses:
        """Where the points of some poses are."""
        mechanism, topology = self.mechanism, self.mechanism.topology
        count, parts = len(self.patch[here]), 1.0 / float(mechanism.unit)
        vectors = mechanism.drawing.vectors
        found: list[dict[str, Enclosed]] = []
        for d, radius in enumerate(self._radii(here)):
            still = {
                name: np.broadcast_to(vectors[name] if d == 0 else np.zeros(3), (count, 3))
                for name in topology.chassis
            }
            points = {name: Enclosed.of(place) for name, place in still.items()}
            for i, name in enumerate(self.points):
                state, off = self.moving[d, here, i], radius[:, i]
                points[name] = Enclosed.of(state, 0.0, off, off).scaled(parts)
            found.append(points)
        laws = {name: [Enclosed.of(rate[here]) for rate in law] for name, law in self.laws.items()}
        turned = self.chassis.turned_exactly(laws, found, float(mechanism.unit))
        added = self.chassis.enclosed(laws, mechanism.origin)
        return EnclosedPoses(mechanism, self.axes, turned, added, [np.ones(count)] * len(found))

    def _radii(self, here: slice) -> list[Array]:
        """How far the states of the points that move are off, by derivative, each (N, points, 3)."""
        patch, half = self.patch[here], self.half[self.patch[here]]
        shape = (len(patch), len(self.points), 3)
        # Products and sums of magnitudes round a few times: `INFLATION` makes up for it.
        found = [self.off.value[patch].reshape(shape)]
        rates = [np.abs(rate[here]) / half for rate in self.inputs]
        if rates:
            found.append(np.einsum("ni,nim->nm", rates[0], self.off.first[patch]).reshape(shape))
        if len(rates) > 1:
            bent = np.einsum("ni,nj,nijm->nm", rates[0], rates[0], self.off.second[patch])
            bent += np.einsum("ni,nim->nm", rates[1], self.off.first[patch])
            found.append(bent.reshape(shape))
        return found
