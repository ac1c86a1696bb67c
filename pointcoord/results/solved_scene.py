"""A scene whose linkage is solved: read at instants, and proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pointcoord.results.readout import BLOCK, Readout
from pointcoord.results.samples import Samples
from pointcoord.results.states import SolvedStates
from pointcoord.time_functions import TimeFunction

if TYPE_CHECKING:
    from pointcoord.bounds.proof import Proof
    from pointcoord.bounds.reported_bounds import Reported

Array = NDArray[np.float64]

# Instants in any order are sorted this many at a time, which takes 24 MB.
SORTED = 2**20


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
        """
        readout = self.readout
        rows = (
            np.empty((*readout.mechanism.drawn.shape[:-1], readout.table.height, len(times)))
            if out is None
            else out
        )
        for low in range(0, len(times), SORTED):
            self._fill(times[low : low + SORTED], rows[..., low : low + SORTED])
        return readout.named(times, rows)

    def _fill(self, times: Array, rows: Array) -> None:
        order = None if (times[1:] >= times[:-1]).all() else np.argsort(times, kind="stable")
        for low in range(0, len(times), BLOCK):
            high = min(low + BLOCK, len(times))
            if order is None:
                self._fill_block(times[low:high], rows[..., low:high])
            else:
                block = np.empty((*rows.shape[:-1], high - low))
                self._fill_block(times[order[low:high]], block)
                rows[..., order[low:high]] = block

    def _fill_block(self, times: Array, rows: Array) -> None:
        self.readout.complete(times, self.states.states(times, rows), rows)

    def doubts(self, times: Array) -> dict[str, Array]:
        """How far the computed value of each law may be from the law's own, each (N,), rad or mm."""
        return {name: function.rounding(times) for name, function in self.functions.items()}

    def proof(
        self, samples: Samples, *, rates: bool = False, doubts: Mapping[str, Array] | None = None
    ) -> Proof:
        """What is proven at each of the samples' times.

        Args:
            rates: every number by itself.
            doubts: how far the laws' values may be off, where another answer than that of `doubts` is wanted.
        """
        # What proves is imported where it is asked for, as most motions are read only.
        from pointcoord.bounds.proof import prove

        mechanism, chassis, times = self.readout.mechanism, self.readout.chassis, samples.times
        added = self.readout.offset(times)
        return prove(
            mechanism,
            times,
            self.states,
            samples.position,
            np.broadcast_to(0.0 if added is None else added, (len(times), 3)),
            chassis.rounding(times, mechanism.origin),
            self.doubts(times) if doubts is None else doubts,
            self._reported(samples) if rates else None,
        )

    def _reported(self, samples: Samples) -> Reported:
        """All numbers of samples, and what went into them beside the coordinates."""
        from pointcoord.bounds.reported_bounds import Reported

        readout = self.readout
        return Reported(
            numbers=samples.numbers,
            effects=readout.plan.computed,
            axes=readout.axes,
            chassis=readout.chassis,
            laws=self.functions,
            solved=self.states,
        )
