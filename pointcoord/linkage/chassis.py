r"""Chassis motion: rotations of the whole car about lines through drawn points, then a displacement.

    x -> P + R(x - P),   R v = v + sin(a) k x v + (1 - cos(a)) (k (k . v) - v)      inputs a about P along k
    p(t) = x(t) + sum_i e_i h_i(t)                                        inputs h_i along directions e_i

The rotations are applied in the order of the mechanism's file. Constraints depend on differences of points
only, and rotations keep lengths, so chassis motion changes no constraint. The mechanism is solved in the
chassis' own frame, where neither the distance that the chassis moves nor its speed costs accuracy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import comb, factorial

import numpy as np

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.directions import V, axis_along
from pointcoord.linkage.drives import times, turn_slopes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics import enclosure
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import PAIRS
from pointcoord.numerics.enclosure import Enclosed, stacked, within_a_turn
from pointcoord.numerics.vectors import cross
from pointcoord.time_functions import TimeFunction

LARGEST = 1e300  # mm and s: a sum with an origin and some inputs stays finite
FASTEST = 1e140  # rad and s: squares of rates, times lengths, stay finite
# A rotation may enlarge the largest component of a vector to the vector's length, at most by this factor.
SPREAD = 3.0**0.5


@dataclass(frozen=True, eq=False)
class ChassisMotion:
    """Inputs that move the chassis, each along a unit vector of shape (..., 3).

    Attributes:
        functions: laws of those that the scene drives.
        directions: unit vector of each input.
        lacks: rounding error of a direction computed from the user's axes, to be added to the direction.
        centres: rotating inputs in order -> centre of rotation, (..., 3), mm from the mechanism's origin.
    """

    functions: Mapping[str, TimeFunction]
    directions: Mapping[str, Array]
    lacks: Mapping[str, Array] = field(default_factory=dict)
    centres: Mapping[str, Array] = field(default_factory=dict)

    @classmethod
    def of(cls, mechanism: Mechanism, functions: Mapping[str, TimeFunction]) -> ChassisMotion:
        """The chassis inputs of a mechanism."""
        topology, drawing = mechanism.topology, mechanism.drawing
        moves = topology.chassis_inputs.items()
        along = {name: axis_along(direction) if about else direction for name, (direction, about) in moves}
        unit = mechanism.unit[..., None]
        return cls(
            {name: function for name, function in functions.items() if name in along},
            {name: drawing.vectors[way] for name, way in along.items()},
            {name: drawing.lacks[way] for name, way in along.items() if way in drawing.lacks},
            {name: drawing.vectors[about] * unit for name, (_, about) in moves if about},
        )

    @property
    def turning(self) -> list[str]:
        """The driven inputs that turn the car, in order."""
        return [name for name in self.centres if name in self.functions]

    def shifts(self, laws: Mapping[str, Sequence[Array]]) -> list[Array]:
        """Displacement and its time derivatives, each (..., N, 3), mm; empty if nothing displaces the car.

        Args:
            laws: input -> its value and time derivatives, each (N,), mm; those of rotations are ignored.
        """
        sums: list[Array] = []
        for name, rates in ((name, rates) for name, rates in laws.items() if name not in self.centres):
            # Instants are contiguous in memory, as in a table of results.
            along = self.directions[name][..., None]
            parts = [(along * rate[..., None, :]).swapaxes(-1, -2) for rate in rates]
            sums = [old + new for old, new in zip(sums, parts, strict=True)] if sums else parts
        return sums

    def law(self, name: str, instants: Array, derivatives: int) -> Array:
        """The value of an input and its time derivatives, shape (derivatives + 1, N), mm or rad.

        Raises:
            InputOutOfRange: a value, a rate or an acceleration is too large to be added without overflow.
        """
        largest, unit = (FASTEST, "rad") if name in self.centres else (LARGEST, "mm")
        with np.errstate(over="ignore", invalid="ignore"):
            factors = [factorial(order) for order in range(derivatives + 1)]
            series = self.functions[name].series(instants, derivatives) * factors
        if not (np.abs(series) < largest).all():
            place, order = map(int, np.argwhere(~(np.abs(series) < largest))[0])
            per = "/s" * min(order, 1) + f"^{order}" * (order > 1)
            allowed = f"below {largest:g} {unit}{per} in size"
            raise InputOutOfRange(name, float(series[place, order]), allowed, float(instants[place]))
        return np.moveaxis(series, -1, 0)

    def turned_by(
        self, laws: Mapping[str, Sequence[Array]], states: Sequence[Mapping[str, Array]]
    ) -> Sequence[Mapping[str, Array]]:
        """States of points after the rotations of the car, in their order.

        Args:
            laws: input -> its value and time derivatives, each (N,), rad.
            states: by time derivative, point -> state in the chassis' frame, each (..., N, 3), mm from the
                mechanism's origin; each point up to its own highest derivative.
        """
        for name in (name for name in self.centres if name in laws):
            vectors = self.directions[name], self.centres[name]
            k, about = (v if v.ndim == 1 else v[..., None, :] for v in vectors)
            angle, *rates = (law[..., None] for law in laws[name])
            slopes = turn_slopes(np.cos(angle), np.sin(angle), 2.0 * np.sin(0.5 * angle) ** 2, rates)
            turned: list[dict[str, Array]] = [{} for _ in states]
            for point in states[0]:
                jet = [state[point] for state in states if point in state]
                for state, found in zip(
                    turned, _turned(jet, about, partial(_about, k), slopes), strict=False
                ):
                    state[point] = found
            states = turned
        return states

    def taken_back(self, instants: Array, places: Array) -> Array:
        """Places (N, 3) of a moved car, mm from the mechanism's origin, converted to the chassis' frame."""
        laws = {name: self.law(name, instants, 0) for name in self.functions}
        for shift in self.shifts({name: list(law) for name, law in laws.items()}):
            places = places - shift
        for name in reversed(self.turning):
            places = self.turned_by({name: list(-laws[name])}, [{"": places}])[0][""]
        return places

    def enclosed(
        self, laws: Mapping[str, Sequence[Enclosed]], origin: Array, derivatives: int
    ) -> list[Enclosed]:
        """Exact displacement plus an origin, and its time derivatives, enclosed, each (N, 3), mm and s.

        Args:
            laws: input -> its enclosed value and time derivatives, each (N,).
        """
        sums = [Enclosed.of(origin), *(Enclosed.of(np.zeros(3)) for _ in range(derivatives))]
        for name, law in laws.items():
            if name in self.directions and name not in self.centres:
                along = self._along(name)
                sums = [total + along * rate.spread_out for total, rate in zip(sums, law, strict=False)]
        return sums

    def turned_exactly(
        self,
        laws: Mapping[str, Sequence[Enclosed]],
        points: Sequence[Mapping[str, Enclosed]],
        unit: float,
        *,
        back: bool = False,
    ) -> Sequence[Mapping[str, Enclosed]]:
        """Exact places and rates of points after the rotations of the car, enclosed.

        Args:
            laws: input -> its enclosed value and time derivatives, each (N,), in the points' unit of time.
            points: by time derivative, point -> state in the chassis' frame, (N, 3), in units of length.
            unit: the unit of length, a power of two, mm.
            back: whether to rotate back, from the moved car to the chassis' frame.
        """
        names = [name for name in self.centres if name in laws]
        if not names:
            return points
        # All points at once: these arrays are so small that calls take most of the time.
        jet = [stacked([*of.values()]) for of in points]
        for name in reversed(names) if back else names:
            k, about = self._along(name), Enclosed.of(self.centres[name] / unit)
            angle, *rates = ((-law if back else law).spread_out for law in laws[name])
            cosine, sine = within_a_turn(angle).cosine_sine()
            slopes = turn_slopes(cosine, sine, Enclosed.of(1.0) - cosine, rates)
            jet = _turned(jet, about, partial(_about_exactly, k), slopes)
        return [dict(zip(of, stack.members, strict=True)) for of, stack in zip(points, jet, strict=True)]

    def _along(self, name: str) -> Enclosed:
        """A direction, enclosed: as given, or with the rounding of a cross product or of a unit length."""
        if name in self.lacks:
            return Enclosed.of(self.directions[name], self.lacks[name], PAIRS, PAIRS)
        return Enclosed.of(self.directions[name])


def _turned(
    jet: Sequence[V], about: V, axes: Callable[[V], tuple[V, V]], slopes: Sequence[tuple[V, V]]
) -> list[V]:
    """A point, or points in a stack, and the time derivatives after a rotation.

    Args:
        jet: the place, and its time derivatives.
        axes: v -> k x v and k (k . v) - v.
        slopes: by derivative, the sine and the versine of the angle, differentiated.
    """
    arm = list(jet)
    arm[0] = jet[0] - about
    parts = [axes(v) for v in arm]
    found: list[V] = []
    for d, total in enumerate(jet):
        # The product rule: (u v)'' = u v'' + 2 u' v' + u'' v.
        for i in range(d + 1):
            (sine, versine), (one, other) = slopes[i], parts[d - i]
            total = total + times(comb(d, i), one * sine + other * versine)
        found.append(total)
    return found


def _about(k: Array, v: Array) -> tuple[Array, Array]:
    return cross(k, v), k * np.sum(k * v, axis=-1, keepdims=True) - v


def _about_exactly(k: Enclosed, v: Enclosed) -> tuple[Enclosed, Enclosed]:
    return enclosure.cross(k, v), k * enclosure.dot(k, v).spread_out - v
