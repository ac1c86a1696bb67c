"""Scenes solved at each of their instants, or by a chain of series in time (by a map: see `by_map`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pointcoord.bounds.summed import Summed
from pointcoord.numerics.arrays import Array, Indices
from pointcoord.results.readout import ENOUGH, Readout
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.dense_output import SeriesRows, evaluate
from pointcoord.solve.series_in_inputs import InputSeries
from pointcoord.solve.step_rule import last_magnitudes
from pointcoord.solve.taylor import Chain
from pointcoord.time_functions import TimeFunction

if TYPE_CHECKING:
    from pointcoord.results.cells import CloseInstants
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
        return [state.T for state in self.coordinates(instants, derivatives)]

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        return self.poses.coordinates(instants)[: derivatives + 1]

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
        sums = np.empty((*self._series.shape, len(instants)))
        self._series.sum(instants, sums)
        return np.split(sums, self.readout.plan.derivative + 1, axis=-2)[: derivatives + 1]

    @cached_property
    def _series(self) -> SeriesRows:
        columns = [segment.coefficients[..., : self._count] for segment in self.chain.segments]
        orders = range(self.readout.plan.derivative + 1)
        return SeriesRows.of(self.chain, columns, [range(self._count)] * len(orders))

    @property
    def _count(self) -> int:
        return self.readout.mechanism.map.unknowns

    def fill(self, times: Array, rows: Array) -> None:
        """Fill by cells where instants are close and one car's chassis does not rotate; else by blocks."""
        left, one = [(0, len(times))], self.readout.mechanism.drawn.ndim == 1
        if one and len(times) >= ENOUGH and not self.readout.chassis.turning:
            left = self._close.fill(times, rows)
        for first, last in left:
            self.fill_plainly(times[first:last], rows[..., first:last])

    @cached_property
    def _close(self) -> CloseInstants:
        # Imported here: few motions are read at many instants close together.
        from pointcoord.results.cells import CloseInstants

        return CloseInstants(self, self.chain)

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """Sums of the series; (designs, N, size) for many designs. The instants are contiguous in memory."""
        mechanism, segments = self.readout.mechanism, self.chain.segments
        wanted = min(derivatives, self.readout.plan.derivative)
        unknowns, known = mechanism.map.unknowns, self._known(instants)
        if isinstance(box := segments[0], InputSeries):
            size = unknowns + known.shape[-1]
            found = [np.zeros((len(box.coefficients), len(instants), size)) for _ in range(wanted + 1)]
            for each, powers in zip(found, box.powers(instants, wanted + 1), strict=True):
                each[..., :unknowns] = powers.T @ box.coefficients
        else:
            found = list(evaluate(self.chain, [s.coefficients for s in segments], instants, wanted))
        found[0][..., unknowns:] = known
        return found

    def _known(self, instants: Array) -> Array:
        mechanism = self.readout.mechanism
        laws = {name: law.series(instants, 0) for name, law in self.functions.items()}
        if mechanism.drawn.ndim == 1:
            return mechanism.known_series(laws)[:, 0]
        # One car for each pose: all designs have the same laws.
        cars, count = len(mechanism.drawn), len(instants)
        each = mechanism.taken(np.repeat(np.arange(cars), count))
        known = each.known_series({name: np.tile(law, (cars, 1)) for name, law in laws.items()})
        return known[:, 0].reshape(cars, count, -1)

    def summed(self, instants: Array) -> list[Summed]:
        terms = [np.abs(segment.coefficients) for segment in self.chain.segments]
        # Last terms that are missing by chance say nothing about the truncation error: they are extrapolated.
        lasts = [
            last_magnitudes(segment.coefficients, (segment.stop - segment.start) / segment.scale)
            for segment in self.chain.segments
        ]
        for segment, last in zip(self.chain.segments, lasts, strict=True):
            # The constant term is none of the last two, also in a series of order 0 or 1.
            last[: max(2 - segment.order, 0)] = 0.0
        derivative = self.readout.plan.derivative

        def sums(first: int, last: int | None, sizes: Sequence[Array]) -> Array:
            """Sums of the terms from number `first` to before `last`; negative numbers count from the end."""
            kept = [np.zeros_like(t) for t in terms]
            for part, whole in zip(kept, sizes, strict=True):
                part[first:last] = whole[first:last]
            return evaluate(self.chain, kept, instants, derivative)

        parts = (sums(-2, None, lasts), sums(-4, -2, terms), sums(0, None, terms))
        return [Summed(*part) for part in zip(*parts, strict=True)]

    def unsolved(self, instants: Array) -> Array:
        left = np.array([np.max(segment.left) for segment in self.chain.segments])
        return np.asarray(left[self.pieces(instants)])

    def pieces(self, instants: Array) -> Indices:
        starts = [segment.start for segment in self.chain.segments]
        return np.asarray(np.searchsorted(starts, instants, side="right") - 1)
