"""Every formulation, and the reference, on every shipped mechanism: right within what they claim."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from mechanism_checks import EXACT, Points, exact_states, instants, scene_inputs
from mechanism_equations import DIGITS, vector
from mechanism_files import SCENES, scene_file
from mpmath import mp

from pointcoord import Scene
from validate.adjudication.reference_solution import design_of
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import OUTSIDE, formulation
from validate.reference import instants_of

FORMULATIONS = ("pointcoord", "pointcoord-newton", "pointcoord-map", "absolute", "relative", *OUTSIDE)
# Motions that meet a singular pose after some instants: the scene, and its input from the drawing on.
BEYOND = {
    "branches cross": ("n-four-bar", "crank", [0.0, -1.7]),
    "the input has an end": ("bricard", "turn", [0.0, -0.6]),
    "the piston has a dead centre": ("slider-crank", "stroke", [15.0, 100.0]),
}
STATES = ("position", "velocity", "acceleration")


@cache
def right(scene: str) -> list[tuple[Points, Points, Points]]:
    return exact_states(scene, instants(scene, 3))


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", FORMULATIONS)
def test_a_formulation_is_right_within_what_it_claims(name: str, scene: str) -> None:
    solution = formulation(name).solve(Scene.load(scene))
    for k, states in zip(instants(scene, 3), right(scene), strict=True):
        for quantity, exact in zip(STATES, states, strict=True):
            for point, found in solution.numbers[quantity].items():
                with mp.workdps(DIGITS):
                    off = np.abs(vector(found[k]) - exact[point]).astype(float)
                claim = solution.accuracy.claims[quantity][point][k]
                assert (off <= claim + EXACT).all(), (quantity, point, k, off, claim)


@pytest.mark.parametrize("scene", SCENES)
def test_the_reference_is_right_within_what_it_has_proven(scene: str) -> None:
    asked = (scene_inputs(scene, instants(scene, 3), derivative) for derivative in range(3))
    inputs = [
        {name: tuple(float(one[name]) for one in states) for name in states[0]}
        for states in zip(*asked, strict=True)
    ]
    found = list(instants_of(design_of(Scene.load(scene)), inputs))
    for instant, states in zip(found, right(scene), strict=True):
        for quantity, exact in zip(STATES, states, strict=True):
            for point, place in getattr(instant, quantity).items():
                with mp.workdps(DIGITS):
                    off = np.abs(vector(place) - exact[point])
                    assert (off <= instant.error_bound[quantity] + EXACT).all(), (quantity, point, off)


@pytest.mark.parametrize("beyond", BEYOND)
@pytest.mark.parametrize("name", FORMULATIONS)
def test_a_formulation_refuses_to_pass_a_singular_pose(name: str, beyond: str) -> None:
    scene, driven, polynomial = BEYOND[beyond]
    inputs = {driven: {"polynomial": polynomial}}
    time = {"start": 0.0, "stop": 1.0, "samples": 31}
    with pytest.raises(FormulationError, match=driven):
        formulation(name).solve(Scene.from_mapping({**scene_file(scene), "inputs": inputs, "time": time}))
