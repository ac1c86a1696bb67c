"""Ways whose errors and times are known, and the clock that they move."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cost.errors import truth_of
from validate.cost.way import Ready, Setting
from validate.formulations.protocol import Numbers

Array = NDArray[np.float64]


@dataclass
class FakeClock:
    """A clock that stands still but for those who move it; nanoseconds."""

    now: int = 0
    reads: int = 0

    def __call__(self) -> int:
        self.reads += 1
        return self.now

    def advance(self, nanoseconds: int) -> None:
        self.now += nanoseconds


def nothing(*_: object) -> None:
    """Do nothing."""


@dataclass
class Toy:
    """The reference, rounded, and off by what is asked for.

    Attributes:
        clock: that its phases move. costs: by phase, nanoseconds; of `solve` for each instant.
        spoil: changes its numbers. before: is called with the name of each phase.
        runs: what was run: the number of instants of each solve.
    """

    name: str
    clock: FakeClock = field(default_factory=FakeClock)
    costs: Mapping[str, int] = field(default_factory=lambda: {"set-up": 20_000_000})
    settings: tuple[Setting, ...] = (Setting(),)
    spoil: Callable[[dict[str, dict[str, Array]]], object] = nothing
    before: Callable[[str], object] = nothing
    words: str = "a toy"
    package: str | None = None
    dense: bool = False
    runs: list[int] = field(default_factory=list)
    collecting: list[bool] = field(default_factory=list)

    def spend(self, phase: str, times: int = 1) -> None:
        self.before(phase)
        self.collecting.append(gc.isenabled())
        self.clock.advance(self.costs.get(phase, 0) * times)

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        self.spend("set-up")
        return _ToyReady(self, scene)


@dataclass
class _ToyReady:
    toy: Toy
    scene: Scene

    def solve(self, instants: Array) -> Any:
        self.toy.runs.append(len(instants))
        self.toy.spend("solve", len(instants))
        return instants

    def rates(self, solved: Any) -> Any:
        self.toy.spend("rates")
        return solved

    def output(self, solved: Any) -> Numbers:
        self.toy.spend("output")
        numbers = reference_numbers(self.scene, solved)
        self.toy.spoil(numbers)
        return numbers

    def counts(self, solved: Any) -> Mapping[str, int]:
        return {"newton_steps": 3 * len(solved)}


_KNOWN: dict[tuple[str, bytes], dict[str, dict[str, Array]]] = {}


def reference_numbers(scene: Scene, instants: Array) -> dict[str, dict[str, Array]]:
    """The reference rounded to doubles; solved once."""
    key = (scene.model_dump_json(), instants.tobytes())
    if key not in _KNOWN:
        exact = truth_of(scene, instants).exact
        _KNOWN[key] = {q: {name: x.high for name, x in names.items()} for q, names in exact.items()}
    return {q: {name: array.copy() for name, array in names.items()} for q, names in _KNOWN[key].items()}
