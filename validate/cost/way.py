"""What a way to solve a scene is to the study: a name, its settings, and a function."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.formulations.protocol import Numbers

Array = NDArray[np.float64]

DIGITS = tuple(10.0**-digits for digits in range(2, 14))


def power(number: float) -> str:
    """A number with one digit, such as 1e-9."""
    mantissa, exponent = f"{number:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


@dataclass(frozen=True)
class Answer:
    """What a way computed, by quantity and name, in the scene's axes and units, and what it did for that."""

    numbers: Numbers
    work: Mapping[str, int] = field(default_factory=dict)


Solve = Callable[[Array], Answer]
"""Solves at increasing instants, (N,), s; the first may lie after the scene's start."""


def laws_at(scene: Scene, instants: Array) -> dict[str, Array]:
    """Value, rate and acceleration of every input, (N, 3), rad or mm, and s."""
    return {name: law.series(instants, 2) * (1.0, 1.0, 2.0) for name, law in scene.functions.items()}


@dataclass(frozen=True)
class Way:
    """A way to solve scenes. Adding one is a file with one of these, and a line of the registry.

    Attributes:
        name: on the command line and in tables. words: what it is, in a line.
        prepare: makes a scene ready for the value of a setting, which is the set-up. It raises whatever the
            way refuses a scene with. The scene's own instants mean nothing here; what it asks for does.
        values: of the setting, the coarsest first; None where there is nothing to set.
        setting: a value in words.
        dense: whether one solve serves any instant, so that more instants cost their evaluation only.
        package: an optional one that it needs, by the name that it is imported with.
    """

    name: str
    words: str
    prepare: Callable[[Scene, Any], Solve]
    values: tuple[float | None, ...] = DIGITS
    setting: str = "{} mm"
    dense: bool = False
    package: str = ""

    def says(self, value: float | None) -> str:
        """A setting in words, such as `1e-9 mm`."""
        return "" if value is None else self.setting.format(power(value))

    def ready(self, scene: Scene, value: float | None, instants: Array) -> Callable[[], Answer]:
        """The set-up, for a scene at instants.

        Raises:
            ImportError: its package is not installed. Also whatever it refuses a scene with.
        """
        if self.package and find_spec(self.package) is None:
            raise ImportError(f"needs the package {self.package!r}, which is not installed")
        return partial(self.prepare(scene, value), instants)
