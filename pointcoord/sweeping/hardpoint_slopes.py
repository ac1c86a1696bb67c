r"""What the numbers of a solved scene change by with its hardpoints, to first order: exact derivatives.

A hardpoint's coordinate x changes the known coordinates w: the places of points of the chassis, and what is
read off the drawing, such as lengths and the places of points in their bodies. The inputs keep their values.
So the poses y(t, x) change by what C(y) = 0 says in the orders d of t and 1 of x,

    C_u u_x^(d) = -( C_w w_x^(d) + sum_{0 < i <= d} binomial(d, i) 2 B(y^(i), y_x^(d-i)) ),

and so do their derivatives along a way (see `linkage.slopes`), which takes the place of t with d = 1. The
formulas of the effects are evaluated with duals of these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.arithmetic import Dual
from pointcoord.effects.effect import Poses
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import hardpoints_moved
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import (
    GAP,
    Way,
    known_slopes,
    point_series,
    point_slopes,
    shifted,
    way_slopes,
)
from pointcoord.numerics.counters import Work
from pointcoord.numerics.infinitesimal import slope_of, with_slope
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import implicit_rate, implicit_slopes, newton_refine
from pointcoord.results.readout import alone
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.pointwise import square_velocity_term, with_rates

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DualPoses(Poses):
    """Poses of duals, whose slopes have a dimension of K parameters before those of the values.

    The mechanism is one with slopes of all that is read off its drawing.
    """

    def constant(self, number: Array) -> Dual[Array]:
        return Dual(number, np.zeros_like(number))

    @cached_property
    def drawn(self) -> Mapping[str, Dual[Array]]:
        return _duals(self.mechanism.drawn_places)


@dataclass(frozen=True, eq=False)
class MovedPoses:
    """Poses at instants as coordinates with slopes by K parameters (see `infinitesimal`).

    Attributes:
        times: (N,), s.
        states: y and its time derivatives, (K, N, size).
        ways: its derivative along each way, per rad, mm or unit, (K, N, size).
        violated: what the rows that are left out, as they follow from the others, change by where a hardpoint
            moves by the mechanism's unit, (K, N, rows).
    """

    times: Array
    states: Sequence[Array]
    ways: Mapping[Way, Array]
    violated: Array


@dataclass(frozen=True, eq=False)
class ByHardpoints:
    """A solved scene and K parameters of its hardpoints.

    Attributes:
        moves: by hardpoint, what its drawn place changes by with each parameter, (K, 3), mm; of all of them.
    """

    solved: SolvedScene
    moves: Mapping[str, Array]

    @property
    def mechanism(self) -> Mechanism:
        return self.solved.readout.mechanism

    @cached_property
    def moved(self) -> Mechanism:
        """With slopes of all that is read off the drawing."""
        return hardpoints_moved(self.mechanism, self.moves)

    def poses(self, times: Array) -> MovedPoses:
        """Poses at instants of the scene, (N,), s."""
        plan, mechanism, system = self.solved.readout.plan, self.mechanism, self.mechanism.map
        highest = plan.derivative
        laws = {name: law.series(times, highest) for name, law in self.solved.functions.items()}
        known, by_x = mechanism.known_series(laws), slope_of(self.moved.known_series(laws))
        y = self.solved.coordinates(times, 0)[0].copy()
        y[:, system.unknowns :] = known[:, 0]
        # The motion is within its tolerance, and a derivative is to be within rounding.
        y = newton_refine(system, y).y
        states = with_rates(system, y, known, times, highest, square_velocity_term, Work()).states
        driven = [factorial(d) * by_x[..., d, :] for d in range(highest + 1)]
        factors = factorise(system.jacobian(y))
        slopes = implicit_slopes(system, factors, states, driven)
        inputs, found = {name: law[:, 0] for name, law in laws.items()}, {}
        ways = plan.ways(mechanism.topology)
        for way, rate in zip(ways, way_slopes(mechanism, y, ways), strict=True):
            gap, rows = shifted(mechanism.topology, way)
            more = 2.0 * (system.polar(rate, slopes[0]) + rows * system.polar(slopes[0], gap))
            own = slope_of(known_slopes(self.moved, inputs, way))
            found[way] = with_slope(rate, implicit_rate(system, factors, y, own, more))
        violated = np.zeros((*slopes[0].shape[:-1], 0))
        if mechanism.topology.left_out:
            violated = 2.0 * float(mechanism.unit) * mechanism.topology.left_map.polar(y, slopes[0])
        return MovedPoses(times, list(map(with_slope, states, slopes)), found, violated)

    def numbers(self, at: MovedPoses) -> dict[str, dict[str, Array]]:
        """What every number changes by, by quantity and name, (K, N) of the car and (K, N, 3) of others."""
        readout, moved = self.solved.readout, self.moved
        laws, orders = readout.laws(at.times), [factorial(d) for d in range(len(at.states))]
        series = np.stack([state / n for state, n in zip(at.states, orders, strict=True)], axis=-2)
        of_points = point_series(moved, series).items()
        in_chassis = [{name: n * each[..., d, :] for name, each in of_points} for d, n in enumerate(orders)]
        centres = {name: centre[:, 0] for name, centre in ChassisMotion.of(moved, {}).centres.items()}
        chassis = replace(readout.chassis, centres=centres)
        ways = {}
        for way, rate in at.ways.items():
            along = point_slopes(moved, at.states[0], rate, way)
            places = {GAP: np.zeros_like(along[GAP])} if GAP in along else {}
            turned = chassis.turned_by(alone(laws, way), [in_chassis[0] | places, along])
            ways[way] = _duals(turned[1]), _duals(along)
        poses = DualPoses(
            moved,
            readout.axes,
            list(map(_duals, chassis.turned_by(laws, in_chassis))),
            list(map(_duals, in_chassis)),
            [None if one is None else Dual(one, np.zeros_like(one)) for one in readout.added(laws)],
            ways,
        )
        found: dict[str, dict[str, Array]] = {}
        for effect in readout.plan.computed:
            evaluated: Mapping[str, Mapping[str, Any]] = effect.evaluate(poses)
            for quantity, numbers in evaluated.items():
                for name, number in numbers.items():
                    slope = np.broadcast_to(number.slope, (len(series), *number.value.shape))
                    found.setdefault(quantity, {})[name] = slope
        return found


def _duals(points: Mapping[str, Array]) -> dict[str, Dual[Array]]:
    """Values, (N, 3), which are the same for all parameters, and slopes, (K, N, 3)."""
    return {name: Dual(point.real[0], slope_of(point)) for name, point in points.items()}
