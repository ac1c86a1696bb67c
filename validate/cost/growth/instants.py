"""One scene at many instants, by any way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cost.errors import errors_of, truth_of
from validate.cost.instants import study_instants
from validate.cost.row import QuantityError
from validate.cost.way import Ready, Setting, Way
from validate.formulations.protocol import Numbers

Array = NDArray[np.float64]

CHECKED = 16
"""Instants, or designs, whose numbers are held to others; the reference takes some 5 ms for each."""


@dataclass(frozen=True)
class ManyInstants:
    """A scene to be solved at `size` instants by a way."""

    scene: Scene
    way: Way
    setting: Setting
    size: int

    @property
    def smallest(self) -> ManyInstants:
        """Two instants."""
        return replace(self, size=2)

    def give(self) -> None:
        """Nothing: a grid of instants costs less than anything that is done with it."""

    def prepare(self) -> ReadyRun:
        """The way's set-up."""
        return ReadyRun(self.way.prepare(self.scene, self.setting), study_instants(self.scene, self.size))

    def check(self, output: Numbers) -> Mapping[str, QuantityError]:
        """Errors at some instants, the first and the last among them, against the reference.

        Raises:
            NoNumbers: a number is none, or missing.
            NoReferenceError: there is no reference.
        """
        places = some_of(self.size)
        some = {
            quantity: {name: array[places] for name, array in arrays.items()}
            for quantity, arrays in output.items()
        }
        errors, _ = errors_of(some, truth_of(self.scene, study_instants(self.scene, self.size)[places]))
        return errors


@dataclass(frozen=True)
class ReadyRun:
    """A scene that a way made ready, with the instants to solve it at."""

    ready: Ready
    instants: Array

    def solve(self) -> Any:
        """The positions."""
        return self.ready.solve(self.instants)

    def rates(self, solved: Any) -> Any:
        """The rates that the scene asks for."""
        return self.ready.rates(solved)

    def output(self, solved: Any) -> Numbers:
        """Arrays by quantity and name."""
        return self.ready.output(solved)

    def counts(self, solved: Any) -> Mapping[str, int]:
        """The way's own."""
        return self.ready.counts(solved)


def some_of(size: int) -> list[int]:
    """`CHECKED` numbers from 0 to size - 1, evenly, both included; all of them if there are fewer."""
    return sorted({int(place) for place in np.linspace(0, size - 1, CHECKED)})
