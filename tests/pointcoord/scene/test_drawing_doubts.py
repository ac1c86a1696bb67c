"""What looks wrong with a drawing is said, with its value, and nothing is said of a sound one."""

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, SceneError, built_in_scenes, simulate, standing

CAR = dict(Scene.load("off-axis-strut").mechanism.points)
Car = Mapping[str, tuple[float, ...]]


def scaled(factor: float) -> Car:
    return {name: tuple((factor * np.array(place)).tolist()) for name, place in CAR.items()}


def with_angle(make_scene: Callable[..., Scene], car: Car, **more: object) -> Scene:
    return make_scene([1.63], [0.0], stop=0.0, samples=1, points=car, closure="drawn", **more)


def test_nothing_is_doubted_of_the_built_in_scenes() -> None:
    assert {name: doubts for name in built_in_scenes() if (doubts := Scene.load(name).mechanism.doubts)} == {}


@pytest.mark.parametrize(("factor", "length"), [(1e-3, "0.645 mm"), (0.039, "25.2 mm"), (1e3, "6.45e+05 mm")])
def test_a_car_in_another_unit_is_doubted_and_solved(
    make_scene: Callable[..., Scene], factor: float, length: str
) -> None:
    motion = simulate(with_angle(make_scene, scaled(factor)))
    assert f"the car is {length} long" in motion.notes[0]
    count = len(motion.notes)  # a tolerance of 1e-9 mm is too fine for a car of half a kilometre
    assert repr(motion).endswith(f"; {count} note{'s' if count > 1 else ''}>")


@pytest.mark.parametrize(
    ("point", "place", "words"),
    [
        ("wheel_axis_inner", (0.0, -860.0, 309.0), "wheel_axis_inner lies outboard of wheel_centre"),
        ("wheel_axis_inner", (0.0, -740.0, 200.0), "the drawn camber is"),
        ("lower_ball_joint", (-5.0, 712.0, 195.0), "the drawn kingpin angle is"),
        ("wheel_axis_inner", None, "from strut_lower to wheel_centre"),
    ],
)
def test_a_misdrawn_axis_is_doubted_with_its_angle(
    make_scene: Callable[..., Scene], point: str, place: tuple[float, ...] | None, words: str
) -> None:
    car = {name: at for name, at in CAR.items() if name != point}
    if place is not None:
        car[point] = place
    doubts = make_scene(points=car, closure="drawn").mechanism.doubts
    assert any(words in doubt for doubt in doubts)


@pytest.mark.parametrize("name", ["double-wishbone"])
def test_a_point_with_the_wrong_sign_to_the_right_is_doubted_and_a_rack_near_the_middle_is_not(
    name: str,
) -> None:
    scene = Scene.load(name)
    part = scene.mechanism
    # A wheel centre across the middle is refused.
    for point in {*part.topology.required_points} - {"wheel_centre"}:
        x, y, z = part.points[point]
        for place, wrong in (((x, -y, z), True), ((x, -0.05 * y, z), False)):
            points = {**part.points, point: place}
            doubts = part.model_copy(update={"points": points}).doubts
            told = [doubt for doubt in doubts if "across the middle of the car" in doubt]
            assert [doubt.split(" lies ")[0] for doubt in told] == [point] * wrong
            assert all(f"{abs(y):.4g} mm across" in doubt for doubt in told)


def swapped(car: Car, one: str, other: str) -> Car:
    return {**car, one: car[other], other: car[one]}


WISHBONE = dict(Scene.load("double-wishbone").mechanism.points)
ARM, ROD, KINGPIN = (
    ("lower_arm_front", "lower_arm_rear"),
    ("tie_rod_inner", "tie_rod_outer"),
    ("lower_ball_joint", "upper_ball_joint"),
)
STRUT, PAIR = (CAR, "macpherson", "left"), (WISHBONE, "double_wishbone", "right")


@pytest.mark.parametrize(
    ("car", "type", "side", "pair", "words"),
    [
        (*STRUT, ARM, "drawn 300 mm behind lower_arm_rear"),
        (*STRUT, ROD, "tie_rod_inner lies 360 mm outboard of"),
        (*PAIR, ARM, "drawn 200 mm behind lower_arm_rear"),
        (*PAIR, ROD, "tie_rod_inner lies 472 mm outboard of"),
        (*PAIR, KINGPIN, "from lower_ball_joint to upper_ball_joint: are they swapped?"),
    ],
)
def test_two_points_that_are_swapped_are_doubted(
    car: Car, type: str, side: str, pair: tuple[str, str], words: str
) -> None:
    content = Scene.load("double-wishbone").model_dump(mode="json", exclude_none=True)
    content["effects"] = []
    content["mechanism"] |= {"type": type, "side": side, "points": swapped(car, *pair)}
    scene = Scene.from_mapping(content)
    assert any(words in doubt for doubt in scene.mechanism.doubts)
    content["mechanism"]["points"] = car
    assert Scene.from_mapping(content).mechanism.doubts == ()


def test_a_car_drawn_forwards_is_doubted_whatever_side_it_is_said_to_be() -> None:
    """x forward and y to the left, and `side` changed instead of `right`: front and rear are mistaken."""
    content = Scene.load("double-wishbone").model_dump(mode="json", exclude_none=True)
    turned = {name: (-x, -y, z) for name, (x, y, z) in WISHBONE.items()}
    content["mechanism"] |= {"points": turned, "side": "left"}
    (doubt,) = Scene.from_mapping(content).mechanism.doubts
    assert "toe, steer angle, caster" in doubt
    assert "may have the wrong sign" in doubt
    assert "towards [-1.0, 0.0, 0.0]" in doubt
    content["mechanism"] |= {"right": [0.0, -1.0, 0.0], "side": "right"}
    assert Scene.from_mapping(content).mechanism.doubts == ()


def test_mirrored_axes_are_told_how_to_say_so(make_scene: Callable[..., Scene]) -> None:
    mirrored = {name: (x, -y, z) for name, (x, y, z) in CAR.items()}
    with pytest.raises(SceneError, match=r"right = \[0.0, -1.0, 0.0\]"):
        make_scene(points=mirrored, closure="drawn")
    laws = {"arm_angle": [1.63, 0.1], "rack": [0.0, 20.0], "stop": 1.0, "closure": "drawn"}
    plain = simulate(make_scene(points=CAR, **laws))
    turned = simulate(make_scene(points=mirrored, right=(0.0, -1.0, 0.0), **laws))
    for name, path in plain.position.items():
        assert np.abs(turned.position[name] - path * [1.0, -1.0, 1.0]).max() < 1e-10
    for angle in ("camber", "kingpin"):  # which look along the car, and do not ask where its front is
        assert np.abs(turned.wheel[angle] - plain.wheel[angle]).max() < 1e-12


def test_what_is_no_scene_is_refused() -> None:
    name: Any = "bounce"
    number: Any = 7
    with pytest.raises(SceneError, match="is a str, and no scene; allowed: a Scene, as"):
        standing(name)
    with pytest.raises(SceneError, match="is a int, and no scene; allowed: a Scene, as"):
        simulate(number)


@pytest.mark.parametrize("name", [None, 3, b"bounce"])
def test_what_names_no_scene_is_refused_as_it_is(name: object) -> None:
    built_in = ", ".join(built_in_scenes())
    with pytest.raises(SceneError, match=f"names no scene; allowed: a path, or one of {built_in}"):
        Scene.load(name)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"effects": ["kingpin"]}, "no effect is called 'kingpin' ('wheel_angles' gives it)"),
        ({"effects": ["Toe"]}, "no effect is called 'Toe' (did you mean 'toe'?)"),
        ({"effects": ["derivative_2"]}, "called 'derivative_2' ('acceleration' is its name); allowed"),
        ({"effects": ["derivative_09"]}, "called 'derivative_09' ('derivative_9' is its name)"),
        ({"effects": ["derivative_0"]}, "('position' is its name, and it always comes)"),
        ({"effects": ["derivative_21"]}, "(the highest is derivative_20: beyond it doubles lose their"),
        ({"effects": [f"derivative_{'9' * 5000}"]}, "(the highest is derivative_20"),
        ({"effects": ["derivative_\N{SUPERSCRIPT TWO}"]}, "(did you mean 'derivative_"),
        ({"mechanism": {"type": "double wishbone"}}, "(did you mean 'double_wishbone'?)"),
        (
            {"mechanism": {"type": "macpherson"}},
            "no point of a macpherson is called 'upper_arm_front', which is a point of a double_wishbone",
        ),
        ({"inputs": {"rock": {"constant": 0.0}}}, "no input is called 'rock' (did you mean 'rack'?)"),
    ],
)
def test_a_name_that_is_meant_otherwise_is_told_what_was_meant(change: dict[str, Any], words: str) -> None:
    content = Scene.load("double-wishbone").model_dump(mode="json", exclude_none=True)
    for key, value in change.items():
        content[key] = content[key] | value if isinstance(value, dict) else value
    with pytest.raises(SceneError, match=re.escape(words)):
        Scene.from_mapping(content)
