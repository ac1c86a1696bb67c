"""A mechanism has no place, attitude, size or side: moved, scaled and mirrored drawings move alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from mechanism_checks import EXACT, farthest, scene_inputs
from mechanism_equations import DIGITS, Equations, vector
from mechanism_files import SCENES, Plain, plain_scene, scene_file
from mechanism_poses import placed
from mpmath import mp, mpf

# A rotation of rational entries, and a place.
TURNED = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]], dtype=object) * mpf(1)
MOVED = vector([300, -1700, 40])
LENGTHS = ("travel", "height", "contact", "distance", "moves")
ONE_EACH = {scene_file(scene)["mechanism"]["type"]: scene for scene in reversed(SCENES)}


def same(place: Any) -> Any:
    return place


def carried(mechanism: Plain, place: Callable[[Any], Any], direction: Callable[[Any], Any] = same) -> Plain:
    with mp.workdps(DIGITS):
        points = {name: list(place(vector(point))) for name, point in mechanism["points"].items()}
        axes = {axis: list(direction(vector(mechanism[axis]))) for axis in ("up", "right")}
    return {**mechanism, **axes, "points": points}


def compared(scene: str, other: Plain, place: Callable[[Any], Any], way: Mapping[str, Any]) -> float:
    """How far the poses of a changed drawing are from the changed poses of the drawing, mm."""
    path = scene_inputs(scene, [0, scene_file(scene)["time"]["samples"] // 6])
    with mp.workdps(DIGITS):
        changed = [{name: way.get(name, 1) * number for name, number in inputs.items()} for inputs in path]
    before = placed(Equations(plain_scene(scene)), path)
    with mp.workdps(DIGITS):
        here = [{name: place(point) for name, point in points.items()} for points in before]
    return farthest(placed(Equations(other), changed), here)


@pytest.mark.parametrize("scene", ONE_EACH.values())
def test_a_drawing_that_is_moved_and_turned_moves_alike(scene: str) -> None:
    with mp.workdps(DIGITS):
        rotation = TURNED / 3

        def place(point: Any) -> Any:
            return rotation @ point + MOVED

        other = carried(plain_scene(scene), place, lambda axis: rotation @ axis)
    assert compared(scene, other, place, {}) <= EXACT


@pytest.mark.parametrize("scene", ONE_EACH.values())
def test_a_drawing_of_another_size_moves_alike(scene: str) -> None:
    mechanism = plain_scene(scene)
    lengths = {name: 3 for name, drive in mechanism["inputs"].items() if set(LENGTHS) & set(drive)}
    radius = {"wheel_radius": 3.0 * (mechanism["wheel_radius"] or 0.0)}
    other = {**carried(mechanism, lambda point: 3 * point), **radius}
    assert compared(scene, other, lambda point: 3 * point, lengths) <= 3 * EXACT


def mirrored_input(mechanism: Plain, drive: Plain) -> int:
    """Whether an input counts the other way in a mirror image."""
    if drive.get("from") == "drawing":
        return -1
    along = drive.get("along", "up")
    if "travel" in drive:
        along = mechanism["slides"][drive["travel"][0]]["along"]
    sideways = along in ("left", "right")
    return -1 if sideways != ("turns" in drive) else 1


@pytest.mark.parametrize("scene", ONE_EACH.values())
def test_a_mirror_image_moves_as_a_mirror_image(scene: str) -> None:
    mechanism, mirror = plain_scene(scene), vector([1, -1, 1])
    ways = {name: mirrored_input(mechanism, drive) for name, drive in mechanism["inputs"].items()}
    other = carried(mechanism, lambda point: mirror * point)
    assert compared(scene, other, lambda point: mirror * point, ways) <= EXACT
