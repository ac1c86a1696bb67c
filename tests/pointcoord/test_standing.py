"""Where a drawing stands and how far its inputs go, against closed forms."""

import numpy as np
import pytest

from pointcoord import Scene, simulate, standing


def test_the_paper_s_arm_reaches_as_far_as_its_dead_points_allow() -> None:
    found = standing(Scene.load("bounce"))
    low, high = (np.rad2deg(end.value) for end in found.reach["arm_angle"])
    # Closed form: the ball joint's circle crosses the vertical plane through the arm's axis (rack at 0).
    assert low == pytest.approx(32.228, abs=1e-3)
    assert high == pytest.approx(152.013, abs=1e-3)
    for end in found.reach["arm_angle"]:
        assert "rise of lower_ball_joint over lower_arm_front" in end.limits


def test_the_rack_reaches_as_far_as_tie_rod_and_steering_arm_lie_in_line() -> None:
    scene = Scene.load("off-axis-strut")
    found = standing(scene)
    points = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    # With the arm held, the tie rod's outer end runs on a circle about the line from ball joint to strut top;
    # the farthest and the nearest it comes to the inner end is the tie rod's length where it locks.
    ball, top, outer = (points[name] for name in ("lower_ball_joint", "strut_top", "tie_rod_outer"))
    along = (top - ball) / np.linalg.norm(top - ball)
    centre = ball + ((outer - ball) @ along) * along
    radius = np.linalg.norm(outer - centre)
    rod = np.linalg.norm(outer - points["tie_rod_inner"])
    for end in found.reach["rack"]:
        inner = points["tie_rod_inner"] - end.value * np.array([0.0, 1.0, 0.0])
        height = (inner - centre) @ along
        off = np.linalg.norm(inner - centre - height * along)
        nearest, farthest = np.hypot(off - radius, height), np.hypot(off + radius, height)
        assert min(abs(nearest - rod), abs(farthest - rod)) <= 1e-8 * rod
        assert any("tie_rod" in name for name in end.limits)


def test_the_drawn_inputs_and_angles_are_those_of_the_motion_there() -> None:
    scene = Scene.load("off-axis-strut")
    found = standing(scene)
    assert found.inputs["rack"] == 0.0
    content = scene.model_dump(exclude_none=True)
    content["inputs"] = {name: {"constant": value} for name, value in found.inputs.items()}
    motion = simulate(Scene.from_mapping(content))
    assert motion.wheel["camber"][0] == pytest.approx(found.angles["camber"], abs=1e-13)
    assert motion.wheel["kingpin"][0] == pytest.approx(found.angles["kingpin"], abs=1e-13)
    assert found.angles["camber"] == pytest.approx(-np.arctan(1.0 / 120.0), abs=1e-13)
    assert found.closing == motion.closing
