"""Numbers with a fault, as a test plants it to see it explained."""

from __future__ import annotations

import numpy as np

from pointcoord import Scene, simulate
from pointcoord.numerics.arrays import Array
from validate.formulations.protocol import Numbers


def late(values: Array) -> Array:
    """Every row one too late, the first one twice."""
    return np.concatenate([values[:1], values[:-1]])


def misread(scene: Scene, amount: float, *coordinates: str) -> Numbers:
    """The numbers of the car with some coordinates drawn so much more, or less after a minus; to rounding."""
    content = scene.model_dump(exclude_none=True) | {"tolerance": 1e-13}
    points = {name: list(place) for name, place in content["mechanism"]["points"].items()}
    for point, _, axis in (coordinate.rpartition(".") for coordinate in coordinates):
        points[point.removeprefix("-")]["xyz".index(axis)] += -amount if point.startswith("-") else amount
    content["mechanism"]["points"] = points
    return simulate(Scene.from_mapping(content, "misread")).numbers
