"""States of points: from solved coordinates, at the instants of a scene or at any instants of a chain.

Only what the plan of a scene asks for is evaluated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_rates import Summed
from pointcoord.bounds.solved_coordinates import SolvedCoordinates
from pointcoord.errors import OutsideMotion
from pointcoord.linkage.carried_points import carried_series
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import Readout
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.pointwise import Solved
from pointcoord.solve.status import Status
from pointcoord.solve.taylor import Chain
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]


class SolvedStates(SolvedCoordinates, Protocol):
    """The states of a linkage's points, as they were solved for."""

    @property
    def dense(self) -> bool:
        """Whether they are known between the scene's instants too."""
        ...

    @property
    def status(self) -> Status:
        """Whether they cover all that was asked for, and if not, what stopped the solver."""
        ...

    @property
    def work(self) -> Work:
        """What solving took, and what reading them takes of each instant."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """Where they were not solved for as the scene asks."""
        ...

    def covered(self, instants: Array) -> Array:
        """Those of a scene's instants at which they are known."""
        ...

    def states(self, instants: Array) -> list[dict[str, Array]]:
        """By time derivative, the states of the points that the plan asks for (see `readout.States`).

        Raises:
            OutsideMotion: an instant that is not covered, or not a number.
        """
        ...


@dataclass(frozen=True)
class StatesAtInstants:
    """States that were solved for at each instant by itself."""

    readout: Readout
    solved: Solved
    notes: tuple[str, ...] = ()
    dense: bool = False

    @property
    def status(self) -> Status:
        """The solver's."""
        return self.solved.status

    def covered(self, instants: Array) -> Array:
        """Up to the last one that was reached."""
        return instants[: len(self.solved.times)]

    def states(self, instants: Array) -> list[dict[str, Array]]:
        """States at some of the instants."""
        mechanism, derivatives = self.readout.mechanism, self.readout.derivatives
        layout, topology = mechanism.layout, mechanism.topology
        coordinates = self.coordinates(instants)
        taylor = np.stack([state / max(order, 1) for order, state in enumerate(coordinates)], axis=-2)
        places = {name: list(layout.vector(name)) for name in (*topology.chassis, *topology.moving)}
        series = {name: taylor[..., place] for name, place in places.items()}
        for name, carriers in topology.carried.items():
            series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
        return [
            {
                name: series[name][..., order, :] * (max(order, 1) * mechanism.unit)
                for name in topology.points
                if derivatives[name] >= order
            }
            for order in range(len(coordinates))
        ]

    def coordinates(self, instants: Array) -> list[Array]:
        """y and the derivatives that were solved for, at some of the instants, each (N, size)."""
        return self.solved.coordinates(instants)

    def summed(self, instants: Array) -> tuple[Summed, ...]:
        """Nothing: they were solved for."""
        return ()

    def unsolved(self, instants: Array) -> Array:
        """What the tolerance let Newton's method leave."""
        return self.solved.left[np.searchsorted(self.solved.times, instants)]

    @property
    def work(self) -> Work:
        """What solving took, and the states of each instant."""
        return self.solved.work + Work(
            derivatives_evaluated=self.readout.plan.derivative + 1,
            coordinates_evaluated=sum(3 * (highest + 1) for highest in self.readout.derivatives.values()),
        )


@dataclass(frozen=True)
class StatesOfChain:
    """States summed from a chain of series, at any instants inside it.

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        start: of the chain, s.
        notes: where the chain was not cut as the scene asks.
    """

    readout: Readout
    functions: Mapping[str, TimeFunction]
    chain: Chain
    start: float
    notes: tuple[str, ...] = ()
    dense: bool = True

    @property
    def status(self) -> Status:
        """The solver's."""
        return self.chain.status

    def covered(self, instants: Array) -> Array:
        """Those up to the end of the chain."""
        segments = self.chain.segments
        return instants[instants <= self.chain.stop] if segments else instants[:0]

    def states(self, instants: Array) -> list[dict[str, Array]]:
        """States at instants of shape (N,).

        Raises:
            OutsideMotion: an instant outside the chain, or not a number.
        """
        outside = ~((instants >= self.start) & (instants <= self.chain.stop))
        if outside.any():
            raise OutsideMotion(float(instants[outside][0]), self.start, self.chain.stop)
        points = self.readout.mechanism.topology.points
        states: list[dict[str, Array]] = [{} for _ in range(self.readout.plan.derivative + 1)]
        for order in range(self.readout.derivative_of_every_point + 1):
            states[order] |= self._chassis(len(instants), order)
        for names, derivatives in self._requests:
            columns = [np.concatenate([series[n] for n in names], axis=-1) for series in self._point_series]
            values = evaluate(self.chain, columns, instants, derivatives)
            for order in range(derivatives + 1):
                for i, name in enumerate(names):
                    states[order][name] = values[order, ..., 3 * i : 3 * i + 3]
        return [{name: state[name] for name in points if name in state} for state in states]

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

    def unsolved(self, instants: Array) -> Array:
        """What the tolerance let Newton's method leave at the start of each segment."""
        starts = [segment.start for segment in self.chain.segments]
        left = np.array([np.max(segment.left) for segment in self.chain.segments])
        return left[np.searchsorted(starts, instants, side="right") - 1]

    @property
    def work(self) -> Work:
        """What solving took, and the sums of each instant."""
        return self.chain.work + Work(
            derivatives_evaluated=self.readout.plan.derivative + 1,
            coordinates_evaluated=sum(
                3 * len(names) * (derivatives + 1) for names, derivatives in self._requests
            ),
        )

    @property
    def _requests(self) -> list[tuple[list[str], int]]:
        """Which points to sum to which derivative: all, and then those that need more."""
        topology, highest = self.readout.mechanism.topology, self.readout.derivatives
        moving, every = [*topology.moving, *topology.carried], self.readout.derivative_of_every_point
        requests = [(moving, every)]
        for derivative in range(every + 1, self.readout.plan.derivative + 1):
            if names := [name for name in moving if highest[name] == derivative]:
                requests.append((names, derivative))
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
