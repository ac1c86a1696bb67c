r"""The chassis moves: a displacement of the whole car, added to what is reported.

    p(t) = p_drawn chassis(t) + sum_i e_i h_i(t),      inputs h_i along directions e_i

Every constraint is made of differences of points, so a displacement of all of them changes none. The
mechanism is solved in the chassis' own frame, where neither the distance that the chassis goes nor its
speed costs a digit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]

LARGEST = 1e300  # mm and s: sums with an origin and of some inputs stay finite
FACTORIALS = np.array([1.0, 1.0, 2.0])


@dataclass(frozen=True)
class ChassisMotion:
    """Inputs that move the chassis, each along a unit vector of shape (..., 3)."""

    functions: Mapping[str, TimeFunction]
    directions: Mapping[str, Array]

    @classmethod
    def of(cls, mechanism: Mechanism, functions: Mapping[str, TimeFunction]) -> ChassisMotion:
        """Those of a mechanism's inputs that move its chassis."""
        along = mechanism.topology.chassis_motion
        moving = {name: f for name, f in functions.items() if name in along}
        return cls(moving, {name: mechanism.drawing.vectors[along[name]] for name in moving})

    def states(self, instants: Array, derivatives: int) -> list[Array]:
        """Displacement and its time derivatives, each (..., N, 3), mm; empty if nothing moves the chassis.

        Raises:
            InputOutOfRange: a value, a rate or an acceleration is too large to be added to anything.
        """
        sums: list[Array] = []
        for name in self.functions:
            # The instants lie side by side in memory, as in a table of results.
            along = self.directions[name][..., None]
            rates = self.law(name, instants, derivatives)
            parts = [(along * rate[..., None, :]).swapaxes(-1, -2) for rate in rates]
            sums = [old + new for old, new in zip(sums, parts, strict=True)] if sums else parts
        return sums

    def law(self, name: str, instants: Array, derivatives: int) -> Array:
        """The value of an input and its time derivatives, shape (derivatives + 1, N), mm.

        Raises:
            InputOutOfRange: as `states`.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            series = self.functions[name].series(instants, derivatives) * FACTORIALS[: derivatives + 1]
        if not (np.abs(series) < LARGEST).all():
            place, order = np.argwhere(~(np.abs(series) < LARGEST))[0]
            what = ("values", "rates", "accelerations")[order]
            raise InputOutOfRange(
                name,
                float(series[place, order]),
                f"{what} below {LARGEST:g} mm{('', '/s', '/s^2')[order]} in size",
                float(instants[place]),
            )
        return np.moveaxis(series, -1, 0)

    def enclosed(self, laws: Mapping[str, Sequence[Enclosed]], origin: Array) -> list[Enclosed]:
        """Exact displacement with an origin added, and its two time derivatives, each (N, 3), mm and s.

        Args:
            laws: by input, where its value, rate and acceleration exactly are, each (N,).
        """
        still = np.zeros(3)
        sums = [Enclosed.of(origin), Enclosed.of(still), Enclosed.of(still)]
        for name in self.functions:
            along = Enclosed.of(self.directions[name])
            sums = [total + along * law.spread_out for total, law in zip(sums, laws[name], strict=True)]
        return sums

    def rounding(self, instants: Array, origin: Array) -> Array:
        """Rounding of the displacement and of its sum with an origin, (..., N, 3), mm.

        k inputs take k products and k - 1 sums, each rounded by at most u of the sum of the products'
        magnitudes; the sum with the origin is rounded by u of itself; the laws have their own. An axis
        along which nothing moves is not rounded at all.
        """
        magnitude, laws = np.zeros((*np.shape(instants), 3)), np.zeros((*np.shape(instants), 3))
        for name, function in self.functions.items():
            along = np.abs(self.directions[name][..., None, :])
            magnitude = magnitude + np.abs(function.series(instants, 0)) * along
            laws = laws + function.rounding(instants)[:, None] * along
        count = 2.0 * len(self.functions)
        total = UNIT_ROUNDOFF * (count * magnitude + np.abs(origin[..., None, :]) + magnitude)
        return np.where(magnitude + laws > 0.0, 1.01 * (total + laws), 0.0)
