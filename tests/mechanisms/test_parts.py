"""An axle is its two corners on one chassis."""

from __future__ import annotations

import pytest
from mechanism_checks import EXACT, MIRROR, closed_form_check, farthest
from mechanism_equations import DIGITS, Equations
from mechanism_files import SCENES, mechanism_file, plain, scene_file
from mechanism_poses import placed
from mpmath import mp

from pointcoord import Scene

AXLES = [scene for scene in SCENES if scene_file(scene)["mechanism"]["type"] == "axle"]


@pytest.mark.parametrize("scene", AXLES)
@pytest.mark.parametrize(("corner", "way"), [("left", -1), ("right", 1)])
def test_a_corner_of_an_axle_moves_as_it_does_alone(scene: str, corner: str, way: int) -> None:
    check = closed_form_check(scene)
    both = check.poses(check.equations())
    tables, part = mechanism_file("double_wishbone"), scene_file(scene)["mechanism"]
    alone = Equations(plain(tables, part, ["wheel_travel", "rack"]))
    with mp.workdps(DIGITS):
        path = [{"wheel_travel": i[f"{corner}.wheel_travel"], "rack": way * i["rack"]} for i in check.path]
        mirror = MIRROR if corner == "left" else 1
        poses = placed(alone, path)
        right = [{f"{corner}.{name}": place * mirror for name, place in points.items()} for points in poses]
    assert farthest(both, right) <= EXACT


@pytest.mark.parametrize("scene", SCENES)
def test_the_packages_read_a_scene_as_it_is_read_apart_from_them(scene: str) -> None:
    tables = scene_file(scene)
    apart = plain(mechanism_file(tables["mechanism"]["type"]), tables["mechanism"], tables["inputs"])
    read = Scene.load(scene).mechanism.plain(list(tables["inputs"]))
    assert {key: value for key, value in apart.items() if key not in ("name", "points")} == {
        key: value for key, value in read.items() if key not in ("name", "points")
    }
    assert {name: [float(c) for c in place] for name, place in apart["points"].items()} == {
        name: [float(c) for c in place] for name, place in read["points"].items()
    }
