"""A misread hardpoint is named beside a fault that every number has, and where it moves nothing."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pytest
from changed_scenes import scene_with
from planted_faults import late, misread

from pointcoord import Scene, simulate
from pointcoord.numerics.arrays import Array
from validate import check

Change = Callable[[Array], Array]
SECOND = {"start": 0.0, "stop": 1.0}


def over_travel(name: str, *effects: str) -> Scene:
    """A built-in car over its wheel's travel."""
    rest = {"rack": {"constant": 0.0}} if "rack" in Scene.load(name).inputs else {}
    laws = {"wheel_travel": {"sweep": (-45.0, 45.0)}} | rest
    # 19 instants: those of the first 18 are counted anew with other roundings.
    return scene_with(name, effects=effects, inputs=laws, time=SECOND | {"samples": 19})


def told(scene: Scene, given: Mapping[str, Mapping[str, Array]], accuracy: float = 1e-5) -> list[str]:
    return [one.words for one in check(lambda _: given, scene, accuracy=accuracy).explanations]


def steered() -> Scene:
    laws = {"wheel_travel": {"constant": 0.0}, "rack": {"sweep": (-20.0, 20.0)}}
    effects = ("wheel_angles", "toe")
    return scene_with("double-wishbone", effects=effects, inputs=laws, time=SECOND | {"samples": 9})


HMMWV = partial(over_travel, "hmmwv-front")
FIVE_LINK = partial(over_travel, "five-link", "camber", "toe")
HINGE = "upper_front_inner.x"
HINGE_MOVED = "3.1 mm too far back: 1103.1, not 1100"


@pytest.mark.parametrize(
    ("car", "quantity", "coordinate", "amount", "change", "words"),
    [
        (
            *(HMMWV, "position", "lower_arm_rear.z", 1.9, late),
            "1.9 mm too high: 1.9, not 0, and one sample late",
        ),
        (
            *(partial(over_travel, "wheel-travel"), "position", "pushrod_inner.y", 1.2),
            lambda v: v * [1.0, -1.0, 1.0],
            "1.2 mm too far out: 344.2, not 343, and left for right: the car is mirrored",
        ),
        (
            *(partial(over_travel, "double-wishbone"), "position", "upper_arm_front.z", -3.0),
            lambda v: v / 1000.0,
            "3 mm too low: 252, not 255, and m for mm",
        ),
        (
            *(HMMWV, "position", "upper_ball_joint.x", 2.4, lambda v: v + np.array([0.0, 0.0, 25.0])),
            "2.4 mm too far back: 55.4, not 53, and a constant offset of (0, 0, 25) mm",
        ),
        (
            *(partial(over_travel, "bmw-e90-strut"), "position", "strut_top.x", 2.5),
            lambda v: v[:, [1, 0, 2]],
            "2.5 mm too far back: 86.32, not 83.82, and other axes: its x, y, z are our y, x, z",
        ),
        # What the hardpoint changes is as large as the angles themselves.
        (
            *(steered, "wheel", "lower_ball_joint.z", 2.5, np.tan),
            "2.5 mm too high: 97.5, not 95, and the slope, no angle",
        ),
        (FIVE_LINK, "wheel", HINGE, 3.1, np.degrees, f"{HINGE_MOVED}, and degrees for radians"),
        (FIVE_LINK, "wheel", HINGE, 3.1, np.negative, f"{HINGE_MOVED}, and the other sign"),
    ],
)
def test_a_misread_hardpoint_is_named_with_what_is_wrong_with_every_number(
    car: Callable[[], Scene], quantity: str, coordinate: str, amount: float, change: Change, words: str
) -> None:
    scene = car()
    wrong = misread(scene, amount, coordinate)[quantity]
    (only,) = told(scene, {quantity: {name: change(values) for name, values in wrong.items()}})
    named = "position" if quantity == "position" else ", ".join(wrong)
    assert only == f"{named}: {coordinate} seems {words}"


@pytest.mark.parametrize(("amount", "accuracy"), [(3.1, 1e-5), (-40.0, 1e-5), (1.0, 0.1)])
def test_a_point_that_moves_nothing_is_misread_all_the_same(amount: float, accuracy: float) -> None:
    """The arm's hinge is along x: where on it its rear point is drawn shows in that point alone."""
    scene = over_travel("double-wishbone")
    right = simulate(scene).numbers["position"]
    there = right["upper_arm_rear"] + [amount, 0.0, 0.0]
    (only,) = told(scene, {"position": {**right, "upper_arm_rear": there}}, accuracy)
    assert only.startswith(f"position of upper_arm_rear: upper_arm_rear.x seems {abs(amount):g} mm too far")


def test_angles_of_an_axle_by_another_definition_are_said_to_be() -> None:
    scene = scene_with("axle-opposed", effects=("wheel_angles", "caster"), samples=9)
    wheel = simulate(scene).numbers["wheel"]
    (only,) = told(scene, {"wheel": {name: np.tan(angles) for name, angles in wheel.items()}})
    # Camber is so little that its slope is the angle.
    assert only == "left.kingpin, right.kingpin, left.caster, right.caster: the slope, no angle"


def test_an_offset_of_one_wheel_hides_no_misread_hardpoint_of_the_other() -> None:
    """Two hardpoints would do as well, were it not for angles that agree."""
    scene = scene_with("axle-opposed", effects=("camber", "toe"), samples=5)
    wheel = misread(scene, -1.0, "right.lower_arm_front.z")["wheel"]
    said = told(scene, {"wheel": {**wheel, "left.camber": wheel["left.camber"] - 0.01}})
    assert any("right.lower_arm_front.z seems 1 mm too low" in one for one in said)
    assert "left.camber: a constant offset of -0.01 rad" in said
    assert not any(" and left." in one for one in said)


def test_a_wheel_that_stands_as_drawn_shows_a_misread_centre() -> None:
    scene = Scene.load("axle-single-wheel")
    wrong = misread(scene, 6.8, "left.wheel_centre.z")["position"]
    assert told(scene, {"position": wrong}) == [
        "position of left.wheel_centre: left.wheel_centre.z seems 6.8 mm too high: 216.8, not 210"
    ]
