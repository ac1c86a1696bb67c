"""A mechanism is cut where it costs few coordinates, and the tree with its closures is the mechanism."""

import numpy as np
import pytest
from mechanism_files import SCENES, mechanism_file, plain, plain_scene

from validate.spanning_tree.cut import CHASSIS, COORDINATES, CutError, SpanningTree, cut
from validate.spanning_tree.determined import independent_rows


def coordinates(tree: SpanningTree) -> int:
    """Of all joints; a rod's spin about itself changes nothing."""
    return sum(COORDINATES[joint.kind] for joint in tree.joints) - len(tree.rods)


@pytest.mark.parametrize("name", SCENES)
def test_loops_and_driven_joints_hold_every_coordinate_but_for_redundant_ones(name: str) -> None:
    tree = cut(plain_scene(name))
    held = 3 * len(tree.loops) + len(tree.driven)
    assert held - coordinates(tree) == (1 if name == "bricard" else 0)


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


@pytest.mark.parametrize("name", SCENES)
def test_joints_come_after_their_parents_and_every_point_is_where_it_is_drawn(name: str) -> None:
    mechanism = plain_scene(name)
    tree = cut(mechanism)
    seen = {CHASSIS}
    for joint in tree.joints:
        assert joint.parent in seen
        seen.add(joint.body)
    for point, place in tree.points.items():
        assert place.body in seen
        if name not in ("bounce", "bounce-and-steer", "bounce-on-a-heaving-chassis", "steer"):
            far = np.linalg.norm(place.at * tree.unit + tree.origin - mechanism["points"][point])
            # A point of no body is put on its line: what shipped scenes are drawn off it is rounding.
            assert far < 1e-9 or place.body.startswith("point "), point


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


def test_rows_that_depend_on_others_are_not_chosen() -> None:
    jacobian = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    assert independent_rows(jacobian).tolist() == [1, 3, 4]
