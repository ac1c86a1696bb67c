"""The shipped scenes as the model is given them, and where their points exactly are.

The reference, which says so, is held to closed forms and printed tables in tests/mechanisms.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from exact_states import exact_states
from many_digits import DIGITS
from mechanism_files import plain_scene
from mpmath import mp, mpf
from numpy.typing import NDArray

import absolute
from pointcoord import Scene
from validate.formulations.input_rates import laws_of

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)


class Motion(NamedTuple):
    """A mechanism as it is compiled, and the laws of its inputs (N, 3)."""

    plain: dict[str, Any]
    inputs: dict[str, Array]

    def solve(self, **options: Any) -> absolute.Solution:
        return absolute.solve(absolute.compile(self.plain), self.inputs, **options)


@cache
def shipped(scene: str, count: int = 5) -> Motion:
    """The motion of a shipped scene at some of its instants, the first and the last among them."""
    asked = Scene.load(scene)
    places = np.linspace(0, len(asked.instants) - 1, count).round().astype(int)
    return Motion(plain_scene(scene), laws_of(asked, asked.instants[places]))


def exact(motion: Motion) -> list[tuple[dict[str, Any], ...]]:
    """Points and their first and second rates at every instant."""
    count = len(next(iter(motion.inputs.values())))
    laws = {name: law.tolist() for name, law in motion.inputs.items()}
    return exact_states(motion.plain, [{name: law[k] for name, law in laws.items()} for k in range(count)])


def error(found: Array, wanted: Any) -> float:
    """The largest difference of a component from its exact value."""
    with mp.workdps(DIGITS):
        return max(float(abs(mpf(float(a)) - b)) for a, b in zip(found, wanted, strict=True))


def off(solution: absolute.Solution) -> Array:
    """(N,) mm: points that miss their rows by the accuracy that is stated lie within so many times that."""
    return np.asarray(solution.accuracy * solution.condition)
