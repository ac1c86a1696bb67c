"""A method to solve scenes (a way) in the study: a name, its settings, and a function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from typing import Any

from pointcoord import Scene
from validate.arrays import Array
from validate.formulations.protocol import Numbers

DIGITS = tuple(10.0**-digits for digits in range(2, 14))


def power(number: float) -> str:
    """A number with one digit, such as 1e-9."""
    mantissa, exponent = f"{number:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


Solve = Callable[[Array], Numbers]
"""Solves at N increasing instants, (N,), s, of which the first may be after the scene's start.

Returns numbers by quantity and name, in the scene's axes and units.
"""


def laws_at(scene: Scene, instants: Array) -> dict[str, Array]:
    """Value, rate and acceleration of every input, (N, 3), rad or mm, and s."""
    return {name: law.series(instants, 2) * (1.0, 1.0, 2.0) for name, law in scene.functions.items()}


@dataclass(frozen=True)
class Way:
    """A method to solve scenes. To add one, write a file with a `Way`, and add a line to the registry.

    Attributes:
        name: on the command line and in tables. words: a description of one line.
        prepare: the set-up: prepares a scene for a value of the setting. It raises an error if the method
            refuses the scene. It uses the effects that the scene asks for, but not the scene's instants.
        values: values of the setting, the coarsest first; None if there is no setting.
        setting: template of a value in words.
        dense: whether one solve serves any instant, so that more instants cost only their evaluation.
        package: import name of an optional package that the method needs.
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

    def ready(self, scene: Scene, value: float | None, instants: Array) -> Callable[[], Numbers]:
        """Set up a scene; returns the function that solves it at the instants.

        Raises:
            ImportError: the package of the method is not installed.
            Exception: the method refuses the scene.
        """
        if self.package and find_spec(self.package) is None:
            raise ImportError(f"needs the package {self.package!r}, which is not installed")
        return partial(self.prepare(scene, value), instants)
