"""What all three mechanics must say of a scene: each number what it exactly is, within its own claim."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from mpmath import mpf, workdps

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import reference_solution
from validate.formulations.registry import formulation

DIGITS = 40
DUST = 1e-28
"""What is left of derivatives in many digits."""
MECHANICS = ("pointcoord", "absolute", "reference")
by_each = pytest.mark.parametrize("who", MECHANICS)


def solved_by(who: str, scene: Scene) -> Solution:
    """A scene by a formulation, or by the reference."""
    return reference_solution(scene) if who == "reference" else formulation(who).solve(scene)


def scene_of(mechanism: Mapping[str, Any], effects: Sequence[str], **laws: Any) -> Scene:
    """A mechanism whose inputs have constant values, or the coefficients of polynomials, in a second."""
    inputs = {
        name: {"polynomial": law} if isinstance(law, list) else {"constant": law}
        for name, law in laws.items()
    }
    time = {"start": 0.0, "stop": 1.0, "samples": 3}
    return Scene.from_mapping(
        {"effects": list(effects), "mechanism": dict(mechanism), "inputs": inputs, "time": time}
    )


def over_time(formula: Callable[[Any], Mapping[Any, Any]]) -> dict[Any, list[Any]]:
    """What a formula gives, in many digits, at the instants of `scene_of`."""
    with workdps(DIGITS):
        rows = [formula(mpf(k) / 2) for k in range(3)]
    return {name: [row[name] for row in rows] for name in rows[0]}


def assert_exact(
    solution: Solution, exact: Mapping[str | tuple[str, str], Sequence[Any]], within: float = 1e-10
) -> None:
    """Numbers of the car are within their claims of what they exactly are, and these claims are narrow.

    Args:
        exact: by name, or quantity and name, what it is at each instant; vectors have three components.
        within: the claims' limit, of a number's size where that is above 1.
    """
    for key, values in exact.items():
        quantity, name = key if isinstance(key, tuple) else (_quantity_of(solution, key), key)
        found, claims = solution.numbers[quantity][name], solution.accuracy.claims[quantity][name]
        with workdps(DIGITS):
            off = [
                [abs(mpf(float(a)) - b) for a, b in zip(np.ravel(one), np.ravel(value), strict=True)]
                for one, value in zip(found, values, strict=True)
            ]
        most = claims + DUST
        assert (np.array(off, float).reshape(found.shape) <= most).all(), (name, found, values, claims)
        assert (claims <= within * np.maximum(1.0, np.abs(found).max())).all(), (name, claims)


def _quantity_of(solution: Solution, name: str) -> str:
    (quantity,) = (q for q, numbers in solution.numbers.items() if q != "position" and name in numbers)
    return quantity


def assert_none(solution: Solution, names: Sequence[str]) -> None:
    """There are no such numbers: they are left out, or no numbers."""
    for name in names:
        for numbers in solution.numbers.values():
            assert name not in numbers or np.isnan(numbers[name]).all(), (name, numbers[name])
