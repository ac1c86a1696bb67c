"""The shipped scenes as input of the model, and the exact places of their points by the reference.

tests/mechanisms compares the reference with closed forms and printed tables.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from many_digits import DIGITS
from mechanism_files import exact_states, plain_scene
from mpmath import mp, mpf
from numpy.typing import NDArray

import absolute
from pointcoord import Scene
from validate.formulations.input_rates import laws_of

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)


class Motion(NamedTuple):
    """A mechanism's description, and the laws of its inputs (N, 3)."""

    plain: dict[str, Any]
    inputs: dict[str, Array]

    def solve(self, **options: Any) -> absolute.Solution:
        return absolute.solve(absolute.compile(self.plain), self.inputs, **options)


@cache
def shipped(scene: str, count: int = 5) -> Motion:
    """The motion of a shipped scene at some instants, from the first to the last."""
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
    """(N,) mm: largest error of points whose rows are violated by the stated accuracy."""
    return np.asarray(solution.accuracy * solution.condition)
