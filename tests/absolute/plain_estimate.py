"""The estimate of errors point by point and component by component: the plain form of `absolute.estimate`."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.estimate import SUMMED, TURNED, TURNED_TWICE, BodyMotion, Errors, fold
from absolute.mechanism import Mechanism
from absolute.precision import EPS
from absolute.rounding import ARM, length, pose_doubt, rate_doubt, second_doubt
from absolute.sensitivity import drift_by_pose, drift_by_velocity, rate_by_pose
from absolute.vectors import cross

Array = NDArray[np.float64]


class Doubt(NamedTuple):
    """How far each row of an equation may be off, (N, rows): what is left of it, and its rounding."""

    known: Array
    rounded: Array


class Answers(NamedTuple):
    """What the doubts of each row do to the moving bodies, [o, turn] and its rates.

    Attributes:
        direct: K, (N, rows, bodies, 2, 3): pose to p, velocity to t, acceleration to s.
        speed, second: -K H K: velocity to p; acceleration to p. bent: acceleration to t.
        pose, rate, rest: the doubts p, t, s themselves.
        grown: what the next orders multiply the errors of pose, velocity and acceleration by, (N,) each.
    """

    direct: Array
    speed: Array
    second: Array
    bent: Array
    pose: Doubt
    rate: Doubt
    rest: Doubt
    grown: tuple[Array, Array, Array]


def estimate(mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array, chassis: Array) -> Errors:
    """Errors of points and bodies at N solved instants.

    Args:
        motion: poses and rates of the bodies.
        series: inputs (N, 3, inputs). left: (N, 3, rows) what is left of the equations as computed.
        chassis: (N, 3, 3) what was added to positions, velocities and accelerations, mm.
    """
    answers = _answers(mechanism, motion, series, left)
    model = mechanism.model
    errors = Errors({}, {}, {}, {}, {}, {})
    for body, index in mechanism.drawing.bodies.items():
        for point in model.bodies[body]:
            if point in errors.position:
                continue
            if index:
                found = _point(mechanism, motion, answers, chassis, index, mechanism.drawing.arm(body, point))
            else:
                # The drawn place and the motion of the chassis: one sum.
                place = np.abs(np.array(model.points[point]) + chassis[:, 0])
                found = 0.5 * EPS * place, np.zeros_like(place), np.zeros_like(place)
            errors.position[point], errors.velocity[point], errors.acceleration[point] = found
        if index:
            part = (slice(None), slice(None), index - 1, 1)
            direct, speed, second, bent = (answer[part] for answer in answers[:4])
            turn, spin, spin1 = _totals(answers, direct, speed, second, bent)
            errors.rotation[body] = turn
            errors.angular_velocity[body], errors.angular_acceleration[body] = spin, spin1
    return errors


def _answers(mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array) -> Answers:
    stack = mechanism.stack
    placed = stack.place(motion.rotation, motion.origin)
    targets = mechanism.target_series(series)
    jacobian = stack.jacobian(placed)
    inverse = np.asarray(np.linalg.inv(jacobian), dtype=float)
    moving, bending = (stack.motion(placed, rates) for rates in (motion.velocity, motion.acceleration))
    speeds = motion.velocity[:, 1:].reshape(len(inverse), -1)
    pose = Doubt(np.abs(left[:, 0]), pose_doubt(mechanism, placed, targets[0]))
    by_velocity = drift_by_velocity(stack, moving)
    by_pose = rate_by_pose(stack, bending) + drift_by_pose(stack, moving)
    speed = -inverse @ rate_by_pose(stack, moving) @ inverse
    second = -inverse @ (by_pose @ inverse + by_velocity @ speed)
    bent = -inverse @ by_velocity @ inverse
    rate = Doubt(np.abs(left[:, 1]), rate_doubt(moving, targets[1]))
    grown = fold(mechanism, placed, inverse, pose.known + pose.rounded)
    # The drift is quadratic in the velocities: its next order is smaller by what these are off themselves.
    off = np.einsum("nij,nj->ni", np.abs(inverse), rate.known + rate.rounded)
    fastest = np.abs(speeds).max(axis=1)
    share = np.divide(off.max(axis=1), fastest, out=np.zeros_like(fastest), where=fastest > 0)
    return Answers(
        _by_row(inverse),
        _by_row(speed),
        _by_row(second),
        _by_row(bent),
        pose,
        rate,
        Doubt(np.abs(left[:, 2]), second_doubt(moving, bending, targets[2])),
        (grown[0], grown[1], grown[2] * (1.0 + share)),
    )


def _by_row(matrix: Array) -> Array:
    return matrix.swapaxes(-1, -2).reshape(len(matrix), matrix.shape[-1], -1, 2, 3)


def _point(
    mechanism: Mechanism, motion: BodyMotion, answers: Answers, chassis: Array, index: int, local: Array
) -> tuple[Array, Array, Array]:
    # p = o + r,  p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r), where r turns by turn x r.
    arm = motion.rotation[:, index] @ local
    rates = motion.velocity[:, index], motion.acceleration[:, index]
    r, w, w1 = arm[:, None], rates[0][:, None, 1], rates[1][:, None, 1]
    direct, speed, second, bent = (answer[:, :, index - 1] for answer in answers[:4])
    turned, sped, turning = cross(direct[:, :, 1], r), cross(speed[:, :, 1], r), cross(w, r)
    moved = cross(w, turned)
    found = _totals(
        answers,
        direct[:, :, 0] + turned,
        speed[:, :, 0] + sped + moved,
        second[:, :, 0]
        + cross(second[:, :, 1], r)
        + cross(w1, turned)
        + cross(w, moved)
        + cross(speed[:, :, 1], turning)
        + cross(w, sped),
        bent[:, :, 0] + cross(bent[:, :, 1], r) + cross(direct[:, :, 1], turning) + moved,
    )
    # What the sums themselves are rounded from.
    size = mechanism.drawing.size
    reach, fast, faster = (length(vector)[:, None] for vector in (arm, rates[0][:, 1], rates[1][:, 1]))
    place = motion.origin[:, index] + arm
    given = place * size + mechanism.drawing.middle
    position = (found[0] + ARM * reach + SUMMED * np.abs(place)) * size
    position += 0.5 * EPS * (np.abs(given) + np.abs(given + chassis[:, 0]))
    velocity = (found[1] + TURNED * fast * reach + SUMMED * np.abs(rates[0][:, 0])) * size
    turning_twice = (fast * fast + faster) * reach
    acceleration = (found[2] + TURNED_TWICE * turning_twice + SUMMED * np.abs(rates[1][:, 0])) * size
    velocity += 0.5 * EPS * np.abs(chassis[:, 1])
    acceleration += 0.5 * EPS * np.abs(chassis[:, 2])
    return position, velocity, acceleration


def _totals(
    answers: Answers, direct: Array, speed: Array, second: Array, bent: Array
) -> tuple[Array, Array, Array]:
    """Sums over the rows of magnitudes times doubts, for a quantity (N, rows, 3) and its rates."""
    p, t, s = answers.pose, answers.rate, answers.rest
    totals = (
        _summed(direct, p),
        _summed(speed, p) + _summed(direct, t),
        _summed(second, p) + _summed(bent, t) + _summed(direct, s),
    )
    position, velocity, acceleration = (
        total + _further(total, grown) for total, grown in zip(totals, answers.grown, strict=True)
    )
    return position, velocity, acceleration


def _further(total: Array, grown: Array) -> Array:
    # Higher orders lead anywhere, not where the first leads. Nothing stays nothing, however near the fold.
    largest = total.max(axis=1, keepdims=True)
    further: Array = np.multiply(largest, grown[:, None] - 1.0, out=np.zeros_like(largest), where=largest > 0)
    return further


def _summed(answer: Array, doubt: Doubt) -> Array:
    known = np.einsum("nrc,nr->nc", np.abs(answer), doubt.known)
    total: Array = known + np.sqrt(np.einsum("nrc,nr->nc", answer * answer, doubt.rounded * doubt.rounded))
    return total
