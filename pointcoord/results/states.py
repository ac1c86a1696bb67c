"""States of points: from solved coordinates, at the instants of a scene or at any instants of a chain.

Only what the plan of a scene asks for is evaluated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.solved_coordinates import SolvedCoordinates, Summed
from pointcoord.errors import OutsideMotion
from pointcoord.linkage.carried_points import carried_series
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import Readout
from pointcoord.results.table import State, vectors
from pointcoord.solve.dense_output import SeriesRows, evaluate
from pointcoord.solve.status import Status
from pointcoord.solve.taylor import Chain, last_magnitudes
from pointcoord.time_functions import TimeFunction

if TYPE_CHECKING:
    from pointcoord.solve.pointwise import Solved

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

    @property
    def orders(self) -> tuple[int, ...]:
        """Of every series that they are summed from."""
        ...

    @property
    def stop(self) -> float:
        """Up to when they are known, s; minus infinity where they are not at all."""
        ...

    def covered(self, instants: Array) -> Array:
        """Those of a scene's instants at which they are known."""
        ...

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """By time derivative, the states of the points that the plan asks for (see `readout.States`).

        Args:
            instants: shape (N,), s; they do not decrease.
            rows: a table of results or some columns of one, shape (..., height, N). The states that are
                reported are put into their places, and those that are returned may be views of them.
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

    @property
    def orders(self) -> tuple[int, ...]:
        """There are no series."""
        return ()

    @property
    def stop(self) -> float:
        """The last instant that was reached."""
        return float(self.solved.times[-1]) if len(self.solved.times) else -np.inf

    def covered(self, instants: Array) -> Array:
        """Up to the last one that was reached."""
        return instants[: len(self.solved.times)]

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """States at some of the instants."""
        mechanism, derivatives = self.readout.mechanism, self.readout.derivatives
        layout, topology = mechanism.layout, mechanism.topology
        coordinates = self.coordinates(instants, self.readout.plan.derivative)
        taylor = np.stack([state / max(order, 1) for order, state in enumerate(coordinates)], axis=-2)
        places = {name: list(layout.vector(name)) for name in (*topology.chassis, *topology.moving)}
        series = {name: taylor[..., place] for name, place in places.items()}
        for name, carriers in topology.carried.items():
            series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
        states = [
            {
                name: series[name][..., order, :] * (max(order, 1) * mechanism.unit)
                for name in topology.points
                if derivatives.get(name, -1) >= order
            }
            for order in range(len(coordinates))
        ]
        if rows is not None:
            for first, (order, name) in self.readout.table.states:
                vectors(rows, first)[...] = states[order][name]
        return states

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """y and the derivatives that were solved for, at some of the instants, each (N, size)."""
        return self.solved.coordinates(instants)[: derivatives + 1]

    def summed(self, instants: Array) -> tuple[Summed, ...]:
        """Nothing: they were solved for."""
        return ()

    def pieces(self, instants: Array) -> NDArray[np.intp]:
        """There are no series."""
        return np.zeros(len(instants), dtype=np.intp)

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

    @property
    def orders(self) -> tuple[int, ...]:
        """Of each segment."""
        return tuple(segment.order for segment in self.chain.segments)

    @property
    def stop(self) -> float:
        """The end of the chain."""
        return self.chain.stop if self.chain.segments else -np.inf

    def covered(self, instants: Array) -> Array:
        """Those up to the end of the chain."""
        return instants[instants <= self.stop]

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """States at instants of shape (N,) that do not decrease.

        Raises:
            OutsideMotion: an instant outside the chain, or not a number.
        """
        outside = ~((instants >= self.start) & (instants <= self.chain.stop))
        if outside.any():
            raise OutsideMotion(float(instants[outside][0]), self.start, self.chain.stop)
        table, (reported, needed) = self.readout.table, self.series
        batch, count = reported.shape[:-1], len(instants)
        if rows is None:
            rows = np.empty((*batch, table.height, count))
        reported.sum(instants, rows[..., : 3 * len(table.moving), :])
        rows[..., table.first_still :, :] = self.still
        spare = np.empty((*batch, 3 * len(table.spare), count))
        if table.spare:
            needed.sum(instants, spare)
        states: list[dict[str, Array]] = [{} for _ in range(self.readout.plan.derivative + 1)]
        for first, (order, name) in table.states:
            states[order][name] = vectors(rows, first)
        for i, (order, name) in enumerate(table.spare):
            states[order][name] = vectors(spare, 3 * i)
        for i, (order, name) in enumerate(table.spare_still):
            states[order][name] = np.broadcast_to(self._spare_still[..., i, None, :], (*batch, count, 3))
        return states

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """y and the derivatives that the plan solves for, at instants that do not decrease, each (N, size).

        The instants lie side by side in memory.
        """
        mechanism = self.readout.mechanism
        count, unknowns = len(instants), mechanism.map.unknowns
        known = mechanism.known_series({name: f.series(instants, 0) for name, f in self.functions.items()})
        if derivatives == 0:
            y = np.empty((mechanism.map.size, count))
            self._unknowns.sum(instants, y[:unknowns])
            states = y[None]
        else:
            states = np.empty((self.readout.plan.derivative + 1, mechanism.map.size, count))
            self._coordinates.sum(instants, states.reshape(-1, count))
        states[0, unknowns:] = known[..., 0, :].T
        return list(states[: derivatives + 1].swapaxes(-1, -2))

    @cached_property
    def _unknowns(self) -> SeriesRows:
        """The series of the unknown coordinates."""
        pieces = [segment.coefficients for segment in self.chain.segments]
        return SeriesRows.of(self.chain, pieces, [range(self.readout.mechanism.map.unknowns)])

    @cached_property
    def _coordinates(self) -> SeriesRows:
        """The series of all coordinates and of the derivatives that the plan solves for."""
        pieces = [segment.coefficients for segment in self.chain.segments]
        size = range(self.readout.mechanism.map.size)
        return SeriesRows.of(self.chain, pieces, [size] * (self.readout.plan.derivative + 1))

    def summed(self, instants: Array) -> list[Summed]:
        """How `coordinates` sums each derivative at instants."""
        terms = [np.abs(segment.coefficients) for segment in self.chain.segments]
        # Terms that are missing by chance tell nothing of what is left out.
        lasts = [
            last_magnitudes(segment.coefficients, (segment.stop - segment.start) / segment.scale)
            for segment in self.chain.segments
        ]
        derivative = self.readout.plan.derivative

        def sums(first: int, last: int | None, sizes: Sequence[Array]) -> Array:
            """Of the terms from one to another, counted from the end."""
            kept = [np.zeros_like(t) for t in terms]
            for part, whole in zip(kept, sizes, strict=True):
                part[first:last] = whole[first:last]
            return evaluate(self.chain, kept, instants, derivative)

        parts = (sums(-2, None, lasts), sums(-4, -2, terms), sums(0, None, terms))
        return [Summed(*part) for part in zip(*parts, strict=True)]

    def unsolved(self, instants: Array) -> Array:
        """What the tolerance let Newton's method leave at the start of each segment."""
        left = np.array([np.max(segment.left) for segment in self.chain.segments])
        return np.asarray(left[self.pieces(instants)])

    def pieces(self, instants: Array) -> NDArray[np.intp]:
        """Number of the segment of each instant."""
        starts = [segment.start for segment in self.chain.segments]
        return np.asarray(np.searchsorted(starts, instants, side="right") - 1)

    @property
    def work(self) -> Work:
        """What solving took, and the sums of each instant."""
        table = self.readout.table
        return self.chain.work + Work(
            derivatives_evaluated=self.readout.plan.derivative + 1,
            coordinates_evaluated=3 * (len(table.moving) + len(table.spare)),
        )

    @cached_property
    def series(self) -> tuple[SeriesRows, SeriesRows]:
        """The series of solved points that are reported, and those that are only needed, mm."""
        mechanism, table = self.readout.mechanism, self.readout.table
        layout, topology = mechanism.layout, mechanism.topology
        unit = np.asarray(mechanism.unit)[..., None, None]
        columns = []
        for segment in self.chain.segments:
            series = {name: segment.coefficients[..., list(layout.vector(name))] for name in topology.moving}
            for name, carriers in topology.carried.items():
                series[name] = carried_series(mechanism.carrier_weights[name], *(series[c] for c in carriers))
            columns.append(np.concatenate(list(series.values()), axis=-1) * unit)
        first = {name: 3 * i for i, name in enumerate((*topology.moving, *topology.carried))}
        solved, spare = (
            [
                [first[name] + axis for d, name in states if d == derivative for axis in range(3)]
                for derivative in range(self.readout.plan.derivative + 1)
            ]
            for states in (table.moving, table.spare)
        )
        reported = SeriesRows.of(self.chain, columns, solved)
        # Where none is only needed nothing is summed from the second.
        return reported, SeriesRows.of(self.chain, columns, spare) if table.spare else reported

    @cached_property
    def still(self) -> Array:
        """Rows of the chassis points that are reported, (..., rows, 1), mm (see `_standing`)."""
        places = self._standing(self.readout.table.still)
        return places.reshape(*places.shape[:-2], -1, 1)

    @cached_property
    def _spare_still(self) -> Array:
        """Those of the chassis points that are only needed, (..., states, 3)."""
        return self._standing(self.readout.table.spare_still)

    def _standing(self, states: Sequence[State]) -> Array:
        """States of points of the chassis in its frame, where they stand, (..., states, 3), mm."""
        return standing(self.readout.mechanism, states)


def standing(mechanism: Mechanism, states: Sequence[State]) -> Array:
    """States of points of the chassis in its frame, where they stand, (..., states, 3), mm."""
    unit = np.asarray(mechanism.unit)[..., None]
    places = np.zeros((*mechanism.unit.shape, len(states), 3))
    for i, (order, name) in enumerate(states):
        if order == 0:
            places[..., i, :] = mechanism.drawing.vectors[name] * unit
    return places
