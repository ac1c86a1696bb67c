"""Every shipped mechanism is what closed forms and other people's printed tables say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from mechanism_checks import CLOSED, PRINTED, closed_form_check, right_form, scene_inputs, table
from mechanism_equations import DIGITS, Array, Equations, vector
from mechanism_files import MECHANISMS, SCENES, mechanism_file, plain, plain_scene, scene_file
from mechanism_poses import Stuck, follow, rates, refined
from mpmath import mp, mpf, pi


def test_every_mechanism_has_a_scene_and_a_closed_form_or_a_printed_table() -> None:
    shown = {scene_file(scene)["mechanism"]["type"] for scene in SCENES}
    held = {scene_file(scene)["mechanism"]["type"] for scene in CLOSED} | set(PRINTED)
    assert shown == held == set(MECHANISMS)


@pytest.mark.parametrize("scene", CLOSED)
def test_the_poses_of_a_scene_are_those_of_the_closed_form(scene: str) -> None:
    check = closed_form_check(scene)
    found = check.deviations(check.poses(check.equations()))
    assert all(found[name] <= limit for name, limit in check.limits.items()), found


@pytest.mark.parametrize("mechanism", PRINTED)
def test_the_numbers_are_those_of_the_printed_table(mechanism: str) -> None:
    check = PRINTED[mechanism]()
    found = check.deviations(check.poses(check.equations()))
    assert set(found) == set(check.limits)
    assert all(found[name] <= limit for name, limit in check.limits.items()), found


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_drives_as_many_inputs_as_there_are_freedoms(scene: str) -> None:
    mechanism = plain_scene(scene)
    drives = [drive for drive in mechanism["inputs"].values() if "moves" not in drive]
    assert Equations(mechanism).freedoms() == sum(len(drive.get("travel", [1])) for drive in drives)


def andrews_rates(inputs: Sequence[Any], order: int) -> Array:
    """First or second derivatives of the benchmark's seven angles; a second one of a mechanism at rest."""
    equations = Equations(plain_scene("andrews-squeezer"))
    with mp.workdps(DIGITS):
        (y,) = follow(equations, [{"crank": inputs[0]}])
        y = refined(equations, y, {"crank": inputs[0]})
        p, moved = equations.points(y), rates(equations, y, {"crank": inputs})[order - 1]

        def turning(first: str, second: str) -> Any:
            arm, pull = p[second] - p[first], moved[second] - moved[first]
            return np.cross(arm, pull)[2] / (arm @ arm)

        beta, gamma, delta, epsilon = (turning(*ends) for ends in ("OF", "BE", "AG", "AH"))
        theta, phi, omega = (turning(*ends) for ends in ("EF", "GE", "HE"))
        found = [beta, theta - beta, gamma, phi - delta, delta, omega - epsilon, epsilon]
        return np.array(found).astype(float)


def test_andrews_angles_accelerate_from_rest_as_printed() -> None:
    printed = vector(table("andrews_squeezer")["a0"]).astype(float)
    # The drawing is rounded to doubles: 1e-16 of the rates, a hundred times amplified at most.
    assert andrews_rates((0, 0, printed[0]), 2) == pytest.approx(printed, abs=1e-14 * printed[0])


def test_andrews_angles_end_as_fast_as_printed() -> None:
    data = table("andrews_squeezer")
    start, end, printed = mpf(data["q0"][0]), mpf(data["q_t003"][0]), vector(data["v_t003"]).astype(float)
    # The printed velocities meet their own constraints to 2e-8 of the largest and no better.
    assert andrews_rates((end - start, printed[0], 0), 1) == pytest.approx(printed, abs=2e-8 * printed[0])


def with_hinged_couplers() -> dict[str, object]:
    """The coupled four-bars with bodies for couplers, hinged to the cranks: six rows depend on others."""
    scene, tables = scene_file("n-four-bar"), mechanism_file("n_four_bar")
    pins = {f"B{k}_pin": [1000 * k, 1000, 1000] for k in range(3)}
    for k in range(3):
        tables["bodies"][f"crank_{k}"].append(f"B{k}_pin")
    for k in (1, 2):
        tables["bodies"][f"coupler_{k}"] = [f"B{k - 1}", f"B{k - 1}_pin", f"B{k}", f"B{k}_pin"]
    part = {**scene["mechanism"], "points": scene["mechanism"]["points"] | pins}
    return plain({**tables, "rods": {}}, part, ["crank"])


# rad from the drawing. Parallel and crossed assemblies meet at -pi/2; the closest is 1e-3 rad before.
BEFORE, BEYOND = "-1.5697", "-1.7"


@pytest.mark.parametrize("hinged", [False, True])
def test_parallel_cranks_stay_parallel_up_to_the_singular_pose_and_are_refused_there(hinged: bool) -> None:
    equations = Equations(with_hinged_couplers() if hinged else plain_scene("n-four-bar"))
    path = [{"crank": mpf(angle)} for angle in ("-0.8", BEFORE, BEYOND)]
    for y, inputs, right in zip(
        follow(equations, path[:2]), path, right_form("n-four-bar", path), strict=False
    ):
        found = equations.points(y)
        # mm: doubles, amplified by the 1e3 of a pose that is 1e-3 rad from a singular one.
        assert max(abs(found[name] - right[name]).max() for name in right) < 1e-8, inputs
    with pytest.raises(Stuck, match="singular"):
        follow(equations, path)


def test_bricards_ring_is_refused_beyond_the_end_of_its_input() -> None:
    equations = Equations(plain_scene("bricard"))
    with pytest.raises(Stuck, match="singular"):
        follow(equations, [{"turn": -31 * pi / 180}])


def test_a_piston_that_is_driven_stops_at_the_dead_centre() -> None:
    equations = Equations(plain_scene("slider-crank", ["stroke"]))
    reach = scene_inputs("slider-crank", range(101))
    top = max(p["piston"][2] - p["bore"][2] for p in right_form("slider-crank", reach))
    assert follow(equations, [{"stroke": top - 1}]).shape == (1, len(equations.start))
    with pytest.raises(Stuck):
        follow(equations, [{"stroke": top + 1}])


@pytest.mark.parametrize("scene", ["spatial-four-bar", "slider-crank", "andrews-squeezer"])
def test_a_crank_that_turned_once_is_where_it_was(scene: str) -> None:
    equations = Equations(plain_scene(scene))
    drawn = {name: vector(place) for name, place in plain_scene(scene)["points"].items()}
    for y in follow(equations, [{"crank": 2 * pi}, {"crank": 4 * pi}]):
        turned = equations.points(y)
        # mm: 1e-14 of 200 mm, a few times amplified.
        assert max(abs(turned[name] - drawn[name]).max() for name in drawn) < 1e-10
