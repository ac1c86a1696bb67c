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
from math import comb, factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.arithmetic import Dual, cross, multiple, times
from pointcoord.effects.effect import Poses
from pointcoord.linkage.hardpoints import hardpoints_moved
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import GAP, ByGap, Way, known_slopes, shifted, way_slopes
from pointcoord.numerics.counters import Work
from pointcoord.numerics.infinitesimal import slope_of
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import implicit_rate, implicit_slopes, newton_refine
from pointcoord.results.readout import Laws, alone
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.pointwise import square_velocity_term, with_rates

Array = NDArray[np.float64]
Points = Mapping[str, Dual[Array]]
"""Places or derivatives of these, mm: values (N, 3), and slopes (K, N, 3) by each of K parameters."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DualPoses(Poses):
    """Poses of duals, whose slopes have a dimension of K parameters before those of the values.

    Attributes:
        moves: by hardpoint, what its drawn place changes by, (K, 3), mm.
    """

    moves: Mapping[str, Array]

    def constant(self, number: Array) -> Dual[Array]:
        """With a slope of 0."""
        return Dual(number, np.zeros_like(number))

    @property
    def drawn(self) -> Points:
        """Where every point is drawn, which is what moves."""
        places = self.mechanism.drawn_places
        return {name: Dual(place, self.moves[name][:, None]) for name, place in places.items()}


@dataclass(frozen=True, eq=False)
class MovedPoses:
    """Poses at instants and what they change by, in coordinates.

    Attributes:
        times: (N,), s.
        states: y and its time derivatives, values (N, size), slopes (K, N, size).
        ways: its derivative along each way likewise, per rad, mm or unit.
        violated: what the rows that are left out, as they follow from the others, change by where a hardpoint
            moves by the mechanism's unit, (K, N, rows).
    """

    times: Array
    states: Sequence[Dual[Array]]
    ways: Mapping[Way, Dual[Array]]
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
        """As it is drawn."""
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
            found[way] = Dual(rate, implicit_rate(system, factors, y, own, more))
        violated = np.zeros((*slopes[0].shape[:-1], 0))
        if mechanism.topology.left_out:
            violated = 2.0 * float(mechanism.unit) * mechanism.topology.left_map.polar(y, slopes[0])
        return MovedPoses(times, list(map(Dual, states, slopes)), found, violated)

    def numbers(self, at: MovedPoses) -> dict[str, dict[str, Array]]:
        """What every number changes by, by quantity and name, (K, N) of the car and (K, N, 3) of others."""
        readout, count = self.solved.readout, len(next(iter(self.moves.values())))
        laws, slopes, unit = readout.laws(at.times), {}, float(self.mechanism.unit)
        for way, along in at.ways.items():
            points = self._points([at.states[0], along])
            if isinstance(way, ByGap):
                nothing = np.zeros((len(at.times), 3))
                opened = Dual(nothing + np.eye(3)[way.axis] * unit, nothing)
                points = [points[0] | {GAP: Dual(nothing, nothing)}, points[1] | {GAP: opened}]
            slopes[way] = self._turned(alone(laws, way), points)[1], points[1]
        in_chassis = self._points(at.states)
        poses = DualPoses(
            self.mechanism,
            readout.axes,
            self._turned(laws, in_chassis),
            in_chassis,
            [None if one is None else Dual(one, np.zeros_like(one)) for one in readout.added(laws)],
            slopes,
            moves=self.moves,
        )
        found: dict[str, dict[str, Array]] = {}
        for effect in readout.plan.computed:
            evaluated: Mapping[str, Mapping[str, Any]] = effect.evaluate(poses)
            for quantity, numbers in evaluated.items():
                for name, number in numbers.items():
                    slope = np.broadcast_to(number.slope, (count, *number.value.shape))
                    found.setdefault(quantity, {})[name] = slope
        return found

    def _points(self, states: Sequence[Dual[Array]]) -> list[dict[str, Dual[Array]]]:
        """Every point of coordinates and of their derivatives; a carried one is p_0 + a e1 + b e2 + c n."""
        topology, layout = self.mechanism.topology, self.mechanism.layout
        found: list[dict[str, Dual[Array]]] = [{} for _ in states]
        for name in (*topology.chassis, *topology.moving):
            span = layout.span(name)
            for points, state in zip(found, states, strict=True):
                points[name] = Dual(state.value[..., span], state.slope[..., span])
        for name, carriers in topology.carried.items():
            base, first, second = ([points[carrier] for points in found] for carrier in carriers)
            e1, e2 = (
                [end - start for end, start in zip(ends, base, strict=True)] for ends in (first, second)
            )
            weights, moved = self.mechanism.carrier_weights[name], slope_of(self.moved.carrier_weights[name])
            a, b, c = (Dual(weights[..., i], moved[..., i]) for i in range(3))
            for d, points in enumerate(found):
                normal, *more = (multiple(comb(d, i), cross(e1[i], e2[d - i])) for i in range(d + 1))
                points[name] = base[d] + times(a, e1[d]) + times(b, e2[d]) + times(c, sum(more, normal))
        unit = float(self.mechanism.unit)
        return [{name: multiple(unit, place) for name, place in points.items()} for points in found]

    def _turned(self, laws: Laws, states: Sequence[Points]) -> list[dict[str, Dual[Array]]]:
        """Points after the turns of the chassis.

        A turn is linear in the points and its centre together, so that what these change by is turned alike.
        """
        chassis, turns = self.solved.readout.chassis, self.mechanism.topology.chassis_turns
        centres = {name: self.moves[about] for name, (_, about) in turns.items()}
        values = chassis.turned_by(laws, [{n: p.value for n, p in points.items()} for points in states])
        slopes = replace(chassis, centres=centres).turned_by(
            laws, [{n: p.slope for n, p in points.items()} for points in states]
        )
        return [
            {name: Dual(place, slope[name]) for name, place in value.items()}
            for value, slope in zip(values, slopes, strict=True)
        ]
