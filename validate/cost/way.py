"""What a way to solve a scene is to the study of cost: a name, its settings, and work in separate phases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.formulations.protocol import Numbers

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Setting:
    """How a way is told to solve.

    Attributes:
        words: in tables, such as `1e-9 mm`; empty where a way has nothing to set.
        value: the number that is dialled, None where there is none.
    """

    words: str = ""
    value: float | None = None


class LeftOut(Exception):
    """A way does not apply to a scene, as the paper's formulas not to a double wishbone; says why in words.

    It is no failure: the row says that it was left out.
    """


class Ready(Protocol):
    """A scene made ready by a way, which is the set-up. Its phases follow each other, timed apart."""

    def solve(self, instants: Array) -> Any:
        """Find the positions at increasing instants, (N,), s; the first may lie after the scene's start."""
        ...

    def rates(self, solved: Any) -> Any:
        """Add the rates to what `solve` returned; the same again where the way gives positions only."""
        ...

    def output(self, solved: Any) -> Numbers:
        """What was computed as arrays by quantity and name, in the scene's axes and units."""
        ...

    def counts(self, solved: Any) -> Mapping[str, int]:
        """What was done: factorisations, newton_steps, jacobians, residuals, series_orders, segments."""
        ...


class Way(Protocol):
    """A way to solve scenes. Adding one is one object with these members and one line of the registry."""

    @property
    def name(self) -> str:
        """On the command line and in tables, such as `series`."""
        ...

    @property
    def words(self) -> str:
        """What it is, in a line."""
        ...

    @property
    def package(self) -> str | None:
        """The optional package that it needs, by the name that it is imported with; None if there is none."""
        ...

    @property
    def settings(self) -> tuple[Setting, ...]:
        """Those that are measured, the coarsest first."""
        ...

    @property
    def dense(self) -> bool:
        """Whether one solve serves any instant, so that more instants cost their evaluation only."""
        ...

    def prepare(self, scene: Scene, setting: Setting) -> Ready:
        """Make a scene ready. The scene's own instants mean nothing here.

        Raises:
            LeftOut: the way does not apply to the scene.
            Exception: whatever the way refuses a scene with; it becomes the row's reason.
        """
        ...
