"""What became of many designs: the numbers of those that were solved, and why the others were not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import PointcoordError, WrongArgument
from pointcoord.results.motion import Motion
from pointcoord.results.proof import Proof
from pointcoord.results.samples import Samples
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import simulate
from pointcoord.sweeping.designs import Designs

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Failure:
    """Why one design has no numbers.

    Attributes:
        design: its number.
        reason: in a few words that are the same for all designs with this reason.
        error: what `simulate` says of it, with the instant and the inputs that it reached if it moved.
    """

    design: int
    reason: str
    error: PointcoordError

    @property
    def instant(self) -> float | None:
        """How far its motion came, s; None if it has none."""
        return getattr(self.error, "instant", None)


@dataclass(frozen=True)
class Noted:
    """Something that should be known of some designs, told of one of them.

    Attributes:
        kind: of what; one note is made of each kind.
        warns: whether it may change what the numbers mean.
        count: of how many designs it is true. design: the number of one of them.
        words: what is true of that one.
        weight: how much; the design with the largest is told.
    """

    kind: str
    warns: bool
    count: int
    design: int
    words: str
    weight: float = 0.0

    def told(self, total: int) -> str:
        if self.count == total == 1:
            return self.words
        which = "all" if self.count == total else f"{self.count} of {total}"
        return f"{which} designs, for one design {self.design}: {self.words}"


def merged(notes: Iterable[Noted]) -> tuple[Noted, ...]:
    """One note of each kind, in the order in which the kinds are met."""
    found: dict[str, Noted] = {}
    for note in notes:
        if note.kind not in found:
            found[note.kind] = note
            continue
        one = found[note.kind]
        told = note if note.weight > one.weight else one
        found[note.kind] = Noted(
            one.kind, one.warns, one.count + note.count, told.design, told.words, told.weight
        )
    return tuple(found.values())


@dataclass(frozen=True, repr=False)
class Sweep(Samples):
    """Designs solved at the instants of their scene, or a block of them.

    Every quantity is an attribute, such as `position`, with the design axis first: of points and bodies
    (D, N, 3), of the car (D, N). The numbers of a design that could not be solved are NaN, and `failures`
    says why. The design at place i has the number first + i.

    Attributes:
        designs: what was asked for.
        first: number of the first design.
        varied: by coordinate, where each design draws it, (D,), mm.
        solved: whether each design could be solved, (D,).
        closing: how far closing each drawing moves a point at most, (D,), mm; NaN if it cannot be closed.
        drawn: by name, the angles that the scene asks for in each closed drawing, (D,), rad.
        failures: of the designs that could not be solved, by number.
        notes: what should be known of designs, gathered.
    """

    designs: Designs
    first: int
    varied: Mapping[str, Array]
    solved: NDArray[np.bool_]
    closing: Array
    drawn: Mapping[str, Array]
    failures: Mapping[int, Failure]
    notes: tuple[Noted, ...]

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"<Sweep of {len(self)} designs{failed}: {self._span}; {self._quantities}>"

    def __len__(self) -> int:
        return len(self.solved)

    @property
    def numbers_of_designs(self) -> NDArray[np.intp]:
        """Of each place, the number of its design."""
        return np.arange(self.first, self.first + len(self))

    def of(self, number: int) -> Samples:
        """The numbers of one design, as `simulate` gives them.

        Raises:
            WrongArgument: it is none of these.
            PointcoordError: it could not be solved; what stopped it.
        """
        place = self._place(number)
        if number in self.failures:
            raise self.failures[number].error
        return Samples(self.times, self.each(lambda array, _: array[place]))

    def scene(self, number: int) -> Scene:
        """The scene of one design.

        Raises:
            WrongArgument: it is none of these.
            SceneError: it is no scene that could be solved.
        """
        self._place(number)
        return self.designs.design(number)

    def motion(self, number: int) -> Motion:
        """The design solved once more by itself, dense in time.

        Raises:
            WrongArgument: it is none of these.
            PointcoordError: as `simulate`.
        """
        return simulate(self.scene(number))

    def proof(self, number: int, rates: bool = False) -> Proof:
        """Proven error bounds of one design's numbers at each of the times.

        The design is solved once more by itself, its poses are proven, and how far the numbers of the sweep
        lie from them is measured and added.

        Raises:
            WrongArgument: it is none of these.
            PointcoordError: it could not be solved.
        """
        samples = self.of(number)
        return self.motion(number).proof_of(samples, rates)

    def _place(self, number: int) -> int:
        if not self.first <= number < self.first + len(self):
            allowed = f"{self.first} to {self.first + len(self) - 1}"
            raise WrongArgument(f"design {number}", "is none of these", allowed)
        return number - self.first
