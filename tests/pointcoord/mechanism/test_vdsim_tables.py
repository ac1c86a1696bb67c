"""Rear suspensions of VDSim against its own tables of full precision (source and licence in `vdsim.json`).

Its axes are x forward, y left, z up, its unit the metre; the wheel is the left one, with the axle along y.
"""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.results.motion import Motion

Array = NDArray[np.float64]
TABLES = json.loads(Path(__file__).with_name("vdsim.json").read_text())
LINKS = {
    "upper_front": "upper_fore",
    "upper_rear": "upper_aft",
    "lower_front": "lower_fore",
    "lower_rear": "lower_aft",
    "toe": "toe_link",
}
# The table of the five links was verified to 4.2e-15 rad; the arm's solver stopped early, at 3e-8 rad by its
# own closed form.
ROUNDED = {"five_link": 4.2e-15, "semi_trailing_arm": 5e-8}
AXIS = 100.0  # mm between the two points of the wheel's axis


def allowed(mechanism: str, motion: Motion) -> float:
    """Both points of the axis may be off by the motion's own bound."""
    return ROUNDED[mechanism] + 2.0 * float(motion.proof().bound.max()) / AXIS


def millimetres(place: list[float]) -> list[float]:
    return [1000.0 * x for x in place]


def points_of(mechanism: str) -> dict[str, list[float]]:
    given = TABLES[mechanism]["points"]
    if mechanism == "five_link":
        found = {
            f"{ours}_{end}": millimetres(given["links"][theirs][i])
            for ours, theirs in LINKS.items()
            for i, end in enumerate(("inner", "outer"))
        }
    else:
        ends = {"pivot_inner": "pivot_inboard", "pivot_outer": "pivot_outboard"}
        found = {ours: millimetres(given[theirs]) for ours, theirs in ends.items()}
    x, y, z = millimetres(given["wheel_centre"])
    return found | {"wheel_centre": [x, y, z], "wheel_axis_inner": [x, y - AXIS, z]}


def scene_of(of: str, points: dict[str, list[float]], **more: object) -> Scene:
    travel = np.array(TABLES[of]["table"])[:, 0] * 1000.0
    return Scene.from_mapping(
        {
            "mechanism": {"type": of, "right": [0, -1, 0], "points": points},
            "effects": ["velocity", "knuckle_rates", "toe"],
            "inputs": {"wheel_travel": {"polynomial": [travel[0], travel[-1] - travel[0]]}},
            "time": {"start": 0.0, "stop": 1.0, "samples": len(travel)},
            **more,
        }
    )


def camber(motion: Motion) -> Array:
    axis = motion.position["wheel_centre"] - motion.position["wheel_axis_inner"]
    return np.asarray(np.arctan2(-axis[:, 2], axis[:, 1]))


def gaps(mechanism: str, motion: Motion) -> float:
    table, there = np.array(TABLES[mechanism]["table"]), motion.position["wheel_centre"]
    track = (there[:, 1] - there[np.argmin(np.abs(table[:, 0])), 1]) / 1000.0
    found = (motion.wheel["toe"], camber(motion), track)
    printed = (table[:, 1], np.array(TABLES[mechanism]["camber"]), table[:, 2])
    return max(float(np.abs(ours - theirs).max()) for ours, theirs in zip(found, printed, strict=True))


@pytest.mark.parametrize("mechanism", TABLES)
def test_toe_camber_and_track_are_those_of_the_table(mechanism: str) -> None:
    motion = simulate(scene_of(mechanism, points_of(mechanism)))
    assert gaps(mechanism, motion) <= allowed(mechanism, motion)
    assert motion.proof().bound.max() < 1e-11


@pytest.mark.parametrize("method", ["newton", "map"])
def test_every_method_gives_the_five_links_alike(method: str) -> None:
    motion = simulate(scene_of("five_link", points_of("five_link")), method)
    assert gaps("five_link", motion) <= allowed("five_link", motion)


def test_a_point_that_is_a_millimetre_off_is_seen() -> None:
    points = points_of("five_link")
    points["toe_outer"][2] += 1.0
    assert gaps("five_link", simulate(scene_of("five_link", points))) > 1e-5


def test_a_link_that_holds_another_point_is_seen() -> None:
    tables = tomllib.loads((MECHANISMS / "five_link.toml").read_text())
    tables["rods"]["toe"] = ["toe_inner", "wheel_axis_inner"]
    points = points_of("five_link")
    scene = scene_of("five_link", points, mechanism={**tables, "right": [0, -1, 0], "points": points})
    assert gaps("five_link", simulate(scene)) > 1e-3


def test_a_five_link_has_no_steering_axis_and_says_so() -> None:
    with pytest.raises(Exception, match="needs the role steering_axis") as caught:
        scene_of("five_link", points_of("five_link"), effects=["caster"])
    assert "caster" in str(caught.value)


def test_an_arm_goes_round_as_often_as_its_turn_says() -> None:
    points = points_of("semi_trailing_arm")
    law = {"arm_turn": {"polynomial": [0.0, 8.0 * np.pi]}}
    scene = scene_of("semi_trailing_arm", points, inputs=law)
    there = simulate(scene).position["wheel_centre"]
    assert np.abs(there[-1] - there[0]).max() < 1e-9
    # A quarter of the way is a whole turn, an eighth half of one: the centre is across the hinge.
    hinge = np.array(points["pivot_outer"]) - points["pivot_inner"]
    hinge /= np.linalg.norm(hinge)
    arm = there[0] - points["pivot_inner"]
    across = 2.0 * (arm @ hinge) * hinge - arm + points["pivot_inner"]
    assert np.abs(there[2] - across).max() < 1e-9
    begun_late = scene_of("semi_trailing_arm", points, inputs={"arm_turn": {"constant": 7.0 * np.pi}})
    assert np.abs(simulate(begun_late).position["wheel_centre"][0] - across).max() < 1e-9


def test_the_turn_is_right_handed_about_the_hinge_as_the_body_lists_it() -> None:
    points = points_of("semi_trailing_arm")
    scene = scene_of("semi_trailing_arm", points, inputs={"arm_turn": {"polynomial": [0.0, 0.3]}})
    motion = simulate(scene)
    hinge = np.array(points["pivot_outer"]) - points["pivot_inner"]
    expected = 0.3 * hinge / np.linalg.norm(hinge)
    assert np.abs(motion.angular_velocity["arm"] - expected).max() < 1e-12
