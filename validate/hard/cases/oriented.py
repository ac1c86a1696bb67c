"""Oriented quantities that tell the branches of a car apart, followed through a solved motion.

Two assemblies meet where a product of vectors is zero: the ball joint's place beside the arm's axis, that of
the upper ball joint beside the plane of its pivots and the lower one, or the tie rod's outer end beside the
plane of kingpin and rack. As parts of the lengths that they are made of all lie between -1 and 1; along a
motion without a jump they keep the sign of the drawing.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cars.closed_form import BALL, FRONT, REAR
from validate.cars.registry import suspension_of
from validate.cars.scene_content import car_of
from validate.hard.trial import Facts, Tried

Array = NDArray[np.float64]


def sides(scene: Scene, position: Mapping[str, Array]) -> dict[str, Array]:
    """Each product at every instant, of shape (N,), as parts of the lengths of its factors.

    Args:
        position: of the points, (N, 3), mm.
    """
    found = {}
    for side, factors in _factors(scene, position).items():
        lengths = [np.linalg.norm(v, axis=-1) for v in factors]
        found[side] = np.asarray(_product(*factors) / (lengths[0] * lengths[1] * lengths[2]))
    return found


def drawn_signs(scene: Scene) -> dict[str, int]:
    """The sign of each product of the drawing, exactly; 0 where it lies where two assemblies meet."""
    exact = {n: np.array([Fraction(x) for x in place]) for n, place in scene.mechanism.points.items()}
    products = {side: _product(*factors) for side, factors in _factors(scene, exact).items()}
    return {side: int(product > 0) - int(product < 0) for side, product in products.items()}


def _factors(scene: Scene, position: Mapping[str, NDArray[Any]]) -> dict[str, tuple[NDArray[Any], ...]]:
    car = car_of(scene)
    arm = position[REAR] - position[FRONT]
    up = np.broadcast_to(np.array(scene.mechanism.up), arm.shape)
    if arm.dtype == object:
        up = np.array([Fraction(x) for x in scene.mechanism.up])
    found: dict[str, tuple[NDArray[Any], ...]] = {"arm": (arm, up, position[BALL] - position[FRONT])}
    for side, (origin, *others) in suspension_of(car).sides[car.closure].items():
        first, second, third = (position[name] - position[origin] for name in others)
        found[side] = (first, second, third)
    return found


def _product(a: NDArray[Any], b: NDArray[Any], c: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(np.sum(np.cross(a, b) * c, axis=-1))


def followed(tried: Tried) -> Facts:
    """For each solution its least share on the side of the drawing; negative on another branch."""
    facts: dict[str, float | str] = {}
    signs = drawn_signs(tried.scene)
    for name, solution in tried.solutions.items():
        for side, shares in sides(tried.scene, solution.position).items():
            facts[f"{side} side of {name}, least share"] = float(np.min(signs[side] * shares))
    return facts
