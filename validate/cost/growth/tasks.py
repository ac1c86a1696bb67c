"""What grows: instants of a scene, designs of a car by one `sweep` or one by one, unknowns of a chain.

A design is the car with every moving hardpoint moved at random; its drawing is put together by whoever
solves it. Design number k is the same car in however large a batch.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Designs, Scene, designs_of, sweep
from validate.cost.errors import errors_of, truth_of
from validate.cost.growth.chain import STOP, FourBarChain
from validate.cost.instants import study_instants
from validate.cost.parts.accuracy import made_ready
from validate.cost.race import Found, NoNumbers, Runner
from validate.cost.row import Row
from validate.cost.way import Answer
from validate.cost.ways.registry import ways_named

Array = NDArray[np.float64]

CHECKED = 16  # instants whose numbers are held to the reference, which takes some 5 ms for each
INSTANTS = 101  # of a design
MOVED = 2.0  # mm, at most, along each axis: what a designer tries, and no drawing turns into another one
SEED = 2026
CHAIN_INSTANTS = np.linspace(0.0, STOP, 6)[1:]  # s; the longest chains take a second and more for each
NOT_RIGHT = 1e-3  # of the shortest rocker: an answer that far off is another assembly, or none


@dataclass(frozen=True)
class ManyInstants:
    """A scene to be solved at `size` instants by a way, by its name."""

    scene: Scene
    way: str
    size: int

    @property
    def smallest(self) -> ManyInstants:
        """Two instants."""
        return replace(self, size=2)

    def runner(self, row: Row) -> Runner:
        """The way, and its errors at some instants, the first and the last among them."""
        instants = study_instants(self.scene, self.size)
        (way,) = ways_named([self.way])

        def found(answer: Answer) -> Found:
            places = some_of(self.size, CHECKED)
            return errors_of(_at(answer, places), truth_of(self.scene, instants[places]))

        return Runner(row, partial(made_ready, way, self.scene, row.value, instants), found)


@dataclass(frozen=True)
class ManyDesigns:
    """So many designs of a scene's car, whose positions are solved at `INSTANTS` instants.

    Attributes:
        together: by one sweep, or one by one.
    """

    scene: Scene
    way: str
    together: bool
    size: int

    @property
    def smallest(self) -> ManyDesigns:
        """One design."""
        return replace(self, size=1)

    def runner(self, row: Row) -> Runner:
        """The sweep, or the way for each design; and errors of some designs at some instants."""
        time = self.scene.time.model_copy(update={"samples": INSTANTS})
        scene = self.scene.model_copy(update={"time": time, "tolerance": row.value or self.scene.tolerance})
        instants, designs = scene.instants, drawn_at_random(scene, self.size)

        def found(answers: Callable[[int], Answer]) -> Found:
            places = some_of(len(instants), CHECKED // 4)
            founds = []
            for k in some_of(self.size, CHECKED // 4):
                truth = truth_of(designs.design(k), instants[places])
                founds.append(errors_of(_at(answers(k), places), truth))
            return max(founds, key=lambda one: one.quantities["position"]["error"])

        if self.together:

            def swept() -> Any:
                found = sweep(designs)
                for failure in found.failures.values():
                    raise failure.error
                return lambda k: Answer({"position": {n: x[k] for n, x in found.position.items()}})

            return Runner(row, lambda: swept, found)
        (way,) = ways_named([self.way])
        scenes = [designs.design(k) for k in range(self.size)]

        def prepared() -> Callable[[], Any]:
            runs = [made_ready(way, one, row.value, instants) for one in scenes]
            return lambda: [run() for run in runs].__getitem__

        return Runner(row, prepared, found)


@dataclass(frozen=True)
class LongChain:
    """A chain of four-bars of `size` unknowns, to be solved at `CHAIN_INSTANTS` by a way, by its name."""

    way: str
    size: int

    @property
    def smallest(self) -> LongChain:
        """Two rockers."""
        return replace(self, size=6)

    def runner(self, row: Row) -> Runner:
        """The way, and its errors against the closed form."""
        (way,) = ways_named([self.way])
        scene = FourBarChain.with_unknowns(self.size).scene()
        return Runner(row, partial(made_ready, way, scene, row.value, CHAIN_INSTANTS), self.check)

    def check(self, answer: Answer) -> Found:
        """The error of every tip against the closed form, mm.

        Raises:
            NoNumbers: this is another assembly, or none.
        """
        chain = FourBarChain.with_unknowns(self.size)
        right, places = chain.closed_form(CHAIN_INSTANTS), answer.numbers["position"]
        off = np.abs(np.stack([places[name] for name in chain.tips], axis=1) - right)
        if not (off <= NOT_RIGHT * np.min(np.abs(right[..., 1:]).max(axis=-1))).all():
            worst = np.unravel_index(int(np.argmax(np.where(np.isnan(off), np.inf, off))), off.shape)
            raise NoNumbers(f"tip_{worst[1]} is {off[worst]:.3g} mm from the closed form")
        columns = {
            "error": float(off.max()),
            "rms": float(np.sqrt(np.mean(off**2))),
            "radius": 0.5 * float(np.spacing(np.abs(right)).max()),
            "numbers": off.size,
        }
        return Found({"position": columns})


def drawn_at_random(scene: Scene, count: int) -> Designs:
    """So many designs; the first one is as drawn."""
    drawn = [name for name in scene.mechanism.topology.moving if name in scene.mechanism.points]
    far = np.random.default_rng(SEED).uniform(-MOVED, MOVED, (count, len(drawn), 3))
    far[0] = 0.0
    return designs_of(scene, offsets={name: far[:, i] for i, name in enumerate(drawn)})


def some_of(size: int, most: int = CHECKED) -> Sequence[int]:
    """So many numbers from 0 to size - 1, evenly, both included; all of them if there are fewer."""
    return sorted({int(place) for place in np.linspace(0, size - 1, most)})


def _at(answer: Answer, places: Sequence[int]) -> Answer:
    """The same at some instants."""
    numbers = {q: {n: x[list(places)] for n, x in arrays.items()} for q, arrays in answer.numbers.items()}
    return replace(answer, numbers=numbers)
