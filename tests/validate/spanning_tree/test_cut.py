"""A mechanism is cut where it costs few coordinates, and the tree with its closures is the mechanism."""

import pytest
from mechanism_files import mechanism_file, plain, plain_scene

from validate.spanning_tree.cut import CutError, cut


@pytest.mark.parametrize(
    ("name", "loops"),
    [
        ("double-wishbone", 3),
        ("off-axis-strut", 3),
        ("five-link", 6),
        ("semi-trailing-arm", 1),
        ("slider-crank", 1),
    ],
)
def test_a_mechanism_is_cut_at_few_places(name: str, loops: int) -> None:
    assert len(cut(plain_scene(name)).loops) == loops


def test_a_driven_hinge_is_a_joint_of_the_tree() -> None:
    tree = cut(plain_scene("slider-crank", ["crank"]))
    assert tree.driven[0].body == "crank"
    assert cut(plain_scene("double-wishbone", ["rack", "arm_angle"])).driven[0].body == "point tie_rod_inner"


def test_a_sliding_joint_that_may_not_turn_has_one_coordinate() -> None:
    tables = {
        "title": "cart",
        "bodies": {"chassis": ["A"], "cart": ["B", "C", "D"]},
        "slides": {"rail": {"points": ["B", "C"], "through": "A", "along": "left", "turns": False}},
        "inputs": {"go": {"travel": "rail"}},
    }
    points = {"A": (0, 0, 0), "B": (0, -10, 0), "C": (0, -50, 0), "D": (0, -30, 40)}
    assert [joint.kind for joint in cut(plain(tables, {"points": points}, ["go"])).joints] == ["slide"]
    tables["slides"]["rail"]["turns"] = True
    kinds = [joint.kind for joint in cut(plain(tables, {"points": points}, ["go"])).joints]
    assert kinds == ["slide", "hinge"]
    # Off the rail the cart is brought to it by closures.
    points["C"] = (0, -50, 1)
    found = cut(plain(tables, {"points": points}, ["go"]))
    assert [loop.name for loop in found.loops[:2]] == ["B", "C"]


def test_a_wheel_that_lies_flat_or_has_no_radius_has_no_contact_point() -> None:
    tables, points = mechanism_file("five_link"), dict(plain_scene("five-link")["points"])
    tables["inputs"] = {"lift": {"contact": ["wheel_axis_inner", "wheel_centre"]}}
    with pytest.raises(CutError, match="wheel_radius"):
        cut(plain(tables, {"points": points}, ["lift"]))
    x, y, z = points["wheel_centre"]
    points["wheel_axis_inner"] = (x, y, z - 100.0)
    with pytest.raises(CutError, match="lies flat"):
        cut(plain(tables, {"points": points, "wheel_radius": 300.0}, ["lift"]))
