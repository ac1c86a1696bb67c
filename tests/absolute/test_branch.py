"""Of the up to sixteen assemblies of a strut, the one that the drawing's signs name, or a refusal."""

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import closed_form as closed
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import Kind
from numpy.typing import NDArray

import absolute
import absolute.tracking
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import seek
from absolute.tracking import Rough, rough_of

Array = NDArray[np.float64]
Table = dict[str, tuple[float, float, float]]
Held = Callable[[float, float], dict[str, Array]]
EPS = np.finfo(float).eps
HERE = Path(__file__).parent


@pytest.mark.parametrize("case", json.loads((HERE / "branch_cases.json").read_text()))
def test_certified_poses_of_badly_drawn_cars_are_found(case: dict[str, Any]) -> None:
    inputs = {name: np.array([value]) for name, value in case["inputs"].items()}
    motion = absolute.solve(absolute.macpherson(case["points"], closure="collinear"), inputs, conditions=True)
    assert motion.condition is not None
    for name, expected in case["expected_position_without_heave"].items():
        # Rounding of a car of 500 mm, magnified by the condition number, on both sides.
        tolerance = 2 * EPS * 500 * motion.condition[0]
        assert np.allclose(motion.position[name][0], expected, rtol=0, atol=tolerance)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_random_cars_stand_where_circles_and_spheres_meet_or_are_refused(
    table: Table, held: Held, seed: int
) -> None:
    car = closed.random_car(table, seed)
    angle, rack = closed.drawn_inputs(car)
    random = np.random.default_rng(seed)
    goal = angle + random.uniform(-0.15, 0.15), rack + random.uniform(-20.0, 20.0)
    expected = closed.closed_form(car, *goal)
    try:
        motion = absolute.solve(
            absolute.macpherson(car, closure="collinear"), held(*goal), rates=False, conditions=True
        )
    except absolute.PoseError:
        # Refused only where the drawing or the goal is beyond a limit, or so near that the
        # condition number, about 1 / sqrt(margin), hides it.
        drawn = closed.closed_form(car, angle, rack)
        assert expected is None or drawn is None or min(expected[1], drawn[1]) < 1e-6
        return
    assert expected is not None
    assert motion.condition is not None
    for name, point in expected[0].items():
        # The closed form loses digits where a root or a quotient is small, as the condition does.
        tolerance = 16 * EPS * 1000 * motion.condition[0]
        assert np.allclose(motion.position[name][0], point, rtol=0, atol=tolerance), name


@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_drawing_an_assembled_pose_instead_gives_the_same_motion(
    kind: Kind, model: absolute.Model, held: Held, data: st.DataObject
) -> None:
    angle, rack = (data.draw(st.floats(*ends)) for ends in kind.span)
    pose = absolute.solve(model, held(np.radians(angle), rack), conditions=True)
    redrawn = kind.build({name: point[0] for name, point in pose.position.items()})
    goal = held(1.4, 10.0)
    again = absolute.solve(redrawn, goal, conditions=True)
    direct = absolute.solve(model, goal)
    assert pose.condition is not None
    assert again.condition is not None
    # The drawn lengths carry the rounding of the pose that was drawn.
    tolerance = 4 * EPS * 500 * pose.condition[0] * again.condition[0]
    for name in kind.car:
        assert np.allclose(again.position[name], direct.position[name], rtol=0, atol=tolerance)


def test_a_drawing_at_the_dead_point_of_its_tie_rod_has_no_branch(table: Table, held: Held) -> None:
    ball, low, inner = (np.array(table[n]) for n in ("lower_ball_joint", "strut_lower", "tie_rod_inner"))
    flat = {**table, "tie_rod_outer": tuple((ball + 0.8 * (low - ball) + 0.3 * (inner - ball)).tolist())}
    with pytest.raises(absolute.BranchError, match=r"no branch.*tie rod beside the kingpin") as caught:
        absolute.solve(absolute.macpherson(flat, closure="collinear"), held(1.6, 0.0))
    assert caught.value.instant is None
    assert abs(caught.value.drawn) < 16 * EPS


def test_a_drawing_with_its_ball_joint_above_the_arm_axis_has_no_branch(table: Table, held: Held) -> None:
    front, rear = np.array(table["lower_arm_front"]), np.array(table["lower_arm_rear"])
    ball = 0.5 * (front + rear) - np.array([0.0, 0.0, 40.0])
    low = 0.9 * ball + 0.1 * np.array(table["strut_top"])
    with pytest.raises((absolute.BranchError, absolute.SingularError)):
        absolute.solve(
            absolute.macpherson({**table, "lower_ball_joint": ball, "strut_lower": low}, closure="collinear"),
            held(1.6, 0.0),
        )


def other_branch(strut: absolute.Model, angle: float) -> Rough:
    """A pose of the same bodies at the same inputs on another branch."""
    mechanism = Mechanism(strut)
    pose, _ = assemble(mechanism)
    target = mechanism.targets([angle, 0.0], [0.0, 0.0], [0.0, 0.0])[0]
    random = np.random.default_rng(0)
    while True:
        step = random.normal(size=mechanism.stack.count)
        found = seek(mechanism, mechanism.moved(pose.q, pose.poses.rotation, step), target)
        if found is not None and not mechanism.branch_signs.kept(found.placed.world):
            return rough_of(found)


@pytest.mark.parametrize("times", [1, 1000])
def test_a_jump_to_another_branch_on_the_way_is_undone_or_refused(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, times: int
) -> None:
    angles = np.linspace(1.4, 1.5, 11)
    inputs = {"arm_angle": np.stack([angles, 0 * angles, 0 * angles], -1), "rack": np.zeros((11, 3))}
    expected = absolute.solve(strut, inputs)
    wrong = other_branch(strut, float(angles[5]))
    glide, continue_to = absolute.tracking.glide, absolute.tracking.continue_to
    calls = {"glide": 0, "jumps": 0}

    def jumping(*arguments: Any) -> Rough | None:
        calls["glide"] += 1
        # The first instant, then instants 1 to 4, are reached without a fault.
        if calls["glide"] == 6:
            calls["jumps"] += 1
            return wrong
        return glide(*arguments)

    def jumping_continue_to(mechanism: Mechanism, *arguments: Any) -> Any:
        pose, spent = continue_to(mechanism, *arguments)
        if 0 < calls["jumps"] < times:
            return pose._replace(q=wrong.q), spent
        return pose, spent

    # Instant by instant: there are no runs as long as this.
    monkeypatch.setattr(absolute.tracking, "SHORTEST_RUN", 1000)
    monkeypatch.setattr(absolute.tracking, "glide", jumping)
    monkeypatch.setattr(absolute.tracking, "continue_to", jumping_continue_to)
    if times == 1:
        motion = absolute.solve(strut, inputs)
        for name in strut.points:
            assert np.allclose(
                motion.position[name], expected.position[name], rtol=0, atol=2 * EPS * 500 * 60
            )
    else:
        with pytest.raises(absolute.BranchError, match=r"instant 5.*not on the branch") as caught:
            absolute.solve(strut, inputs)
        assert caught.value.drawn * caught.value.found < 0
        assert caught.value.partial is not None
        for name in strut.points:
            assert np.allclose(caught.value.partial.position[name], expected.position[name][:5], atol=1e-10)
    assert calls["jumps"] == 1


@pytest.mark.parametrize(
    ("vectors", "say"),
    [
        ((("lower_ball_joint", "strut_top"),), "two or three"),
        ((("lower_ball_joint", "nowhere"), (0.0, 0.0, 1.0)), "nowhere"),
        (((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)), "not be zero"),
        (((0.0, np.nan, 0.0), (0.0, 0.0, 1.0)), "finite"),
    ],
)
def test_branch_signs_are_checked(strut: absolute.Model, vectors: Any, say: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=say):
        dataclasses.replace(strut, branch_signs={"lean": absolute.BranchSign(vectors)})


def test_branch_signs_do_not_depend_on_units_of_their_directions(table: Table) -> None:
    for scale in (1e-200, 1.0, 1e200):
        model = absolute.macpherson(table, up=(0.0, 0.0, scale), closure="collinear")
        mechanism = Mechanism(model)
        assert (np.abs(mechanism.branch_signs.drawn) <= 1.0).all()
        assert (
            mechanism.branch_signs.wanted
            == np.sign(Mechanism(absolute.macpherson(table, closure="collinear")).branch_signs.drawn)
        ).all()


@pytest.mark.parametrize("told", [True, False])
def test_a_long_way_close_by_a_fold_does_not_cross_it(
    table: Table, strut: absolute.Model, held: Held, told: bool
) -> None:
    # Straight to this goal the motion passes a fold so close that Newton converges beyond it: only
    # the sign of the determinant tells, where a model has no branch signs.
    goal = 0.5714841988334616, -27.604730159848856
    model = strut if told else dataclasses.replace(strut, branch_signs={})
    expected = closed.closed_form({name: np.array(point) for name, point in table.items()}, *goal)
    assert expected is not None
    try:
        motion = absolute.solve(model, held(*goal), rates=False, conditions=True)
    except absolute.UnreachableError:
        return
    assert motion.condition is not None
    tolerance = 16 * EPS * 500 * motion.condition[0]
    for name, point in expected[0].items():
        assert np.allclose(motion.position[name][0], point, rtol=0, atol=tolerance), name
