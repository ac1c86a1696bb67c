"""States of points: from solved coordinates, at the instants of a scene or at any instants of a chain.

Only what the plan of a scene asks for is evaluated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_rates import Summed
from pointcoord.effects.effect import Plan
from pointcoord.errors import OutsideMotion
from pointcoord.linkage.carried_points import carried_series
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.results.motion import Samples
from pointcoord.results.readout import Readout
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.pointwise import Solved
from pointcoord.solve.taylor import Chain
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]


def solved_states(readout: Readout, solved: Solved) -> list[dict[str, Array]]:
    """States of the points that the plan asks for, from states of all coordinates."""
    mechanism, plan = readout.mechanism, readout.plan
    layout, topology = mechanism.layout, mechanism.topology
    taylor = np.stack([state / max(order, 1) for order, state in enumerate(solved.states)], axis=-2)
    series = {name: taylor[..., list(layout.vector(name))] for name in (*topology.chassis, *topology.moving)}
    for name, carriers in topology.carried.items():
        series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
    names = [set(topology.points)] + [_points_at(mechanism, plan, d) for d in range(1, plan.derivative + 1)]
    return [
        {
            name: series[name][..., order, :] * (max(order, 1) * mechanism.unit)
            for name in topology.points
            if name in wanted
        }
        for order, wanted in enumerate(names)
    ]


def _points_at(mechanism: Mechanism, plan: Plan, derivative: int) -> set[str]:
    """Points whose derivative the plan asks for."""
    if derivative <= plan.derivative_of_points:
        return set(mechanism.topology.points)
    return {point for body in mechanism.topology.bodies.values() for point in body}


@dataclass(frozen=True)
class Sampler:
    """Evaluates a chain at any instants inside it."""

    readout: Readout
    functions: Mapping[str, TimeFunction]
    chain: Chain
    start: float

    def __call__(self, instants: Array) -> Samples:
        """The plan's results at instants of shape (N,).

        Raises:
            OutsideMotion: an instant outside the chain, or not a number.
        """
        outside = ~((instants >= self.start) & (instants <= self.chain.stop))
        if outside.any():
            raise OutsideMotion(float(instants[outside][0]), self.start, self.chain.stop)
        plan, topology = self.readout.plan, self.readout.mechanism.topology
        moving = [*topology.moving, *topology.carried]
        states: list[dict[str, Array]] = [{} for _ in range(plan.derivative + 1)]
        for order in range(plan.derivative_of_points + 1):
            states[order] |= self._chassis(len(instants), order)
        for names, derivatives in self._requests(moving):
            columns = [np.concatenate([series[n] for n in names], axis=-1) for series in self._point_series]
            values = evaluate(self.chain, columns, instants, derivatives)
            for order in range(derivatives + 1):
                for i, name in enumerate(names):
                    states[order][name] = values[order, ..., 3 * i : 3 * i + 3]
        ordered = [{name: state[name] for name in topology.points if name in state} for state in states]
        return self.readout.samples(instants, ordered)

    def coordinates(self, instants: Array) -> list[Array]:
        """y and the derivatives that the plan solves for, at instants, each of shape (N, size)."""
        mechanism, derivative = self.readout.mechanism, self.readout.plan.derivative
        pieces = [segment.coefficients for segment in self.chain.segments]
        y, *rates = evaluate(self.chain, pieces, instants, derivative)
        known = mechanism.known_series({name: f.series(instants, 0) for name, f in self.functions.items()})
        y[..., mechanism.map.unknowns :] = known[..., 0, :]
        return [y, *rates]

    def summed(self, instants: Array) -> list[Summed]:
        """How `coordinates` sums each derivative at instants."""
        terms = [np.abs(segment.coefficients) for segment in self.chain.segments]
        derivative = self.readout.plan.derivative

        def sums(first: int, last: int | None) -> Array:
            """Of the terms from one to another, counted from the end."""
            kept = [np.zeros_like(t) for t in terms]
            for part, whole in zip(kept, terms, strict=True):
                part[first:last] = whole[first:last]
            return evaluate(self.chain, kept, instants, derivative)

        parts = (sums(-2, None), sums(-4, -2), sums(0, None))
        return [Summed(*part) for part in zip(*parts, strict=True)]

    @property
    def work(self) -> Work:
        """What evaluating costs per instant."""
        topology = self.readout.mechanism.topology
        requests = self._requests([*topology.moving, *topology.carried])
        return Work(
            derivatives_evaluated=self.readout.plan.derivative + 1,
            coordinates_evaluated=sum(3 * len(names) * (derivatives + 1) for names, derivatives in requests),
        )

    def _requests(self, moving: list[str]) -> list[tuple[list[str], int]]:
        """Which points to evaluate to which derivative."""
        plan, topology = self.readout.plan, self.readout.mechanism.topology
        requests = [(moving, plan.derivative_of_points)]
        if plan.derivative > plan.derivative_of_points:
            body_points = {point for body in topology.bodies.values() for point in body}
            requests.append(([name for name in moving if name in body_points], plan.derivative))
        return requests

    @cached_property
    def _point_series(self) -> list[dict[str, Array]]:
        """For each segment the series of every moving and carried point, (..., order + 1, 3), mm."""
        mechanism = self.readout.mechanism
        layout, topology = mechanism.layout, mechanism.topology
        result = []
        for segment in self.chain.segments:
            series = {name: segment.coefficients[..., list(layout.vector(name))] for name in topology.moving}
            for name, carriers in topology.carried.items():
                series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
            unit = np.asarray(mechanism.unit)[..., None, None]
            result.append({name: points * unit for name, points in series.items()})
        return result

    def _chassis(self, count: int, order: int) -> dict[str, Array]:
        """States of the chassis points, which stand still in the chassis' frame."""
        mechanism = self.readout.mechanism
        unit = np.asarray(mechanism.unit)[..., None, None]
        shape = (*self.chain.segments[0].coefficients.shape[:-2], count, 3)
        states = {}
        for name in mechanism.topology.chassis:
            place = mechanism.drawing.vectors[name][..., None, :] * unit
            states[name] = np.broadcast_to(place if order == 0 else np.zeros(3), shape)
        return states
