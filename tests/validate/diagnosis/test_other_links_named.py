"""Cars with a rod of another length or a line through another joint, solved by absolute, are named."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from curve_files import compared, table
from planted_faults import late

from pointcoord import Scene
from pointcoord.numerics.arrays import Array
from validate import check
from validate.comparison.compare import compare_solutions
from validate.diagnosis import Explanation, explain_outcome
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

Content = dict[str, Any]
EFFECTS = ["velocity", "acceleration", "camber", "toe"]


def car(name: str, **inputs: Mapping[str, object]) -> tuple[Scene, Content]:
    """A scene at 21 instants, and the same with its mechanism's tables in it."""
    scene = Scene.load(name)
    time = scene.time.model_dump() | {"samples": 21} | ({"start": 0.0, "stop": 1.0} if inputs else {})
    changed = {"effects": EFFECTS, "time": time, "inputs": inputs or scene.inputs}
    scene = scene.model_copy(update=changed)
    content = scene.model_dump(exclude_none=True)
    for key in ("type", "closure"):
        content["mechanism"].pop(key, None)
    plain = scene.mechanism.plain(tuple(scene.inputs))
    content["mechanism"] |= {key: plain[key] for key in ("bodies", "rods", "slides", "inputs", "roles")}
    return scene, content


def with_rod(content: Content, rod: str, more: float) -> Content:
    """The distance of a rod's ends is driven instead, so much longer than drawn."""
    part, points = content["mechanism"], content["mechanism"]["points"]
    ends = part["rods"].pop(rod)
    part["inputs"] |= {"its_length": {"distance": ends}}
    drawn = float(np.linalg.norm(np.subtract(points[ends[1]], points[ends[0]])))
    content["inputs"] |= {"its_length": {"constant": drawn + more}}
    return content


def through_the_ball_joint(content: Content) -> Content:
    """The textbook's strut: its axis leads through the ball joint, and its rod ends on that axis."""
    part, points = content["mechanism"], content["mechanism"]["points"]
    part["slides"]["strut"]["through"] = "lower_ball_joint"
    foot, top = np.array(points["lower_ball_joint"]), np.array(points["strut_top"])
    axis = (top - foot) / np.linalg.norm(top - foot)
    points["strut_rod_end"] = (foot + (np.array(points["strut_rod_end"]) - foot) @ axis * axis).tolist()
    return content


def absolute(content: Content) -> Solution:
    return formulation("absolute").solve(Scene.from_mapping(content, "another car"))


def explained(scene: Scene, numbers: Mapping[str, Mapping[str, Array]]) -> tuple[Explanation, ...]:
    """What explains these numbers of a scene and no others."""
    held = formulation("pointcoord").solve(scene)
    given = replace(held, numbers=numbers)
    return explain_outcome(scene, compare_solutions(scene, held, given, "car"))


def diagnosis(scene: Scene, content: Content, *quantities: str) -> tuple[Explanation, ...]:
    numbers = absolute(content).numbers
    return explained(scene, {quantity: numbers[quantity] for quantity in quantities or numbers})


@pytest.mark.parametrize(
    ("name", "rod", "more", "quantities", "told"),
    [
        ("five-link", "lower_rear", -2.0, (), "lower_rear is 2 mm too short: 375.492 mm, not 377.492"),
        ("off-axis-strut", "tie_rod", -2.0, ("position",), "tie_rod is 2 mm too short"),
    ],
)
def test_a_rod_of_another_length_is_named_with_what_it_is_too_long(
    name: str, rod: str, more: float, quantities: tuple[str, ...], told: str
) -> None:
    scene, content = car(name)
    first, *others = diagnosis(scene, with_rod(content, rod, more), *quantities)
    assert first.kind == "link"
    assert told in first.words
    assert first.leftover <= 1.0
    # The end of a tie rod on a rack may be misread instead, along the rack: the same links.
    assert all("tie_rod_inner.y seems" in other.words for other in others)
    assert not (others and name == "five-link")


def test_a_strut_whose_axis_leads_through_the_ball_joint_is_named() -> None:
    scene, content = car("off-axis-strut")
    (only,) = diagnosis(scene, through_the_ball_joint(content), "wheel")
    assert only.kind == "line"
    assert "the line of strut leads through lower_ball_joint, not through strut_lower" in only.words


def test_a_rod_of_another_length_is_named_though_one_number_has_a_fault_of_its_own() -> None:
    scene, content = car("five-link")
    scene = scene.model_copy(update={"effects": ["camber", "toe", "steer_angle"]})
    content["effects"] = scene.effects
    wheel = absolute(with_rod(content, "upper_front", 2.5)).numbers["wheel"]
    wrong = {"wheel": {**wheel, "steer_angle": -wheel["steer_angle"]}}
    told = [one.words for one in check(lambda _: wrong, scene, accuracy=1e-5).explanations]
    assert told[0].startswith("camber, toe: upper_front is 2.5 mm too long")
    assert told[1:] == ["steer_angle: the other sign"]


def test_what_both_wheels_of_an_axle_have_exchanged_is_said_once() -> None:
    scene = Scene.load("axle-opposed")
    right = formulation("pointcoord").solve(scene).numbers
    other = {"left": "right", "right": "left"}

    def exchanged(name: str) -> str:
        part, dot, own = name.partition(".")
        return f"{other[part]}.{own}" if dot else name

    numbers = {q: {name: part[exchanged(name)] for name in part} for q, part in right.items()}
    (only,) = explained(scene, numbers)
    assert only.words.endswith("left and right are exchanged")


def test_a_rod_of_another_length_is_named_where_every_row_is_one_late_besides() -> None:
    scene, content = car("five-link")
    places = absolute(with_rod(content, "upper_rear", 2.0)).numbers["position"]
    (only,) = explained(scene, {"position": {name: late(values) for name, values in places.items()}})
    assert only.kind == "link and sample"
    assert only.words.endswith("upper_rear is 2 mm too long: 363.109 mm, not 361.109, and one sample late")


def test_angles_from_the_drawing_on_are_said_to_be() -> None:
    scene, _ = car("hmmwv-front", wheel_travel={"sweep": (-40.0, 40.0)}, rack={"constant": 0.0})
    scene = scene.model_copy(update={"effects": ["wheel_angles", "caster"]})
    wheel = formulation("absolute").solve(scene).numbers["wheel"]
    from_there = {name: wheel[name] - wheel[name][10] for name in ("kingpin", "caster")}
    columns = {f"{name} [deg]": np.degrees(array) for name, array in from_there.items()}
    travel = {"input.wheel_travel [mm]": np.linspace(-40.0, 40.0, 21)}
    (only,) = compared(table({**travel, **columns}, 4), {}, scene).outcome.explanations
    assert only.words == "kingpin, caster: the value of the drawing is subtracted"
