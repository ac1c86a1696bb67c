"""A solved scene, read by name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.errors import NotComputed
from pointcoord.mechanism.freedoms import locked
from pointcoord.numerics.counters import Work
from pointcoord.results.closing import Closing
from pointcoord.results.even_instants import even_instants
from pointcoord.results.samples import Samples
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.assembly import Pose
from pointcoord.solve.status import Status

if TYPE_CHECKING:
    from pointcoord.results.proof import Proof

Array = NDArray[np.float64]

# Rows of a table in a notebook.
SHOWN = 11
# Of instants in any order, how many are computed before they are put where they belong: 9 MB of them.
ORDERED = 2**13


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Samples):
    """A solved scene at its own instants, or at those before something stopped it.

    It can be pickled, with all that it can still be asked for.

    Attributes:
        method: how it was solved: series, map, newton or another method's name.
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

    def _repr_html_(self) -> str:
        """Numbers of the car, or places of points where it has none, at some of the instants."""
        # Imported here: only notebooks ask for it.
        from pointcoord.results.named_columns import columns, html_table

        picked = np.unique(
            np.linspace(0, len(self.times) - 1, min(SHOWN, len(self.times))).round().astype(int)
        )
        of_the_car = {
            name for name, channel in self.numbers.items() if channel.quantity.of == "car" and channel
        }
        wanted = ("time", *(of_the_car or ("position",)))
        found = {
            name: each[picked] for name, each in columns(self) if name.split(".")[0].split(" ")[0] in wanted
        }
        rows = ([f"{value:.7g}" for value in row] for row in zip(*found.values(), strict=True))
        return html_table(repr(self), found, rows)

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
        # What proves is imported where it is asked for, as most motions are read only.
        from pointcoord.results.proof import prove

        return prove(self.solved, samples, rates=rates)

    @property
    def height(self) -> int:
        """How many numbers there are at an instant: rows of an array that `at` can write into."""
        return self.solved.readout.table.height

    def at(self, instants: ArrayLike, out: Array | None = None) -> Samples:
        """The same results at any instants inside the motion, without a new solve.

        Args:
            instants: a number or an array of them, s.
            out: an array of floats of shape (height, number of instants) that the numbers are written into;
                the results are views of it, and change when it is written again.
        Returns:
            Arrays of the instants' shape, vectors with a last dimension of 3.
        Raises:
            WrongArgument: an instant before the start, after the stop, or not a number.
            NotComputed: the method knows the motion at the scene's instants only.
            ValueError: `out` is no such array.

        >>> from pointcoord import Scene, simulate
        >>> motion = simulate(Scene.load("steer"))
        >>> motion.at([0.1, 0.2]).position["wheel_centre"].shape
        (2, 3)
        """
        self._require_dense()
        asked = np.asarray(instants, dtype=float)
        if out is not None:
            self._require_room(out, asked.size)
        samples = read(self.solved, asked.ravel(), out)
        return samples if asked.ndim == 1 else samples.shaped(asked.shape)

    def blocks(self, instants: ArrayLike | int | None = None, size: int = 16384) -> Iterator[Samples]:
        """The same results in blocks of consecutive instants: any number of them, in a block's memory.

        Args:
            instants: a number n for n instants evenly from the first of the motion to its last, as a scene
                has them; or the instants themselves, shape (N,), s, in any order; the motion's own if not
                given.
            size: how many instants a block has; the last may have fewer.
        Raises:
            WrongArgument: as `at`, at the block that has the instant.
            NotComputed: instants are given, and the method knows the motion at the scene's only.
            ValueError: a number below 1, or instants of another shape.

        >>> from pointcoord import Scene, simulate
        >>> motion = simulate(Scene.load("steer"))
        >>> max(float(block.wheel["camber"].max()) for block in motion.blocks(100_000)) < 0.01
        True
        """
        if size < 1:
            raise ValueError(f"a block of {size} instants; allowed: 1 or more")
        if instants is None:
            return (self.part(low, low + size) for low in range(0, len(self.times), size))
        self._require_dense()
        if isinstance(instants, int | np.integer):
            if instants < 1:
                raise ValueError(f"{instants} instants; allowed: 1 or more")
            count, ends = int(instants), (float(self.times[0]), float(self.times[-1]))
            return (
                self.at(even_instants(*ends, count, low, min(low + size, count)))
                for low in range(0, count, size)
            )
        asked = np.asarray(instants, dtype=float)
        if asked.ndim != 1:
            raise ValueError(f"instants of shape {asked.shape}; allowed: (N,), or how many")
        return (self.at(asked[low : low + size]) for low in range(0, len(asked), size))

    def to_dataframe(self, library: str | None = None) -> Any:
        """The motion as a data frame: a row for each instant, columns with the names and units of the CSV.

        Angles are in degrees there, as in every file; vectors have a column for each component.

        Args:
            library: "pandas" or "polars"; the one that is installed if not given, pandas before polars.
        Returns:
            A `pandas.DataFrame` or a `polars.DataFrame` that shares nothing with the motion.
        Raises:
            MissingLibrary: it is not installed; the message names the extra that brings it.
            UnknownName: there is no such library.
        """
        # Imported here: the solver needs no data frames.
        from pointcoord.results.named_columns import data_frame

        return data_frame(self, library)

    def _require_dense(self) -> None:
        if not self.solved.dense:
            raise NotComputed(
                f"a motion between its instants, by the method {self.method!r},",
                "",
                "solve the scene by the method 'series'",
            )

    def _require_room(self, out: Array, count: int) -> None:
        wanted = (self.height, count)
        if out.shape != wanted or out.dtype != np.float64 or not out.flags.writeable:
            raise ValueError(
                f"out is {'writeable' if out.flags.writeable else 'read-only'}, of {out.dtype} and of shape "
                f"{out.shape}; allowed: a writeable array of float64 and of shape {wanted}"
            )


def read(solved: SolvedScene, times: Array, out: Array | None = None) -> Samples:
    """What a solved scene asks for at instants of shape (N,), in any order.

    Args:
        out: where the numbers go, shape (rows, N); a new array if not given.
    Raises:
        WrongArgument: an instant that was not solved for, or not a number.
        MechanismError: a row that was left out, as it followed from others at the drawing, is violated.
    """
    readout = solved.readout
    rows = readout.room(len(times)) if out is None else out
    if (times[1:] >= times[:-1]).all():
        solved.fill(times, rows)
    else:
        order, room = np.argsort(times, kind="stable"), readout.room(min(ORDERED, len(times)))
        for low in range(0, len(times), ORDERED):
            places = order[low : low + ORDERED]
            block = room[..., : len(places)]
            solved.fill(times[places], block)
            rows[..., places] = block
    samples = readout.table.named(times, rows)
    if readout.mechanism.topology.left_out:
        from pointcoord.results.proof import prove

        off = prove(solved, samples).pose_bound / readout.mechanism.unit
        for error in locked(readout.mechanism, solved.coordinates(times, 0)[0], off).values():
            raise error
    return samples
