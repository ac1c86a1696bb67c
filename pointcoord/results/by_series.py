"""Scenes solved at each of their instants, or by a chain of series in time (by a map: see `by_map`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pointcoord.bounds.summed import Summed
from pointcoord.numerics.arrays import Array
from pointcoord.results.cells import fill_cells
from pointcoord.results.readout import Readout
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.dense_output import SeriesRows, evaluate
from pointcoord.solve.series_in_inputs import InputSeries
from pointcoord.solve.step_rule import last_magnitudes
from pointcoord.solve.taylor import Chain
from pointcoord.time_functions import TimeFunction

if TYPE_CHECKING:
    from pointcoord.solve.pointwise import Solved


@dataclass(frozen=True, eq=False)
class AtInstants(SolvedScene):
    """A scene solved at each of its instants; nothing is known between them.

    Attributes:
        poses: the solved states.
    """

    poses: Solved
    dense: ClassVar[bool] = False

    @classmethod
    def of(cls, readout: Readout, functions: Mapping[str, TimeFunction], solved: Solved) -> AtInstants:
        first, last = solved.times[[0, -1]].tolist() if len(solved.times) else (np.inf, -np.inf)
        return cls(readout, functions, solved.status, solved.work, first, last, (), solved)

    def solved(self, instants: Array, derivatives: int) -> list[Array]:
        return [state.T for state in self.poses.coordinates(instants)[: derivatives + 1]]

    def unsolved(self, instants: Array) -> Array:
        return self.poses.left[np.searchsorted(self.poses.times, instants)]


@dataclass(frozen=True, eq=False)
class ByChain(SolvedScene):
    """A scene, or many designs of it, summed from a chain of series at any instants inside the chain.

    Attributes:
        chain: the chain of series.
    """

    chain: Chain

    @classmethod
    def of(
        cls,
        readout: Readout,
        functions: Mapping[str, TimeFunction],
        chain: Chain,
        notes: tuple[str, ...] = (),
    ) -> ByChain:
        segments = chain.segments
        ends = (segments[0].start, chain.stop) if segments else (np.inf, -np.inf)
        orders = tuple(segment.order for segment in segments)
        return cls(readout, functions, chain.status, chain.work, *ends, orders, chain, notes=notes)

    def solved(self, instants: Array, derivatives: int) -> list[Array]:
        if isinstance(box := self.chain.segments[0], InputSeries):
            coefficients = box.coefficients.swapaxes(-1, -2)
            return [coefficients @ powers for powers in box.powers(instants, derivatives + 1)]
        order = None if (instants[1:] >= instants[:-1]).all() else np.argsort(instants, kind="stable")
        sums = np.empty((*self._series.shape, len(instants)))
        self._series.sum(instants if order is None else instants[order], sums)
        if order is not None:
            sums[..., order] = sums.copy()
        return np.split(sums, self.readout.plan.derivative + 1, axis=-2)[: derivatives + 1]

    @cached_property
    def _series(self) -> SeriesRows:
        unknowns = range(self.readout.mechanism.map.unknowns)
        columns = [segment.coefficients for segment in self.chain.segments]
        return SeriesRows.of(self.chain, columns, [unknowns] * (self.readout.plan.derivative + 1))

    def fill(self, times: Array, rows: Array) -> None:
        """Fill by cells where instants are close; else by blocks."""
        filled = fill_cells(self, self._starts, times, rows)
        edges = np.flatnonzero(np.diff(filled, prepend=True, append=True))
        for first, last in edges.reshape(-1, 2).tolist():
            self.fill_plainly(times[first:last], rows[..., first:last])

    def summed(self, instants: Array) -> list[Summed]:
        tables = []
        for segment in self.chain.segments:
            terms = np.abs(segment.coefficients)
            # Last terms that are missing by chance say nothing about the truncation error: they are
            # extrapolated.
            last = last_magnitudes(segment.coefficients, (segment.stop - segment.start) / segment.scale)
            # The constant term is none of the last two, also in a series of order 0 or 1.
            last[: max(2 - segment.order, 0)] = 0.0
            lasts, before = np.zeros_like(terms), np.zeros_like(terms)
            lasts[-2:], before[-4:-2] = last[-2:], terms[-4:-2]
            tables.append((lasts, before, terms))
        derivative = self.readout.plan.derivative
        parts = (evaluate(self.chain, each, instants, derivative) for each in zip(*tables, strict=True))
        return [Summed(*part) for part in zip(*parts, strict=True)]

    def unsolved(self, instants: Array) -> Array:
        left = np.array([np.max(segment.left) for segment in self.chain.segments])
        return np.asarray(left[np.searchsorted(self._starts, instants, side="right") - 1])

    @cached_property
    def _starts(self) -> Array:
        return np.array([segment.start for segment in self.chain.segments])
