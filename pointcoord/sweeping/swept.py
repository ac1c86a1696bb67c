"""Results of many designs: the numbers of the solved designs, and why the other designs failed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.errors import PointcoordError, WrongArgument
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.results.motion import Motion
from pointcoord.results.proof import Proof
from pointcoord.results.samples import Samples
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import simulate
from pointcoord.sweeping.designs import Designs


@dataclass(frozen=True)
class Failure:
    """Why one design has no numbers.

    Attributes:
        design: number of the design.
        reason: a few words without numbers, the same for all designs that fail for this reason.
        error: the error that `simulate` raises, with the instant and the inputs that the motion reached.
    """

    design: int
    reason: str
    error: PointcoordError

    @property
    def instant(self) -> float | None:
        """Instant that the motion of the design reached, s; None if there is no motion."""
        return getattr(self.error, "instant", None)


@dataclass(frozen=True)
class Noted:
    """A note on some designs, in the words for one of them.

    Attributes:
        kind: kind of note; all notes of one kind are merged.
        warns: whether the note is a warning, because it may change the meaning of the numbers.
        count: number of designs with this note.
        design: number of the design that the words describe.
        words: text for that design.
        weight: severity; the words describe the design with the largest weight.
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
        return f"{which} designs, for example design {self.design}: {self.words}"


def merged(notes: Iterable[Noted]) -> tuple[Noted, ...]:
    """One note of each kind, in the order in which the kinds are met."""
    found: dict[str, Noted] = {}
    for note in notes:
        if note.kind not in found:
            found[note.kind] = note
            continue
        one = found[note.kind]
        worst = note if note.weight > one.weight else one
        found[note.kind] = Noted(
            one.kind, one.warns, one.count + note.count, worst.design, worst.words, worst.weight
        )
    return tuple(found.values())


@dataclass(frozen=True, repr=False)
class Sweep(Samples):
    """Designs solved at the instants of their scene, or a block of them.

    Every quantity is an attribute, such as `position`, with the design axis first: of points and bodies
    (D, N, 3), of the car (D, N). The numbers of a design that could not be solved are NaN, and `failures`
    says why. The design at place i has the number first + i.

    Attributes:
        designs: the designs of the whole sweep.
        first: number of the first design of this block.
        varied: values of each coordinate that varies, by coordinate, (D,), mm.
        solved: whether each design could be solved, (D,).
        closing: largest distance by which closing each drawing moves a point, (D,), mm; NaN if a drawing
            cannot be closed.
        drawn: angles of each closed drawing that the scene's effects report, by name, (D,), rad.
        failures: why designs could not be solved, by number.
        notes: notes on the designs, merged by kind.
    """

    designs: Designs
    first: int
    varied: Mapping[str, Array]
    solved: Flags
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
    def numbers_of_designs(self) -> Indices:
        """Number of the design at each place."""
        return np.arange(self.first, self.first + len(self))

    def of(self, number: int) -> Samples:
        """The numbers of one design, as `simulate` gives them.

        Raises:
            WrongArgument: the design is not in this block.
            PointcoordError: the error that stopped the design.
        """
        place = self._place(number)
        if number in self.failures:
            raise self.failures[number].error
        return Samples(self.times, self.each(lambda array, _: array[place]))

    def scene(self, number: int) -> Scene:
        """The scene of one design.

        Raises:
            WrongArgument: the design is not in this block.
            SceneError: the scene of the design cannot be solved.
        """
        self._place(number)
        return self.designs.design(number)

    def motion(self, number: int) -> Motion:
        """The motion of one design, solved again separately, for any instant.

        Raises:
            WrongArgument: the design is not in this block.
            PointcoordError: see `simulate`.
        """
        return simulate(self.scene(number))

    def proof(self, number: int, rates: bool = False) -> Proof:
        """Proven error bounds of one design's numbers at each of the times.

        The design is solved again separately and its poses are proven. The distance between these poses and
        the numbers of the sweep is added to the proven bounds. `expected` is what is expected of the design
        solved separately: series that designs share are cut elsewhere, so at a coarse tolerance the numbers
        of the sweep may be off by more, within that tolerance.

        Raises:
            WrongArgument: the design is not in this block.
            PointcoordError: the design could not be solved.
        """
        samples = self.of(number)
        return self.motion(number).proof_of(samples, rates)

    def _place(self, number: int) -> int:
        if not self.first <= number < self.first + len(self):
            allowed = f"{self.first} to {self.first + len(self) - 1}"
            raise WrongArgument(f"design {number}", "is not in this block", allowed)
        return number - self.first
