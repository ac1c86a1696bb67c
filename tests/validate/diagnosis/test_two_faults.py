"""A misread hardpoint is named where it moves nothing, and next to a fault of one wheel."""

from collections.abc import Mapping

import pytest
from changed_scenes import scene_with
from planted_faults import misread

from pointcoord import Scene, simulate
from pointcoord.numerics.arrays import Array
from validate import check

SECOND = {"start": 0.0, "stop": 1.0}


def over_travel(name: str, *effects: str) -> Scene:
    """A built-in car over its wheel's travel."""
    rest = {"rack": {"constant": 0.0}} if "rack" in Scene.load(name).inputs else {}
    laws = {"wheel_travel": {"sweep": (-45.0, 45.0)}} | rest
    # 19 instants: those of the first 18 are counted anew with other roundings.
    return scene_with(name, effects=effects, inputs=laws, time=SECOND | {"samples": 19})


def told(scene: Scene, given: Mapping[str, Mapping[str, Array]], accuracy: float = 1e-5) -> list[str]:
    return [one.words for one in check(lambda _: given, scene, accuracy=accuracy).explanations]


@pytest.mark.parametrize(("amount", "accuracy"), [(3.1, 1e-5), (-40.0, 1e-5), (1.0, 0.1)])
def test_a_point_that_moves_nothing_is_misread_all_the_same(amount: float, accuracy: float) -> None:
    """The arm's hinge is along x: where on it its rear point is drawn shows in that point alone."""
    scene = over_travel("double-wishbone")
    right = simulate(scene).numbers["position"]
    there = right["upper_arm_rear"] + [amount, 0.0, 0.0]
    (only,) = told(scene, {"position": {**right, "upper_arm_rear": there}}, accuracy)
    assert only.startswith(f"position of upper_arm_rear: upper_arm_rear.x seems {abs(amount):g} mm too far")


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
