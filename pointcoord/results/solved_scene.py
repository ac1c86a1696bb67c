"""A scene whose linkage is solved: read at instants, and proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pointcoord.mechanism.freedoms import held_rows
from pointcoord.results.cells import CloseInstants
from pointcoord.results.readout import BLOCK, Readout
from pointcoord.results.samples import Samples
from pointcoord.results.states import SolvedStates, StatesOfChain
from pointcoord.time_functions import TimeFunction

if TYPE_CHECKING:
    from pointcoord.bounds.proof import Proof, Reported

Array = NDArray[np.float64]

# Instants in any order are sorted this many at a time, which takes 24 MB.
SORTED = 2**20
# Of those, how many are computed before they are put where they belong: 13 MB of them.
ORDERED = 2**14


@dataclass(frozen=True)
class SolvedScene:
    """What a motion is read from.

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        states: of its points, and its coordinates, as they were solved for.
    """

    readout: Readout
    functions: Mapping[str, TimeFunction]
    states: SolvedStates

    def samples(self, times: Array, out: Array | None = None) -> Samples:
        """What the scene asks for at instants of shape (N,), in any order.

        Args:
            out: where the numbers go, shape (rows, N); a new array if not given.
        Raises:
            OutsideMotion: an instant that was not solved for, or not a number.
            MechanismError: a row that was left out, as it followed from others at the drawing, is violated.
        """
        readout = self.readout
        rows = (
            np.empty((*readout.mechanism.drawn.shape[:-1], readout.table.height, len(times)))
            if out is None
            else out
        )
        for low in range(0, len(times), SORTED):
            self._fill(times[low : low + SORTED], rows[..., low : low + SORTED])
        samples = readout.named(times, rows)
        if readout.mechanism.topology.left_out:
            off = self.proof(samples).pose_bound / readout.mechanism.unit
            held_rows(readout.mechanism, self.states.coordinates(samples.times, 0)[0], off)
        return samples

    def _fill(self, times: Array, rows: Array) -> None:
        if (times[1:] >= times[:-1]).all():
            self._fill_ordered(times, rows)
            return
        order = np.argsort(times, kind="stable")
        room = np.empty((*rows.shape[:-1], min(ORDERED, len(times))))
        for low in range(0, len(times), ORDERED):
            places = order[low : low + ORDERED]
            block = room[..., : len(places)]
            self._fill_ordered(times[places], block)
            rows[..., places] = block

    def _fill_ordered(self, times: Array, rows: Array) -> None:
        stretches = [(0, len(times))] if self._close is None else self._close.fill(times, rows)
        for first, last in stretches:
            for low in range(first, last, BLOCK):
                here = slice(low, min(low + BLOCK, last))
                self._fill_block(times[here], rows[..., here])

    @cached_property
    def _close(self) -> CloseInstants | None:
        """What fills a table where instants lie close together; none of a batch, or of single poses, or of a
        car that turns, whose states are no sums of series and laws.
        """
        single = self.readout.mechanism.drawn.ndim == 1 and not self.readout.chassis.turns
        if isinstance(self.states, StatesOfChain) and single:
            return CloseInstants(self.readout, self.states)
        return None

    def _fill_block(self, times: Array, rows: Array) -> None:
        def coordinates() -> Array:
            return self.states.coordinates(times, 0)[0]

        self.readout.complete(times, self.states.states(times, rows), rows, coordinates)

    def doubts(self, times: Array) -> dict[str, Array]:
        """How far the computed value of each law may be from the law's own, each (N,), rad or mm."""
        return {name: function.rounding(times) for name, function in self.functions.items()}

    def proof(self, samples: Samples, *, rates: bool = False, certain: bool = False) -> Proof:
        """What is proven at each of the samples' times.

        Args:
            rates: every number by itself.
            certain: as if the laws' values were exact as they are computed.
        """
        # What proves is imported where it is asked for, as most motions are read only.
        from pointcoord.bounds.proof import prove

        reported = self._reported(samples)
        return prove(self.readout.mechanism, samples.times, reported, rates=rates, certain=certain)

    def _reported(self, samples: Samples) -> Reported:
        """All numbers of samples, and what went into them beside the coordinates."""
        from pointcoord.bounds.proof import Reported

        readout = self.readout
        return Reported(
            numbers=samples.numbers,
            effects=readout.plan.computed,
            axes=readout.axes,
            chassis=readout.chassis,
            laws=self.functions,
            solved=self.states,
        )
