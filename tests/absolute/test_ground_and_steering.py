"""Wheels that stay on the ground as the car moves over it, steering wheels, and the axis of steering."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from scipy.spatial.transform import Rotation
from shipped import EPS

import absolute
from absolute.errors import DescriptionError

RADIUS = 270.0
KNUCKLE = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer", "wheel_axis_inner", "wheel_centre")
GROUND = {"contact": ["wheel_axis_inner", "wheel_centre"], "over": "ground"}
MOVES = {
    "heave": {"moves": "chassis", "along": "up"},
    "roll": {"turns": "chassis", "about": "upper_arm_front", "along": "forward"},
    "pitch": {"turns": "chassis", "about": "lower_arm_rear", "along": "left"},
}
UP = np.array([0.0, 0.0, 1.0])


def wishbone(inputs: dict[str, Any], **more: Any) -> dict[str, Any]:
    described = plain_scene("double-wishbone", ["rack"], wheel_radius=RADIUS)
    return {**described, "inputs": {**described["inputs"], **inputs}, **more}


def height(points: Any) -> Any:
    """Of the lowest point of the disc, from places as they are reported."""
    axis = points["wheel_centre"] - points["wheel_axis_inner"]
    lean = axis[..., 2] / np.linalg.norm(axis, axis=-1)
    return points["wheel_centre"][..., 2] - RADIUS * np.sqrt(1.0 - lean**2)


@pytest.mark.parametrize("moving", [(), ("heave",), ("roll",), ("heave", "pitch", "roll"), ("roll", "pitch")])
def test_the_contact_point_keeps_its_height_over_the_ground(moving: tuple[str, ...]) -> None:
    model = absolute.compile(wishbone({**{name: MOVES[name] for name in moving}, "ground": GROUND}))
    t = np.linspace(0.0, 1.0, 6)
    laws = {
        "rack": np.stack([12.0 * t, 12.0 + 0.0 * t, 0.0 * t], axis=-1),
        "ground": np.stack([-4.0 * t, -4.0 + 0.0 * t, 0.0 * t], axis=-1),
        "heave": np.stack([6.0 * t**2, 12.0 * t, 12.0 + 0.0 * t], axis=-1),
        "roll": np.stack([0.07 * t, 0.07 + 0.0 * t, 0.0 * t], axis=-1),
        "pitch": np.stack([-0.04 * t**2, -0.08 * t, -0.08 + 0.0 * t], axis=-1),
    }
    laws = {name: law for name, law in laws.items() if name in (*moving, "rack", "ground")}
    chassis = laws["heave"][..., None] * UP if "heave" in moving else None
    motion = absolute.solve(model, laws, chassis)
    drawn = {name: np.array(place, dtype=float) for name, place in wishbone({})["points"].items()}
    # Bodies are chained by up to three more, and the condition number is below 100.
    off = 1e3 * EPS * 800.0
    assert np.abs(height(motion.position) - height(drawn) + 4.0 * t).max() < off
    # A disc whose axis turns about its centre: the rate of its height is that of the formula.
    step = 1e-6
    ahead = {
        n: p + step * motion.velocity[n] + step**2 / 2 * motion.acceleration[n]
        for n, p in motion.position.items()
    }
    behind = {
        n: p - step * motion.velocity[n] + step**2 / 2 * motion.acceleration[n]
        for n, p in motion.position.items()
    }
    rate = (height(ahead) - height(behind)) / (2.0 * step)
    bend = (height(ahead) - 2.0 * height(motion.position) + height(behind)) / step**2
    # Differences round by EPS of 800 mm, and leave out third derivatives of some hundred mm/s^3.
    assert np.abs(rate + 4.0).max() < 4.0 * EPS * 800.0 / step
    assert np.abs(bend).max() < 16.0 * EPS * 800.0 / step**2


def test_a_steering_wheel_moves_the_rack_by_its_turns() -> None:
    t = np.array([0.0, 0.4, 1.0])
    arm = {
        "arm_angle": {
            "angle": "lower_arm",
            "of": "lower_ball_joint",
            "about": "lower_arm_front",
            "from": "up",
        }
    }
    drawn = absolute.Assembled(absolute.compile(wishbone(arm))).drawn_inputs["arm_angle"]
    law = np.stack([15.0 * t, 15.0 + 0.0 * t, 0.0 * t], axis=-1)
    angle = np.tile([drawn, 0.0, 0.0], (3, 1))
    asked = ["toe", "toe_by_rack"]
    by_rack = absolute.solve(
        absolute.compile(wishbone(arm)), {"rack": law, "arm_angle": angle}, effects=asked
    )
    for per_turn in (45.0, -45.0):
        described = wishbone(arm, rack_per_turn=per_turn)
        described["inputs"] = {**arm, "wheel": {"steers": ["rack"]}}
        turns = law * (2.0 * np.pi / per_turn)
        by_wheel = absolute.solve(
            absolute.compile(described), {"wheel": turns, "arm_angle": angle}, effects=asked
        )
        for name in KNUCKLE:
            assert np.abs(by_wheel.position[name] - by_rack.position[name]).max() < 1e3 * EPS * 800.0
            assert np.abs(by_wheel.velocity[name] - by_rack.velocity[name]).max() < 1e3 * EPS * 800.0
        for name in asked:
            assert np.abs(by_wheel.effects[name] - by_rack.effects[name]).max() < 1e3 * EPS
    for wrong in (None, 0.0, np.nan, True):
        described = {**wishbone(arm, rack_per_turn=wrong), "inputs": {**arm, "wheel": {"steers": ["rack"]}}}
        with pytest.raises(DescriptionError, match=r"'wheel' needs rack_per_turn, not .*in mm"):
            absolute.compile(described)


def test_the_screw_axis_is_that_of_a_small_turn_of_the_knuckle() -> None:
    """By the rotation that takes the knuckle's points at one travel of the rack to those at another."""
    travel = {"travel": {"height": "wheel_centre"}}
    names = [name for name in absolute.EFFECTS if name.startswith("screw_")]
    step, place = 1e-3, 9.0
    racks = np.array([place - step, place, place + step])
    laws = {"rack": np.stack([racks, 0 * racks, 0 * racks], -1), "travel": np.tile([7.0, 0.0, 0.0], (3, 1))}
    motion = absolute.solve(absolute.compile(wishbone(travel)), laws, rates=False, effects=names)
    before, here, after = (np.array([motion.position[name][i] for name in KNUCKLE]) for i in range(3))
    turn = Rotation.align_vectors(after - after[-1], before - before[-1])[0].as_rotvec() / (2.0 * step)
    moved = (after[-1] - before[-1]) / (2.0 * step)
    axis = turn * np.sign(turn[2])
    point = here[-1] + np.cross(turn, moved) / (turn @ turn)
    spin = here[-1] - here[-2]
    upward = UP - spin * (spin @ UP) / (spin @ spin)
    contact = here[-1] - RADIUS * upward / np.linalg.norm(upward)
    ground, hub = (p - point - axis * (p - point)[2] / axis[2] for p in (contact, here[-1]))
    ahead = np.cross(UP, spin) / np.hypot(*spin[:2])
    expected = {
        "screw_kingpin": np.arctan2(-axis[1], axis[2]),
        "screw_caster": np.arctan2(axis[0], axis[2]),
        "screw_kingpin_offset": ground[1],
        "screw_scrub_radius": np.linalg.norm(ground),
        "screw_mechanical_trail": -ground @ ahead,
        "screw_castor_offset": ground[0],
        "screw_kingpin_offset_at_wheel": hub[1],
        "screw_hub_trail": -hub[0],
        "screw_pitch": turn @ moved / (turn @ turn),
    }
    # A turn of some 1e-5 rad is told from places that round by EPS of 800 mm, over arms of 100 mm: to 2e-10
    # of itself; lines are up to 400 mm away. Differences leave out the square of the step by the car's size.
    for name, number in expected.items():
        assert abs(motion.effects[name][1] - number) < 400.0 * 1e-8, name
    assert set(expected) == set(names)


def test_a_wheel_far_from_the_origin_is_driven_as_one_near_it() -> None:
    """Drawn on a grid that both places hold exactly; far out a place is rounded by 2^-23 mm."""
    contact = {"contact": GROUND["contact"]}
    t = np.linspace(0.0, 1.0, 5)
    laws = {
        n: np.stack([a * t, a + 0.0 * t, 0.0 * t], axis=-1) for n, a in (("rack", 12.0), ("wheel", -40.0))
    }
    velocities = []
    for far in (0.0, 2.0**30):
        described = wishbone({"wheel": contact})
        leaning = {"wheel_axis_inner": np.add(described["points"]["wheel_axis_inner"], (7.0, 0.0, 13.0))}
        places = {n: np.round(np.array(p) * 2.0**10) for n, p in (described["points"] | leaning).items()}
        points = {n: place / 2.0**10 + far for n, place in places.items()}
        model = absolute.compile({**described, "points": points})
        velocities.append(absolute.solve(model, laws).velocity)
    for name, near in velocities[0].items():
        # No point is faster than 100 mm/s, and no condition number above 100.
        assert np.abs(near - velocities[1][name]).max() < 100.0 * EPS * 100.0, name
