"""Far and mixed cars are what they are said to be, and an error that grows with the distance is found out."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from pointcoord import Scene
from validate.cars.paper_car import PAPER
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.cases.far_and_mixed import AWAY, CASES, SOLVERS, far, lengthened, moved_car, scaled_car
from validate.hard.cases.near_points import assembled

BY_NAME = {case.name: case for case in CASES}


@pytest.mark.parametrize("distance", [1.0, 1e9, 1e12])
def test_the_shift_is_exact(distance: float) -> None:
    points = moved_car(distance)["mechanism"]["points"]
    for name, place in PAPER.items():
        for axis in range(3):
            shift = Fraction(distance) * Fraction(AWAY[axis])
            assert Fraction(points[name][axis]) - shift == Fraction(place[axis])


def test_every_length_is_scaled_and_no_angle() -> None:
    content = scaled_car(2.0**-19)
    plain = scaled_car(1.0)
    for name, place in PAPER.items():
        assert content["mechanism"]["points"][name] == [2.0**-19 * x for x in place]
    assert content["inputs"]["arm_angle"] == plain["inputs"]["arm_angle"]
    rack = plain["inputs"]["rack"]["polynomial"]
    assert content["inputs"]["rack"]["polynomial"] == [2.0**-19 * x for x in rack]


@pytest.mark.parametrize("value", [1.0, 1e-4])
def test_a_long_tie_rod_is_as_long_as_the_value_says(value: float) -> None:
    p = lengthened(value, ("tie_rod_inner", "rack_centre"), "tie_rod_outer")
    whole = float(np.linalg.norm(assembled()["tie_rod_inner"] - assembled()["tie_rod_outer"]))
    assert np.linalg.norm(p["tie_rod_inner"] - p["tie_rod_outer"]) == pytest.approx(whole / value, rel=1e-12)
    assert np.array_equal(p["tie_rod_inner"], p["rack_centre"])
    assert np.array_equal(p["lower_ball_joint"], assembled()["lower_ball_joint"])


@pytest.mark.parametrize("value", [1e-3, 1e-6, 1e-9])
def test_no_rate_knows_how_far_the_origin_is(value: float) -> None:
    ratios = {n: float(fact) for n, fact in far(value).facts.items() if n.endswith("at home")}
    assert len(ratios) == 5 * len(SOLVERS)
    for name, ratio in ratios.items():
        # Errors of a few roundings differ by a few.
        assert ratio < 100.0, name


@pytest.mark.parametrize("quantity", ["position", "velocity", "angular_acceleration"])
def test_an_error_as_of_subtracted_far_coordinates_is_found_out(
    quantity: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    value = 1e-6
    lost = 4.0 * float(np.spacing(3.0 / value))  # of positions so far away, and of all made from them

    class Losing:
        name = "pointcoord-newton"

        def solve(self, scene: Scene) -> Solution:
            solution = formulation("pointcoord-newton").solve(scene)
            arrays = dict(solution.numbers[quantity])
            name = "knuckle" if "knuckle" in arrays else "tie_rod_outer"
            arrays[name] = arrays[name] + lost
            # It knows that digits are lost, and says so, so that its own bounds hold.
            claims = solution.accuracy.claims[quantity]
            wider = {n: claim + 1e3 * lost for n, claim in claims.items()}
            accuracy = solution.accuracy.with_claims({quantity: wider})
            return replace(solution.with_numbers({quantity: arrays}), accuracy=accuracy)

    far(value)  # the car at home is solved before the model is replaced
    monkeypatch.setattr(
        "validate.hard.trial.formulation", lambda n: Losing() if n.endswith("newton") else formulation(n)
    )
    answers = {answer.formulation: answer for answer in far(value).answers}
    assert answers["pointcoord-newton"].outcome == "wrong"
    assert "bounds of the car at home" in answers["pointcoord-newton"].reason
    assert answers["pointcoord"].outcome == "right"


@pytest.mark.parametrize("scale", [2.0**-19, 2.0**11])
def test_a_car_scaled_by_a_power_of_two_moves_by_scaled_bits(scale: float) -> None:
    plain, scaled = (Scene.from_mapping(scaled_car(s)) for s in (1.0, scale))
    for name in ("pointcoord", "pointcoord-newton"):
        one, other = formulation(name).solve(plain), formulation(name).solve(scaled)
        for point, place in one.position.items():
            assert np.array_equal(other.position[point], scale * place)
            assert np.array_equal(other.acceleration[point], scale * one.acceleration[point])
        assert np.array_equal(other.angular_velocity["knuckle"], one.angular_velocity["knuckle"])
