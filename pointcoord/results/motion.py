"""A motion: the numbers of a solved scene at its instants, read by name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.errors import NotComputed
from pointcoord.mechanism.freedoms import locked
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.counters import Work
from pointcoord.results.closing import Closing
from pointcoord.results.even_instants import even_instants
from pointcoord.results.named_columns import columns, data_frame, html_table
from pointcoord.results.samples import Samples
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.assembly import Pose
from pointcoord.solve.status import Status

if TYPE_CHECKING:
    from pointcoord.results.proof import Proof


# Rows of a table in a notebook.
SHOWN = 11
# Instants in any order are computed in sorted blocks of this size: 9 MB.
ORDERED = 2**13


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Samples):
    """A solved scene at its own instants, up to the instant at which something stopped the motion.

    A motion can be pickled. The copy can do all that the motion can.

    Attributes:
        method: name of the method that solved the scene: series, map, newton or another.
        status: whether the motion covers the whole scene, and if not, what stopped it.
        start: the assembled pose at the first instant, with its condition number and proven bound.
        closing: how far the points moved as the drawing closed.
        work: work of solving and reading.
        notes: numbers that are not defined, with the reason, and where the scene was not solved as
            requested; empty if there is nothing to note.
        solved: the solved scene that the numbers are read from.
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
        """A table of the numbers of the car, or positions of points if there are none, at some instants."""
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
        """The mechanism's size as a power of two, mm: the unit of its coordinates."""
        return float(self.solved.readout.mechanism.unit)

    def proof(self, rates: bool = False) -> Proof:
        """Proven error bound and condition number of the pose at each of the times.

        Args:
            rates: also prove an error bound of every reported number, rates and angles included
                (`Proof.proven`), and compute the largest error that the method makes if nothing is wrong
                (`Proof.expected`). This takes a few times as long.
        """
        return self.proof_of(self, rates)

    def proof_of(self, samples: Samples, rates: bool = False) -> Proof:
        """Proven error bounds of samples at other instants, from `at` with instants of shape (N,)."""
        # Imported here: most motions are only read, not proven.
        from pointcoord.results.proof import prove

        return prove(self.solved, samples, rates=rates)

    @property
    def height(self) -> int:
        """Count of numbers at an instant: the rows of an array that `at` can write into."""
        return self.solved.readout.table.height

    def at(self, instants: ArrayLike, out: Array | None = None) -> Samples:
        """The numbers of the motion at any instants inside it, without a new solve.

        Args:
            instants: a number or an array of numbers, s.
            out: array of floats of shape (height, number of instants) to write the numbers into. The results
                are views of `out` and change when `out` is written again.
        Returns:
            Arrays of the instants' shape; vectors have a last dimension of 3.
        Raises:
            WrongArgument: an instant before the start, after the stop, or not a number.
            NotComputed: the method knows the motion at the scene's instants only.
            ValueError: `out` has a wrong shape or type, or is read-only.

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
        """The numbers at any number of instants, block by block, with the memory of one block.

        Args:
            instants: a number n for n evenly spaced instants from the first of the motion to its last; or the
                instants themselves, shape (N,), s, in any order; the motion's own unless given.
            size: number of consecutive instants of a block; the last block may have fewer.
        Raises:
            WrongArgument: see `at`; raised at the block that contains the instant.
            NotComputed: instants are given, but the method knows the motion at the scene's instants only.
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
            raise ValueError(f"instants of shape {asked.shape}; allowed: (N,), or a number of instants")
        return (self.at(asked[low : low + size]) for low in range(0, len(asked), size))

    def to_dataframe(self, library: str | None = None) -> Any:
        """The motion as a data frame: a row for each instant, columns with the names and units of the CSV.

        Angles are in degrees, as in every file. Vectors have a column for each component.

        Args:
            library: "pandas" or "polars"; the first that is installed, in this order, unless given.
        Returns:
            A `pandas.DataFrame` or a `polars.DataFrame` that shares no memory with the motion.
        Raises:
            MissingLibrary: the library is not installed; the message names the extra that installs it.
            UnknownName: the library is not one of the two.
        """
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
    """The requested numbers of a solved scene at instants of shape (N,), in any order.

    Args:
        out: array to write the numbers into, shape (rows, N); a new array unless given.
    Raises:
        WrongArgument: an instant that was not solved for, or not a number.
        MechanismError: an equation that was left out, as it followed from others in the drawing, is violated.
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
