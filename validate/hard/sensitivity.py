"""How the rates of a pose depend on the pose, for models that do not know it themselves.

The tolerance of a rate needs the largest change of a velocity and of an acceleration per displacement of the
pose (see `tolerance`). Where pointcoord solves the scene it says them. Where it does not, the car is drawn
anew at the true pose of each instant, from which there is no way to go.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, simulate
from validate.formulation import Solution
from validate.inputs import rates

Array = NDArray[np.float64]

KNOWING = ("pointcoord", "pointcoord-newton")


def with_sensitivities(
    scene: Scene, truth: Solution, answer: Solution, solutions: Mapping[str, Solution]
) -> Solution:
    """The truth with the sensitivities that its comparison with an answer needs.

    Args:
        solutions: all that the scene has, by formulation.
    """
    if answer.accuracy.velocity_sensitivity.any():
        return truth
    knowing = next((solutions[name].accuracy for name in KNOWING if name in solutions), None)
    if knowing is None:
        first, second = redrawn_sensitivities(scene, truth)
    else:
        first, second = knowing.velocity_sensitivity, knowing.acceleration_sensitivity
    known = replace(truth.accuracy, velocity_sensitivity=first, acceleration_sensitivity=second)
    return replace(truth, accuracy=known)


def redrawn_sensitivities(scene: Scene, truth: Solution) -> tuple[Array, Array]:
    """Sensitivities of the true poses, 1/s and 1/s^2, each of shape (N,); zero where they are not known."""
    each = np.array([_redrawn(scene, truth, i) for i in range(len(truth.times))])
    return each[:, 0], each[:, 1]


def _redrawn(scene: Scene, truth: Solution, index: int) -> tuple[float, float]:
    time = truth.times[index : index + 1]
    laws = {}
    for name, part in scene.inputs.items():
        value, rate, acceleration = rates(part, time)[0].tolist()
        # The chassis is drawn where it is, so it has no way to go.
        start = 0.0 if name == "heave" else value
        laws[name] = {"polynomial": [start, rate, 0.5 * acceleration]}
    content = scene.model_dump(mode="json", exclude_none=True)
    content["inputs"] = laws
    content["mechanism"]["points"] = {name: place[index].tolist() for name, place in truth.position.items()}
    content["time"] = {"start": 0.0, "stop": 0.0, "samples": 1}
    try:
        proof = simulate(Scene.from_mapping(content), "newton").proof()
    except PointcoordError:
        return 0.0, 0.0
    return float(proof.velocity_sensitivity[0]), float(proof.acceleration_sensitivity[0])
