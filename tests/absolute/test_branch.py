"""Of the up to sixteen assemblies of a strut, the one that belongs to the drawing, or a refusal."""

from collections.abc import Callable
from typing import Any

import closed_form as closed
import numpy as np
import pytest
from flat import built_in
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import Kind
from numpy.typing import NDArray

import absolute
import absolute.follow
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Configurations, configurations_at, newton

Array = NDArray[np.float64]
Table = dict[str, tuple[float, float, float]]
Held = Callable[[float, float], dict[str, Array]]
EPS = np.finfo(float).eps


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
            built_in("macpherson", car, closure="collinear"), held(*goal), rates=False, conditions=True
        )
    except absolute.PoseError:
        # Beyond a limit, or behind one on the way from a drawing that does not close.
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


def test_a_drawing_with_its_ball_joint_above_the_arm_axis_has_no_branch(table: Table, held: Held) -> None:
    front, rear = np.array(table["lower_arm_front"]), np.array(table["lower_arm_rear"])
    ball = 0.5 * (front + rear) - np.array([0.0, 0.0, 40.0])
    low = 0.9 * ball + 0.1 * np.array(table["strut_top"])
    with pytest.raises(absolute.PoseError):
        absolute.solve(
            built_in(
                "macpherson", {**table, "lower_ball_joint": ball, "strut_lower": low}, closure="collinear"
            ),
            held(1.6, 0.0),
        )


def other_branch(strut: absolute.Model, angle: float) -> Configurations:
    """A pose of the same bodies at the same inputs on another branch."""
    mechanism = Mechanism(strut)
    pose = assemble(mechanism)
    target = mechanism.targets(np.array([angle, 0.0]))[0]
    random = np.random.default_rng(0)
    while True:
        q = mechanism.moved(pose.q, pose.rotation, random.normal(size=(1, mechanism.stack.count)))
        for _ in range(30):
            near = configurations_at(mechanism, q, target)
            step = np.matvec(near.inverse, mechanism.stack.gap(near.placed, target))
            q = mechanism.moved(q, near.rotation, step)
        found = configurations_at(mechanism, q, target)
        if found.closed and (found.signs != pose.signs).any() and mechanism.stack.kept(found.placed):
            return found


@pytest.mark.parametrize("times", [1, 1000])
def test_a_jump_to_another_branch_on_the_way_is_undone_or_refused(
    strut: absolute.Model, monkeypatch: pytest.MonkeyPatch, times: int
) -> None:
    angles = np.linspace(1.4, 1.5, 11)
    inputs = {"arm_angle": np.stack([angles, 0 * angles, 0 * angles], -1), "rack": np.zeros((11, 3))}
    expected = absolute.solve(strut, inputs)
    wrong = other_branch(strut, float(angles[5]))
    sixth = Mechanism(strut).targets(np.array([angles[5], 0.0]))[0]
    jumps = 0

    def jumping(mechanism: Mechanism, near: Any, q: Array, target: Array, largest: Array) -> Configurations:
        nonlocal jumps
        found = newton(mechanism, near, q, target, largest)
        place = np.flatnonzero((target[: len(found.q)] == sixth).all(axis=1))
        if place.size and jumps < times:
            jumps += 1
            led = found.q.copy()
            led[place] = wrong.q
            found = configurations_at(mechanism, led, target[: len(led)], found.corrections)
            assert found.closed.all()
        return found

    monkeypatch.setattr(absolute.follow, "newton", jumping)
    if times == 1:
        motion = absolute.solve(strut, inputs)
        for name in strut.points:
            assert np.allclose(
                motion.position[name], expected.position[name], rtol=0, atol=2 * EPS * 500 * 60
            )
    else:
        with pytest.raises(absolute.PoseError, match="instant 5") as caught:
            absolute.solve(strut, inputs)
        assert caught.value.partial is not None
        for name in strut.points:
            assert np.allclose(caught.value.partial.position[name], expected.position[name][:5], atol=1e-10)
    assert jumps >= 1


def test_a_long_way_close_by_a_fold_does_not_cross_it(
    table: Table, strut: absolute.Model, held: Held
) -> None:
    # Straight to this goal the motion passes a fold so close that Newton converges beyond it: only
    # the sign of the determinant tells.
    goal = 0.5714841988334616, -27.604730159848856
    expected = closed.closed_form({name: np.array(point) for name, point in table.items()}, *goal)
    assert expected is not None
    try:
        motion = absolute.solve(strut, held(*goal), rates=False, conditions=True)
    except absolute.UnreachableError:
        return
    assert motion.condition is not None
    tolerance = 16 * EPS * 500 * motion.condition[0]
    for name, point in expected[0].items():
        assert np.allclose(motion.position[name][0], point, rtol=0, atol=tolerance), name
