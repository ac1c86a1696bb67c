"""Cars with a rod of another length, solved by absolute, are named."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene
from pointcoord.numerics.arrays import Array
from validate.comparison.compare import compare_solutions
from validate.diagnosis import Explanation, explain_outcome
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

Content = dict[str, Any]
EFFECTS = ["velocity", "acceleration", "camber", "toe"]


def car(name: str) -> tuple[Scene, Content]:
    """A scene at 21 instants, and the same with its mechanism's tables in it."""
    scene = Scene.load(name)
    time = scene.time.model_dump() | {"samples": 21}
    scene = scene.model_copy(update={"effects": EFFECTS, "time": time})
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
