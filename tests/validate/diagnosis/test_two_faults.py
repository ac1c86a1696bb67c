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


@pytest.mark.parametrize(
    ("axis", "amount", "said"),
    [("x", 3.0, "3 mm too far back: -117, not -120"), ("y", -1.5, "1.5 mm too far out: -651.5, not -650")],
)
def test_a_hardpoint_that_an_axle_gives_once_is_misread_at_both_wheels(
    axis: str, amount: float, said: str
) -> None:
    scene = scene_with("axle-opposed", effects=("camber", "toe"), samples=5)
    content = scene.model_dump(exclude_none=True) | {"tolerance": 1e-13}
    points = {name: list(place) for name, place in content["mechanism"]["points"].items()}
    for part, image in (("left", 1.0), ("right", -1.0 if axis == "y" else 1.0)):
        points[f"{part}.tie_rod_outer"]["xyz".index(axis)] += image * amount
    content["mechanism"]["points"] = points
    wrong = simulate(Scene.from_mapping(content, "misread")).numbers
    (only,) = told(scene, {quantity: wrong[quantity] for quantity in ("position", "wheel")})
    assert only.endswith(f": left.tie_rod_outer.{axis} seems {said}, and right.tie_rod_outer with it")


def test_displacements_from_the_drawing_are_said_to_be_of_all_points() -> None:
    """The motion does not start at the drawing, and points at rest have the same fault as the others."""
    scene = over_travel("hmmwv-front")
    drawn = scene.mechanism.points
    given = {name: place - drawn[name] for name, place in simulate(scene).numbers["position"].items()}
    assert told(scene, {"position": given}) == ["position: the value of the drawing is subtracted"]


@pytest.mark.parametrize(("part", "way"), [("left", "in"), ("right", "out")])
def test_out_is_the_side_of_the_wheel_that_a_point_belongs_to(part: str, way: str) -> None:
    scene = scene_with("axle-opposed", effects=("camber",), samples=5)
    wrong = misread(scene, 1.5, f"{part}.tie_rod_outer.y")["position"]
    (only,) = told(scene, {"position": wrong})
    assert f"{part}.tie_rod_outer.y seems 1.5 mm too far {way}: " in only


def test_a_wheel_that_stands_as_drawn_shows_a_misread_centre() -> None:
    scene = Scene.load("axle-single-wheel")
    wrong = misread(scene, 6.8, "left.wheel_centre.z")["position"]
    assert told(scene, {"position": wrong}) == [
        "position of left.wheel_centre: left.wheel_centre.z seems 6.8 mm too high: 216.8, not 210"
    ]
