"""Where the strut can go: the limits are found, refused beyond, and the branch is kept up to them."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import Kind
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
Held = Callable[[float, float], dict[str, Array]]


def arm_limits(table: dict[str, tuple[float, float, float]]) -> tuple[float, float]:
    """Arm angles where the ball joint is at the top and at the bottom of its circle.

    With u the pivot axis and d the arm from its front point, the circle has its centre at
    u (u . d) and the radius |d - u (u . d)|; its heights are u_z (u . d) +- radius sqrt(1 - u_z^2).
    """
    front, rear, ball = (
        np.array(table[n]) for n in ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
    )
    u = (rear - front) / np.linalg.norm(rear - front)
    d = ball - front
    centre = float(u @ d)
    radius = float(np.linalg.norm(d - centre * u)) * float(np.sqrt(1 - u[2] ** 2))
    length = float(np.linalg.norm(d))
    return float(np.arccos((u[2] * centre + radius) / length)), float(
        np.arccos((u[2] * centre - radius) / length)
    )


def test_arm_angle_is_reached_up_to_the_ends_of_the_circle_of_the_ball_joint(
    strut: absolute.Model, table: dict[str, tuple[float, float, float]], held: Held
) -> None:
    low, high = arm_limits(table)
    for inside in (low + 1e-3, high - 1e-3, np.radians(32.8), np.radians(151.8)):
        motion = absolute.solve(strut, held(inside, 0.0))
        assert motion.residual[0] < 1e-10
    for outside in (low - 1e-3, high + 1e-3):
        with pytest.raises(absolute.UnreachableError) as caught:
            absolute.solve(strut, held(outside, 0.0))
        limit = low if outside < low else high
        # At distance e from a fold the condition number grows as 1 / sqrt(e); it is followed up to
        # 1 / sqrt(eps), hence to e of the order of eps times constants of the mechanism.
        assert abs(caught.value.reached["arm_angle"] - limit) < 1e-10
        assert caught.value.inputs["arm_angle"] == outside


@pytest.mark.parametrize(("inside", "outside"), [(-88.5, -89.5), (129.5, 130.5)])
def test_rack_is_reached_just_inside_and_refused_just_outside(
    strut: absolute.Model, held: Held, inside: float, outside: float
) -> None:
    assert absolute.solve(strut, held(np.pi / 2, inside)).residual[0] < 1e-10
    with pytest.raises(absolute.UnreachableError, match=r"locks at .* rack"):
        absolute.solve(strut, held(np.pi / 2, outside))


@pytest.mark.parametrize("rack", [-88.5, 129.5])
def test_branch_is_kept_next_to_a_limit_and_back(strut: absolute.Model, rack: float) -> None:
    racks = np.array([0.0, rack, 0.0])
    inputs = {
        "arm_angle": np.tile([np.pi / 2, 0.0, 0.0], (3, 1)),
        "rack": np.stack([racks, 0 * racks, 0 * racks], -1),
    }
    motion = absolute.solve(strut, inputs)
    # Back at the start, to rounding of a pose with condition number below 60 and size 500 mm.
    back = motion.position["wheel_centre"]
    assert np.allclose(back[0], back[2], rtol=0, atol=2 * np.finfo(float).eps * 500 * 60)


def test_coarse_and_fine_sweeps_stay_on_one_branch(strut: absolute.Model) -> None:
    def sweep(count: int) -> Array:
        angles = np.radians(np.linspace(33.0, 151.5, count))
        inputs = {"arm_angle": np.stack([angles, 0 * angles, 0 * angles], -1), "rack": np.zeros((count, 3))}
        return np.asarray(absolute.solve(strut, inputs, rates=False).position["wheel_centre"])

    fine = sweep(241)
    for every in (2, 60, 240):
        # Condition number about 400 at the ends, size 500 mm.
        assert np.allclose(
            sweep(240 // every + 1), fine[::every], rtol=0, atol=2 * np.finfo(float).eps * 500 * 400
        )


@settings(max_examples=15, deadline=None)
@given(data=st.data(), count=st.integers(2, 6))
def test_jumping_about_gives_the_pose_that_going_there_directly_gives(
    kind: Kind, model: absolute.Model, held: Held, data: st.DataObject, count: int
) -> None:
    poses = [tuple(data.draw(st.floats(*ends)) for ends in kind.span) for _ in range(count)]
    angles, racks = np.radians([p[0] for p in poses]), np.array([p[1] for p in poses])
    still = np.zeros_like(racks)
    inputs = {"arm_angle": np.stack([angles, still, still], -1), "rack": np.stack([racks, still, still], -1)}
    jumping = absolute.solve(model, inputs, rates=False)
    for k, (angle, rack) in enumerate(zip(angles, racks, strict=True)):
        direct = absolute.solve(model, held(float(angle), float(rack)), rates=False, conditions=True)
        assert direct.condition is not None
        # Two roundings of a pose of size 500 mm.
        tolerance = 2 * np.finfo(float).eps * 500 * max(60.0, direct.condition[0])
        for name in model.points:
            assert np.allclose(jumping.position[name][k], direct.position[name][0], rtol=0, atol=tolerance)


def test_a_failing_sweep_keeps_what_was_solved(model: absolute.Model) -> None:
    racks = np.array([0.0, 20.0, 40.0, 500.0, 0.0])
    inputs = {
        "arm_angle": np.tile([np.pi / 2, 0.0, 0.0], (5, 1)),
        "rack": np.stack([racks, 0 * racks, 0 * racks], -1),
    }
    with pytest.raises(absolute.UnreachableError, match="instant 3") as caught:
        absolute.solve(model, inputs, conditions=True)
    assert caught.value.instant == 3
    partial = caught.value.partial
    assert partial is not None
    whole = absolute.solve(model, {name: series[:3] for name, series in inputs.items()}, conditions=True)
    assert partial.condition is not None
    assert len(partial.condition) == len(partial.iterations) == 3
    for name in model.points:
        assert (partial.position[name] == whole.position[name]).all()
        assert (partial.acceleration[name] == whole.acceleration[name]).all()


def test_a_failure_at_the_first_instant_has_nothing_to_keep(model: absolute.Model, held: Held) -> None:
    with pytest.raises(absolute.UnreachableError) as caught:
        absolute.solve(model, held(np.pi / 2, 1000.0))
    assert caught.value.partial is None


@pytest.mark.parametrize("value", [1e6, -1e12, 1e200, -1.7e308])
def test_absurd_inputs_are_refused_not_chased(model: absolute.Model, held: Held, value: float) -> None:
    with pytest.raises(absolute.UnreachableError):
        absolute.solve(model, held(np.pi / 2, value))
