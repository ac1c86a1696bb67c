"""Rows, their Jacobian and their drift, against differences and against Pinocchio's own anchors."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import matrix, mp, mpf

import absolute
from absolute.continue_to import continue_to
from absolute.drawing import Drawing
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import accelerations
from absolute.rounding import second_doubt
from absolute.rows import joint_frames
from absolute.sensitivity import drift_by_pose, drift_by_velocity, rate_by_pose

EPS = np.finfo(float).eps

# Rows [translation; rotation] of a frame anchor that each joint keeps, and the sign of its rotation.
ANCHOR_ROWS = {"spherical": [0, 1, 2], "revolute": [0, 1, 2, 3, 4], "prismatic": [0, 1, 3, 4, 5]}


def configuration(mechanism: Mechanism, seed: int, far: float) -> np.ndarray:
    step = np.random.default_rng(seed).normal(size=mechanism.pin_model.nv) * far
    return mechanism.moved(mechanism.drawn, mechanism.poses(mechanism.drawn).rotation, step)


def body_rates(
    velocity: np.ndarray, acceleration: np.ndarray, rotation: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rates [o', w], [o'', w'] in world axes as Pinocchio's, in body axes and spatial: o'' - w x o'."""
    twist, spatial = velocity.reshape(-1, 2, 3), acceleration.reshape(-1, 2, 3).copy()
    spatial[:, 0] -= np.cross(twist[:, 1], twist[:, 0])
    return (twist @ rotation).ravel(), (spatial @ rotation).ravel()


def placement_error(placement: pin.SE3) -> np.ndarray:
    """Translation and (-R12, R02, R10): what the rows of an anchor measure."""
    turn = placement.rotation
    return np.array([*placement.translation, -turn[1, 2], turn[0, 2], turn[1, 0]])


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_jacobian_is_the_derivative_of_the_rows_on_the_manifold(strut: absolute.Model, seed: int) -> None:
    mechanism = Mechanism(strut)
    q = configuration(mechanism, seed, 0.5)
    poses = mechanism.poses(q)
    jacobian = mechanism.stack.jacobian(mechanism.stack.place(*poses))
    direction = np.random.default_rng(seed + 1).normal(size=mechanism.pin_model.nv)
    direction /= np.linalg.norm(direction)
    h = 1e-5

    def values(step: float) -> np.ndarray:
        return mechanism.stack.place(
            *mechanism.poses(mechanism.moved(q, poses.rotation, step * direction))
        ).values

    slope = (values(h) - values(-h)) / (2 * h)
    # Truncation h^2 / 6 times a third derivative below 100, and rounding of two values over 2 h.
    assert np.abs(slope - jacobian @ direction).max() < 100 * h**2 / 6 + 8 * EPS / h


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_drift_is_the_second_derivative_along_a_steady_turn(strut: absolute.Model, seed: int) -> None:
    # Origins move straight, bodies turn steadily: no body accelerates, so the rows' second
    # derivative over time is the drift alone.
    mechanism = Mechanism(strut)
    poses = mechanism.poses(configuration(mechanism, seed, 0.5))
    rng = np.random.default_rng(seed + 1)
    velocity, spin = rng.normal(size=(2, len(poses.origin), 3)) / 3
    velocity[0] = spin[0] = 0.0
    stack = mechanism.stack
    h = 1e-4

    def values(t: float) -> np.ndarray:
        turned = np.array([pin.exp3(t * w) @ r for w, r in zip(spin, poses.rotation, strict=True)])
        return stack.place(turned, poses.origin + t * velocity).values

    bend = (values(h) - 2 * values(0.0) + values(-h)) / h**2
    drift = stack.drift(stack.place(*poses), np.stack((velocity, spin), axis=1))
    # Truncation h^2 / 12 times a fourth derivative below 1000, and rounding of four values over h^2.
    assert np.abs(bend - drift).max() < 1000 * h**2 / 12 + 8 * EPS / h**2


@pytest.mark.parametrize("goal", [(1.0, 0.0), (1.6, 40.0), (2.2, -30.0)])
def test_joint_rows_are_those_of_pinocchio_frame_anchors(
    strut: absolute.Model, goal: tuple[float, float]
) -> None:
    mechanism = Mechanism(strut)
    pose, _ = assemble(mechanism)
    pose, _ = continue_to(mechanism, pose, mechanism.drawn_inputs.tolist(), list(goal), 0)
    model, drawing = mechanism.pin_model, Drawing(strut)
    rate = np.zeros(mechanism.stack.count)
    rate[mechanism.joint_rows :] = 0.3, -0.2
    velocity, acceleration = accelerations(mechanism, pose, rate, np.zeros_like(rate))
    local, local_acceleration = body_rates(velocity, acceleration, pose.poses.rotation[1:])
    data = model.createData()
    pin.forwardKinematics(model, data, pose.q, local, local_acceleration)
    pin.computeJointJacobians(model, data, pose.q)
    checked = set()
    for name, joint in strut.joints.items():
        if joint.kind not in ANCHOR_ROWS:
            continue
        placements = []
        for body, axis, frame in zip(
            (joint.first, joint.second),
            (joint.on_first, joint.on_second),
            joint_frames(name, joint, drawing),
            strict=True,
        ):
            placements += [drawing.bodies[body], pin.SE3(frame.T.copy(), drawing.arm(body, axis.through))]
        anchor = pin.FrameAnchorConstraintModel(model, *placements)
        anchor_data = anchor.createData()
        anchor.calc(model, data, anchor_data)
        rows = ANCHOR_ROWS[joint.kind]
        jacobian = anchor.jacobian(model, data, anchor_data)[rows]
        # The rows hold to rounding at an assembled pose; then so do their first and second rates,
        # whose terms are larger by the speeds of the bodies.
        fast = max(1.0, float(np.abs(local).max()))
        furious = max(fast**2, float(np.abs(local_acceleration).max()))
        assert np.abs(placement_error(anchor_data.c1Mc2)[rows]).max() < 64 * EPS
        assert np.abs(jacobian @ local).max() < 64 * EPS * fast
        assert np.abs(anchor_data.constraint_velocity_error[rows]).max() < 64 * EPS * fast
        assert np.abs(anchor_data.constraint_acceleration_error[rows]).max() < 64 * EPS * furious
        own = [k for k, owner in enumerate(mechanism.stack.owners) if owner == name]
        mine = mechanism.stack.jacobian(pose.placed)[own]
        back = np.zeros((len(local), len(local)))
        for k, turn in enumerate(pose.poses.rotation[1:]):
            back[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = back[
                6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6
            ] = turn
        # The same constraints: the two sets of rows span the same space.
        stacked = np.vstack([jacobian, mine @ back])
        singular = np.linalg.svd(stacked, compute_uv=False)
        assert singular[len(rows) - 1] > 1e-3
        assert singular[len(rows)] < 64 * EPS * singular[0]
        checked.add(joint.kind)
    assert checked == set(ANCHOR_ROWS)


def test_point_rates_are_those_of_pinocchio(strut: absolute.Model) -> None:
    angle, rack = (1.3, 0.4, -0.7), (20.0, -60.0, 90.0)
    motion = absolute.solve(strut, {"arm_angle": np.array([angle]), "rack": np.array([rack])})
    mechanism = Mechanism(strut)
    drawing = mechanism.drawing
    pose, _ = assemble(mechanism)
    pose, _ = continue_to(mechanism, pose, mechanism.drawn_inputs.tolist(), [angle[0], rack[0]], 0)
    _, rate, second = mechanism.target_series(np.transpose([angle, rack])[None])[:, 0]
    velocity, acceleration = accelerations(mechanism, pose, rate, second)
    local, local_acceleration = body_rates(velocity, acceleration, pose.poses.rotation[1:])
    model = mechanism.pin_model
    frames = {
        point: model.addFrame(
            pin.Frame(point, drawing.bodies[body], pin.SE3(np.eye(3), drawing.arm(body, point)), pin.OP_FRAME)
        )
        for body in strut.moving
        for point in strut.bodies[body]
        if point not in strut.bodies[strut.chassis]
    }
    data = model.createData()
    pin.forwardKinematics(model, data, pose.q, local, local_acceleration)
    for point, frame in frames.items():
        world = pin.LOCAL_WORLD_ALIGNED
        moved = pin.getFrameVelocity(model, data, frame, world).linear * drawing.size
        bent = pin.getFrameClassicalAcceleration(model, data, frame, world).linear * drawing.size
        # A few products of numbers of the size of the mechanism; points shared by two bodies
        # differ by the rounding of the solver, condition number below 60.
        assert np.allclose(moved, motion.velocity[point][0], rtol=0, atol=60 * EPS * 500)
        assert np.allclose(bent, motion.acceleration[point][0], rtol=0, atol=60 * EPS * 500)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_sensitivities_are_the_derivatives_of_rates_and_drift(strut: absolute.Model, seed: int) -> None:
    mechanism = Mechanism(strut)
    stack, q = mechanism.stack, configuration(mechanism, seed, 0.5)
    rotation = mechanism.poses(q).rotation
    rng = np.random.default_rng(seed + 1)
    way, push = rng.normal(size=(2, stack.count)) / 3
    rates = np.zeros((len(rotation), 2, 3))
    rates[1:] = rng.normal(size=(len(rotation) - 1, 2, 3)) / 3
    placed = stack.place(*mechanism.poses(q))
    motion = stack.motion(placed, rates)
    h = 1e-5

    def at(step: float, faster: float) -> tuple[np.ndarray, np.ndarray]:
        there = stack.place(*mechanism.poses(mechanism.moved(q, rotation, step * way)))
        moving = rates.copy()
        moving[1:] += faster * push.reshape(-1, 2, 3)
        rate = stack.jacobian(there) @ moving[1:].ravel()
        return rate, stack.drift(there, moving)

    # Truncation h^2 / 6 times a third derivative below 1000, and rounding of two values over 2 h.
    tolerance = 1000 * h**2 / 6 + 8 * EPS / h
    (rate, drift), (rate_back, drift_back) = at(h, 0.0), at(-h, 0.0)
    assert np.abs((rate - rate_back) / (2 * h) - rate_by_pose(stack, motion) @ way).max() < tolerance
    assert np.abs((drift - drift_back) / (2 * h) - drift_by_pose(stack, motion) @ way).max() < tolerance
    faster = (at(0.0, h)[1] - at(0.0, -h)[1]) / (2 * h)
    assert np.abs(faster - drift_by_velocity(stack, motion) @ push).max() < tolerance


@pytest.mark.parametrize("seed", range(10))
def test_the_drift_is_rounded_no_more_than_its_terms_say(strut: absolute.Model, seed: int) -> None:
    # Bodies that turn evenly: nothing but the drift is in the equation of the accelerations.
    mechanism = Mechanism(strut)
    stack = mechanism.stack
    placed = stack.place(*(part[None] for part in mechanism.poses(configuration(mechanism, seed, 0.5))))
    rates = np.random.default_rng(seed).normal(size=(1, len(mechanism.drawing.bodies), 2, 3))
    rates[:, 0] = 0.0
    moving, still = stack.motion(placed, rates), stack.motion(placed, np.zeros_like(rates))
    drift = stack.drift(placed, rates)
    doubt = second_doubt(moving, still, drift)
    with mp.workdps(40):
        for row in range(stack.count):
            a, e, r1, r2, w1, w2, s1, s2 = (matrix(part[0, row].tolist()) for part in moving[:8])
            a1, e1 = times(w1, a), s2 + times(w2, r2) - s1 - times(w1, r1)
            e2 = times(w2, times(w2, r2)) - times(w1, times(w1, r1))
            exact = (times(w1, a1).T * e + 2 * a1.T * e1 + a.T * e2)[0]
            if row in stack.distances:
                along = (a.T * e1)[0]
                exact = (a.T * e2)[0] + ((e1.T * e1)[0] - along * along) / mp.norm(e)
            assert abs(exact - mpf(float(drift[0, row]))) <= doubt[0, row]


def times(a: matrix, b: matrix) -> matrix:
    return matrix([a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)])


def test_rates_of_targets_are_their_derivatives(strut: absolute.Model) -> None:
    mechanism = Mechanism(strut)
    start, rate, second = np.random.default_rng(4).normal(size=(3, 2)) * [0.5, 50.0] + [[1.6, 0.0]]
    h = 1e-4
    t = np.array([-h, 0.0, h])[:, None]
    series = np.stack((start + rate * t + second * t * t / 2.0, rate + second * t, second + 0.0 * t), axis=1)
    before, here, after = mechanism.target_series(series)[..., mechanism.joint_rows :].swapaxes(0, 1)
    # Truncation h^2 / 6 times a third derivative below 1000, and rounding of two values over 2 h.
    change = (after - before)[:2] / (2.0 * h)
    assert np.abs(change - here[1:]).max() < 1000.0 * h**2 / 6.0 + 8.0 * EPS / h
    # One instant after the other is the same.
    steady = mechanism.targets(start, rate)
    together = mechanism.target_series(np.tile(np.stack((start, rate, 0.0 * rate)), (3, 1, 1)))
    assert all(np.array_equal(steady, together[:, k]) for k in range(3))


def test_one_number_is_never_spread_over_several_inputs(strut: absolute.Model) -> None:
    mechanism = Mechanism(strut)
    two = mechanism.drawn_inputs.tolist()
    with pytest.raises(ValueError, match="zip"):
        mechanism.target_series(np.zeros((1, 3, 1)))
    for values in (two[:1], [*two, 0.0]):
        with pytest.raises(ValueError, match="zip"):
            mechanism.named(values)
