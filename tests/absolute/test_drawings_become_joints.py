"""What a drawing becomes: joint frames, lines, inputs and signs, in numbers known by hand."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pytest
from flat import built_in
from struts import TABLE
from wishbones import LOTUS

import absolute
from absolute.description import Axis, Joint, Model
from absolute.drawing import Drawing
from absolute.errors import DescriptionError
from absolute.rows import OFFSETS, RIGHT_ANGLES, SENSES, frame_about, joint_frames, rows_of

Points = Mapping[str, tuple[float, float, float]]
EPS = np.finfo(float).eps

# Freedoms that a joint leaves its two bodies.
FREEDOMS = {
    "spherical": 3,
    "revolute": 1,
    "prismatic": 1,
    "on_line": 4,
    "key": 5,
    "parallel": 3,
    "level": 5,
    "distance": 5,
}
X, Y, Z = np.eye(3)
LOWER = ("lower_arm_front", "lower_arm_rear")
UPPER = ("upper_arm_front", "upper_arm_rear")
POINTS = {"o": (0.0, 0.0, 0.0), "a": (3.0, 0.0, 0.0), "b": (0.0, 4.0, 0.0), "c": (0.0, 0.0, -5.0)}


def lines_of(first: tuple[float, float, float], second: tuple[float, float, float], kind: str) -> Model:
    """Two bodies with a joint of a kind at their common point, and inputs that make up the number of rows."""
    end = "a" if kind == "distance" else "o"
    joint = Joint(kind, "ground", "body", Axis(end, first), Axis("o", second))
    inputs = {
        f"input {i}": absolute.Input("ground", Axis("o", (1.0, 0.0, 0.0)), "body", "b", "linear", 1.0)
        for i in range(FREEDOMS[kind])
    }
    bodies = {"ground": ("o", "a", "c"), "body": ("o", "b")}
    return Model(
        POINTS,
        "ground",
        bodies,
        {"joint": joint},
        inputs,
        absolute.Corner((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    )


@pytest.mark.parametrize("kind", FREEDOMS)
def test_a_joint_takes_what_it_does_not_leave(kind: str) -> None:
    model = lines_of((0.0, 0.0, 1.0), (0.0, 1.0, 0.0) if kind == "level" else (0.0, 0.0, 1.0), kind)
    rows = rows_of(model, Drawing(model))
    assert len(rows.angles) + len(rows.offsets) == 6
    own = [row for row in rows.offsets if row.owner == "joint"]
    assert len(rows.offsets) - FREEDOMS[kind] == len(own) == len(OFFSETS[kind]) + (kind == "distance")
    assert {row.owner for row in rows.offsets[len(own) :]} == set(model.inputs)


# What a joint still allows: a motion of the second body against the first in the frame of the joint, with z
# along the axis, by a shift and by a small turn.
ALLOWED = {
    "spherical": ((), (X, Y, Z)),
    "revolute": ((), (Z,)),
    "prismatic": ((Z,), ()),
}


@pytest.mark.parametrize("kind", ALLOWED)
def test_rows_of_a_joint_stop_every_motion_but_its_own(kind: str) -> None:
    # x_i . (turn x y_j) = turn . (y_j x x_i)
    turns = [np.cross(np.eye(3)[j], np.eye(3)[i]) for i, j in RIGHT_ANGLES[kind]]
    stopped = [np.eye(3)[i] for i in OFFSETS[kind]]
    for directions, allowed in zip((stopped, turns), ALLOWED[kind], strict=True):
        assert np.linalg.matrix_rank(np.array([*directions, np.zeros(3)])) == len(directions)
        assert len(directions) + len(allowed) == 3
        for direction in directions:
            assert all(direction @ way == 0.0 for way in allowed)
    # Turned halfway round about x or y, a line has the other sense; about z, only a prismatic joint minds.
    for half_turn in (np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, 1.0, -1.0])):
        minded = [half_turn[i, j] for i, j in SENSES[kind]]
        assert any(product < 0.0 for product in minded) == (kind != "spherical")
    about_axis = np.diag([-1.0, -1.0, 1.0])
    assert any(about_axis[i, j] < 0.0 for i, j in SENSES[kind]) == (kind == "prismatic")
    assert all(np.eye(3)[i, j] == 1.0 for i, j in SENSES[kind])


@pytest.mark.parametrize("z", [X, Y, Z, -Z, np.array([2.0, -3.0, 6.0]) / 7.0, np.array([0.6, 0.0, -0.8])])
def test_a_frame_is_right_handed_about_its_axis(z: np.ndarray) -> None:
    frame = frame_about(z)
    assert np.array_equal(frame[2], z)
    assert np.abs(frame @ frame.T - np.eye(3)).max() <= 8 * EPS
    assert np.linalg.det(frame) == pytest.approx(1.0, abs=8 * EPS)
    # Made from the axis of space that it leans least along, so that it keeps its digits.
    assert frame[0, int(np.argmin(np.abs(z)))] == 0.0


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "key"])
@pytest.mark.parametrize("second", [(2.0, 1.0, 2.0), (0.0, 0.0, 3.0), (-3.0, 4.0, 12.0)])
def test_lines_drawn_apart_are_joined_by_their_smallest_turn(
    kind: str, second: tuple[float, float, float]
) -> None:
    model = lines_of((0.0, 0.0, 5.0), second, kind)
    one, other = joint_frames("joint", model.joints["joint"], Drawing(model))
    turn = other.T @ one
    assert np.abs(turn @ turn.T - np.eye(3)).max() <= 16 * EPS
    cosine = second[2] / np.linalg.norm(second)
    assert np.abs(other[2] - np.array(second) / np.linalg.norm(second)).max() <= 8 * EPS
    # Of all turns that bring one line into the other the smallest is that by the angle between them.
    assert (np.trace(turn) - 1.0) / 2.0 == pytest.approx(cosine, abs=16 * EPS)


def test_lines_at_a_right_angle_keep_a_frame_each_and_balls_none() -> None:
    model = lines_of((0.0, 0.0, 5.0), (0.0, 2.0, 0.0), "level")
    one, other = joint_frames("joint", model.joints["joint"], Drawing(model))
    assert (one[2].tolist(), other[2].tolist()) == ([0, 0, 1], [0, 1, 0])
    model = lines_of((0.0, 0.0, 5.0), (0.0, 2.0, 0.0), "spherical")
    for frame in joint_frames("joint", model.joints["joint"], Drawing(model)):
        assert np.array_equal(frame, np.eye(3))


@pytest.mark.parametrize(
    ("second", "apart"),
    [((1.0, 0.0, 0.0), "90.0"), ((0.0, 0.0, -2.0), "180.0"), ((0.0, 1.0, -1.0), "135.0")],
)
def test_lines_that_lead_against_each_other_are_refused(
    second: tuple[float, float, float], apart: str
) -> None:
    model = lines_of((0.0, 0.0, 5.0), second, "revolute")
    with pytest.raises(DescriptionError, match=f"drawn {apart} degrees apart"):
        rows_of(model, Drawing(model))


def test_a_drawing_without_words_is_a_left_wheel_drawn_z_up_and_y_right() -> None:
    model = built_in("macpherson", TABLE)
    assert np.array_equal(model.corner.axes, [(0, -1, 0), (1, 0, 0), (0, 0, 1)])
    right = built_in("macpherson", TABLE, side="right", up=(0, 0, 4), right=(-3, 0, 0)).corner
    assert np.array_equal(right.axes, [(-1, 0, 0), (0, 1, 0), (0, 0, 1)])


@pytest.mark.parametrize("lean", [1e-7, 0.999e-6])
def test_directions_that_are_rounded_pass(lean: float) -> None:
    assert built_in("macpherson", TABLE, right=(0.0, 1.0, lean)).corner


@pytest.mark.parametrize(("lean", "apart"), [(1.001e-6, "89.9999"), (1.0, "45"), (-1.0, "135")])
def test_directions_at_no_right_angle_are_refused_with_their_angle(lean: float, apart: str) -> None:
    with pytest.raises(DescriptionError, match=f"up and right are {apart} degrees apart"):
        built_in("macpherson", TABLE, right=(0.0, 1.0, lean))


def test_lines_against_each_other_are_180_degrees_apart_however_they_are_rounded() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        x, y, z = rng.normal(size=3).tolist()
        model = lines_of((x, y, z), (-x, -y, -z), "revolute")
        with pytest.raises(DescriptionError, match=r"drawn 180\.0 degrees apart"):
            rows_of(model, Drawing(model))


def test_a_double_wishbone_turns_its_arms_about_their_own_pivots() -> None:
    model = built_in("double_wishbone", LOTUS)
    assert set(model.bodies["chassis"]) == {*LOWER, *UPPER, "rack_centre"}
    for arm, pivots in (("lower_arm", LOWER), ("upper_arm", UPPER)):
        assert model.joints[f"hinge of {arm} on chassis"].on_second == Axis(*pivots)
        assert set(pivots) < set(model.bodies[arm])
    angle = model.inputs["arm_angle"]
    assert (angle.axis.through, angle.point) == (LOWER[0], "lower_ball_joint")
    assert angle.factor == pytest.approx(
        np.linalg.norm(np.subtract(LOTUS["lower_ball_joint"], LOTUS[LOWER[0]])), rel=4 * EPS
    )


def test_directions_are_told_by_name_and_checked_by_name() -> None:
    build: Callable[..., Model] = partial(built_in, "macpherson")
    for name in ("up", "right"):
        with pytest.raises(DescriptionError, match=f"^{name}") as caught:
            build(TABLE, **{name: (0.0, 1.0)})
        assert caught.value.name == name


def test_inputs_are_as_drawn() -> None:
    model = built_in("macpherson", {**TABLE, "lower_ball_joint": (282.0, -8.0, -6.0)})
    angle, rack = model.inputs["arm_angle"], model.inputs["rack"]
    # From (270, -5, -10): 12, -3, 4, which is 13 long.
    assert (angle.law, angle.factor, angle.axis.toward) == ("cosine", 13.0, (0.0, 0.0, 1.0))
    assert (angle.axis.through, angle.point) == ("lower_arm_front", "lower_ball_joint")
    assert (rack.law, rack.factor, rack.axis.toward) == ("linear", 1.0, (0.0, -1.0, 0.0))
    assert (rack.axis.through, rack.point) == ("rack_centre", "tie_rod_inner")
