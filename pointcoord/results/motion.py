"""A solved scene, read by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.bounds.proof import Proof
from pointcoord.errors import NotComputed
from pointcoord.numerics.counters import Work
from pointcoord.results.closing import Closing
from pointcoord.results.samples import Samples
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.assembly import Pose
from pointcoord.solve.status import Status

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Motion(Samples):
    """A solved scene at its own instants, or at those before something stopped it.

    It can be pickled, with all that it can still be asked for.

    Attributes:
        method: how it was solved: series, newton or another method's name.
        status: whether it covers the whole scene, and if not, what stopped it.
        start: the assembled pose at the first instant, with its condition number and proven bound.
        closing: how far the drawing's points moved to close.
        work: what it cost.
        notes: numbers that have no meaning, and why, and where it was not solved as the scene asks; empty
            if there is nothing to note.
        solved: what it is read from.
    """

    method: str
    status: Status
    start: Pose
    closing: Closing
    work: Work
    notes: tuple[str, ...]
    solved: SolvedScene

    def __repr__(self) -> str:
        count = len(self.notes)
        noted = f"; {count} note{'s' if count > 1 else ''}" if count else ""
        part = "" if self.status.complete else "part of a "
        return f"<{part}Motion by {self.method}: {self._span}; {self._quantities}{noted}>"

    @property
    def unit(self) -> float:
        """The mechanism's size as a power of two, mm; scales of its coordinates."""
        return float(self.solved.readout.mechanism.unit)

    def proof(self, rates: bool = False) -> Proof:
        """Proven error bound and condition number of the pose at each of the times.

        Args:
            rates: prove every reported number by itself, rates and angles too (`Proof.proven`), and say what
                the method loses at most where nothing is wrong (`Proof.expected`); takes some times as long.
        """
        return self.proof_of(self, rates)

    def proof_of(self, samples: Samples, rates: bool = False) -> Proof:
        """The same of samples at other instants, as `at` gives them for instants of shape (N,)."""
        return self.solved.proof(samples, rates=rates)

    def at(self, instants: ArrayLike) -> Samples:
        """The same results at any instants inside the motion, without a new solve.

        Args:
            instants: a number or an array of them, s.
        Returns:
            Arrays of the instants' shape, vectors with a last dimension of 3.
        Raises:
            OutsideMotion: an instant before the start, after the stop, or not a number.
            NotComputed: the method knows the motion at the scene's instants only.
        """
        if not self.solved.states.dense:
            raise NotComputed(
                f"a motion between its instants, by the method {self.method!r},",
                "",
                "solve the scene by the method 'series'",
            )
        asked = np.asarray(instants, dtype=float)
        samples = self.solved.samples(asked.ravel())
        return samples if asked.ndim == 1 else samples.shaped(asked.shape)
