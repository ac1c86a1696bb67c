"""What looks wrong with a drawing is said, with its value, and nothing is said of a sound one."""

from typing import Any

import numpy as np
import pytest
from changed_scenes import content_of, scene_with

from pointcoord import PointcoordError, Scene, built_in_scenes, simulate

STRUT, WISHBONE = "off-axis-strut", "double-wishbone"


def test_nothing_is_doubted_of_the_built_in_scenes() -> None:
    assert {name: doubts for name in built_in_scenes() if (doubts := Scene.load(name).mechanism.doubts)} == {}


@pytest.mark.parametrize(("factor", "length"), [(1e-3, "0.645 mm"), (0.039, "25.2 mm"), (1e3, "6.45e+05 mm")])
def test_a_car_in_another_unit_is_doubted_and_solved(factor: float, length: str) -> None:
    content = content_of(STRUT)
    points = {name: np.multiply(factor, p).tolist() for name, p in content["mechanism"]["points"].items()}
    held = {"arm_angle": {"constant": "drawn"}, "rack": {"constant": 0.0}}
    motion = simulate(scene_with(STRUT, {"points": points}, inputs=held))
    assert f"the car is {length} long" in motion.notes[0]
    count = len(motion.notes)  # a tolerance of 1e-9 mm is too fine for a car of half a kilometre
    assert repr(motion).endswith(f"; {count} note{'s' if count > 1 else ''}>")


@pytest.mark.parametrize("factor", [0.0, 1e-112, 1e300])
def test_a_mechanism_without_a_usable_size_is_refused(factor: float) -> None:
    places = content_of("slider-crank")["mechanism"]["points"]
    points = {name: np.multiply(factor, place).tolist() for name, place in places.items()}
    with pytest.raises(PointcoordError, match="the points span"):
        simulate(scene_with("slider-crank", {"points": points}))


# Where points are drawn: at a place, or at that of another.
MISDRAWN: list[tuple[str, dict[str, Any], str]] = [
    (
        STRUT,
        {"wheel_axis_inner": (0.0, -860.0, 309.0)},
        "to wheel_centre: are they swapped, or is side wrong?",
    ),
    (STRUT, {"wheel_axis_inner": (0.0, -740.0, 200.0)}, "the drawn camber is"),
    (
        WISHBONE,
        {"wheel_centre": (0.0, 18237.2, 5334.0)},
        "half of them within 217.3 mm of it: is it drawn",
    ),
    (STRUT, {"lower_ball_joint": (-5.0, 712.0, 195.0)}, "the drawn kingpin angle is"),
    (STRUT, {"lower_arm_front": "lower_arm_rear"}, "drawn 300 mm behind lower_arm_rear"),
    (STRUT, {"tie_rod_inner": "tie_rod_outer"}, "tie_rod_inner lies 360 mm outboard of"),
    (WISHBONE, {"lower_arm_front": "lower_arm_rear"}, "drawn 200 mm behind lower_arm_rear"),
    (WISHBONE, {"tie_rod_inner": "tie_rod_outer"}, "tie_rod_inner lies 472 mm outboard of"),
    (
        WISHBONE,
        {"lower_ball_joint": "upper_ball_joint"},
        "to upper_ball_joint: are they swapped, or is side wrong?",
    ),
]


@pytest.mark.parametrize(("name", "moved", "words"), MISDRAWN)
def test_a_misdrawn_or_swapped_point_is_doubted_with_its_value(
    name: str, moved: dict[str, Any], words: str
) -> None:
    points = content_of(name)["mechanism"]["points"]
    for one, other in moved.items():
        if isinstance(other, str):
            points[one], points[other] = points[other], points[one]
        else:
            points[one] = other
    doubts = scene_with(name, {"points": points}, effects=[]).mechanism.doubts
    assert any(words in doubt for doubt in doubts), doubts


def test_a_car_in_mm_in_a_scene_that_says_m_is_told_to_look_at_its_units() -> None:
    scene = Scene.from_mapping(content_of(WISHBONE) | {"units": "m"}, "in m")
    (doubt,) = (doubt for doubt in scene.mechanism.doubts if "mm long" in doubt)
    # It is not: the scene says so, and is wrong.
    assert "points are in mm" not in doubt
    assert "another unit than the scene states" in doubt


def test_a_point_with_the_wrong_sign_to_the_right_is_doubted_and_a_rack_near_the_middle_is_not() -> None:
    part = Scene.load(WISHBONE).mechanism
    # A wheel centre beyond the middle is refused.
    for point in {*part.topology.required_points} - {"wheel_centre"}:
        x, y, z = part.points[point]
        for place, wrong in (((x, -y, z), True), ((x, -0.05 * y, z), False)):
            doubts = part.model_copy(update={"points": {**part.points, point: place}}).doubts
            told = [doubt for doubt in doubts if "beyond the middle of the car" in doubt]
            assert [doubt.split(" lies ")[0] for doubt in told] == [point] * wrong
            assert all(f"{abs(y):.4g} mm beyond" in doubt for doubt in told)


def test_a_car_drawn_forwards_is_doubted_whatever_side_it_is_said_to_be() -> None:
    """x forward and y to the left, and `side` changed instead of `right`: front and rear are mistaken."""
    points = content_of(WISHBONE)["mechanism"]["points"]
    turned = {name: (-x, -y, z) for name, (x, y, z) in points.items()}
    (doubt,) = scene_with(WISHBONE, {"points": turned, "side": "left"}).mechanism.doubts
    for words in ("Angles along the car may have the wrong sign", "towards [-1.0, 0.0, 0.0]"):
        assert words in doubt
    assert scene_with(WISHBONE, {"points": turned, "right": [0.0, -1.0, 0.0]}).mechanism.doubts == ()
