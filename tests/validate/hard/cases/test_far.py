"""Far and scaled cars are what they are said to be, and errors that grow with the distance are found out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from stand_in import stand_in

from pointcoord import Scene
from validate.cars.paper_car import PAPER
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.cases.far import CASES, scaled_car
from validate.hard.subjects import PAPER as STRUT

(FAR,) = (case for case in CASES if case.name == "far-from-the-origin")


@pytest.mark.parametrize("quantity", ["position", "velocity", "angular_acceleration"])
def test_an_error_as_of_subtracted_far_coordinates_is_found_out(
    quantity: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    value = 1e-6
    lost = 4.0 * float(np.spacing(3.0 / value))  # of positions so far away, and of all made from them

    def losing(scene: Scene) -> Solution:
        solution = formulation("pointcoord-newton").solve(scene)
        arrays = dict(solution.numbers[quantity])
        name = "knuckle" if "knuckle" in arrays else "tie_rod_outer"
        arrays[name] = arrays[name] + lost
        # It knows that digits are lost, and says so, so that its own bounds hold.
        claims = solution.accuracy.claims[quantity]
        wider = {n: claim + 1e3 * lost for n, claim in claims.items()}
        accuracy = solution.accuracy.with_claims({quantity: wider})
        return replace(solution.with_numbers({quantity: arrays}), accuracy=accuracy)

    FAR.examine(value)  # the car at home is solved before the model is replaced
    stand_in(monkeypatch, losing, "pointcoord-newton")
    answers = {answer.formulation: answer for answer in FAR.examine(value).answers}
    assert answers["pointcoord-newton"].outcome == "wrong"
    assert "bounds of the car at home" in answers["pointcoord-newton"].reason
    assert answers["pointcoord"].outcome == "right"


@pytest.mark.parametrize("scale", [2.0**-19, 2.0**11])
def test_a_car_scaled_by_a_power_of_two_moves_by_scaled_bits(scale: float) -> None:
    content, whole = scaled_car(STRUT, scale), scaled_car(STRUT, 1.0)
    for name, drawn in PAPER.items():
        assert content["mechanism"]["points"][name] == [scale * x for x in drawn]
    assert content["inputs"]["arm_angle"] == whole["inputs"]["arm_angle"]
    plain, scaled = Scene.from_mapping(whole), Scene.from_mapping(content)
    for name in ("pointcoord", "pointcoord-newton"):
        one, other = formulation(name).solve(plain), formulation(name).solve(scaled)
        for point, place in one.position.items():
            assert np.array_equal(other.position[point], scale * place)
            assert np.array_equal(other.acceleration[point], scale * one.acceleration[point])
        assert np.array_equal(other.angular_velocity["knuckle"], one.angular_velocity["knuckle"])
