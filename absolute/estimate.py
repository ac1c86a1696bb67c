r"""How far each returned quantity may be from the exact one, point by point and component by component.

With K = J^-1, the doubts p, t, s of the three equations (see `rounding`) and changes of first order,
    dq = K p,    dv = K (t - H dq),    da = K (s - D dq - G dv),
H = d(J v)/dq, D = d(J a + drift)/dq, G = d(drift)/dv. Every error of a point or a body is a linear function
of p, t and s, and its estimate a sum of the magnitudes of its coefficients times the doubts, so that no
component answers for the sensitivity of another. Near a dead point more than the first order counts:
see `fold`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from absolute.mechanism import Mechanism
from absolute.precision import EPS
from absolute.rounding import ARM, length, pose_doubt, rate_doubt, second_doubt, spread
from absolute.sensitivity import drift_by_pose, drift_by_velocity, rate_by_pose
from absolute.solution import Array
from absolute.stack import Placed
from absolute.vectors import cross

# v @ WHEEL is the matrix of "x v", row by row: a product with it is  x @ wheel(v) = v x x.
WHEEL = np.array([np.cross(axis, np.eye(3)).ravel() for axis in np.eye(3)])

# A turned arm has 13 roundings; each product with an angular velocity adds three.
TURNED = spread(13 + 3)
TURNED_TWICE = spread(13 + 6)
# A sum of three terms and its product with the size: four roundings of eps / 2 at worst.
SUMMED = 4 * EPS / 2


class BodyMotion(NamedTuple):
    """Poses and rates of all bodies, the chassis first, in units of size.

    Attributes:
        rotation: (N, bodies, 3, 3). origin: (N, bodies, 3).
        velocity, acceleration: [o', w], [o'', w'], (N, bodies, 2, 3).
    """

    rotation: Array
    origin: Array
    velocity: Array
    acceleration: Array


class Errors(NamedTuple):
    """Estimates for N instants, mm, rad and s.

    Attributes:
        position, velocity, acceleration: point name -> (N, 3).
        rotation, angular_velocity, angular_acceleration: moving body name -> (N, 3).
    """

    position: dict[str, Array]
    velocity: dict[str, Array]
    acceleration: dict[str, Array]
    rotation: dict[str, Array]
    angular_velocity: dict[str, Array]
    angular_acceleration: dict[str, Array]


class Sensitivity(NamedTuple):
    """What the doubts of the rows do at N instants to the turn of each moving body and to its points.

    Attributes:
        lengths: (4, N, rows, 3 * of these) per doubt of each row, side by side in the order of `places_of`:
            a quantity to its own equation's doubt, its rate to that of the pose, its second rate to that of
            the pose and to that of the rates.
        rounded: (3, N, 3 * of these) errors of quantities and their rates by what is rounded.
        grown: (3, N) what the next orders multiply the errors of pose, velocity and acceleration by.
    """

    lengths: Array
    rounded: Array
    grown: Array


def totals(mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array) -> tuple[Array, Sensitivity]:
    """(3, N, 3 * of these) errors of all turns and points, without what sums of these round, in units of
    size, and what they are made of.

    Args:
        motion: poses and rates of the bodies at N solved instants.
        series: inputs (N, 3, inputs). left: (N, 3, rows) what is left of the equations as computed.
    """
    answers, rounded, grown = _answers(mechanism, motion, series, np.abs(left))
    places = enumerate(places_of(mechanism, motion.rotation), 1)
    lengths = np.concatenate([_lengths(answers, motion, index, arms) for index, (_, arms) in places], axis=-1)
    made = Sensitivity(lengths, by_row(np.sqrt, rounded * rounded, lengths * lengths), grown)
    return further(by_row(np.asarray, np.abs(left), np.abs(lengths)) + made.rounded, grown), made


def places_of(mechanism: Mechanism, rotation: Array) -> list[tuple[list[str], Array]]:
    """Of each moving body the points it is the first to hold, and their arms (N, points, 3)."""
    drawing, told, found = mechanism.drawing, set[str](), []
    for body, index in drawing.bodies.items():
        points = [point for point in mechanism.model.bodies[body] if point not in told]
        told.update(points)
        if index:
            local = np.array([drawing.arm(body, point) for point in points]).reshape(-1, 3)
            found.append((points, local @ rotation[:, index].swapaxes(-1, -2)))
    return found


def named(mechanism: Mechanism, motion: BodyMotion, chassis: Array, found: Array) -> Errors:
    """Errors by name of such totals, with what the sums round that make points of their arms."""
    model, size = mechanism.model, mechanism.drawing.size
    errors = Errors({}, {}, {}, {}, {}, {})
    for point in model.bodies[model.chassis]:
        # The drawn place and the motion of the chassis: one sum.
        place = np.abs(np.array(model.points[point]) + chassis[:, 0])
        errors.position[point] = 0.5 * EPS * place
        errors.velocity[point], errors.acceleration[point] = np.zeros((2, *place.shape))
    column = 0
    bodies = [body for body, index in mechanism.drawing.bodies.items() if index]
    for index, (body, (points, arms)) in enumerate(
        zip(bodies, places_of(mechanism, motion.rotation), strict=True), 1
    ):
        turn = found[..., column : column + 3]
        column += 3
        errors.rotation[body], errors.angular_velocity[body], errors.angular_acceleration[body] = turn
        for number, (point, sums) in enumerate(
            zip(points, np.moveaxis(_sums(mechanism, motion, index, arms, chassis), 2, 0), strict=True)
        ):
            first = column + 3 * number
            errors.position[point], errors.velocity[point], errors.acceleration[point] = (
                found[..., first : first + 3] * size + sums
            )
        column += 3 * len(points)
    return errors


def fold(mechanism: Mechanism, placed: Placed, inverse: Array, doubt: Array) -> Array:
    """How much larger than to first order errors of pose, velocity and acceleration are, (3, N).

    Along the largest displacement x that the doubts allow, the equation left is c x + h x^2 = d with the
    first-order answer d / c, and m = h d / c^2 measures how near its fold is: the exact answer is
    larger by 2 / (1 + r), r = sqrt(1 - 4 m); the slope there is c r, and with it velocity changes as 1 / r,
    acceleration as 1 / r^3. Beyond, 4 m >= 1, the doubts reach the fold: a pose on this side of it still
    lies within twice the first order, its rates may be anything, and their estimate is infinite.
    """
    stack = mechanism.stack
    count = range(len(doubt))
    worst = np.argmax(np.einsum("nij,nj->ni", np.abs(inverse), doubt), axis=1)
    displaced = np.einsum("nij,nj->ni", inverse, np.sign(inverse[count, worst]) * doubt)
    twist = np.zeros((len(doubt), len(mechanism.drawing.bodies), 2, 3))
    twist[:, 1:] = displaced.reshape(len(doubt), -1, 2, 3)
    bend = np.einsum("nij,nj->ni", inverse, stack.drift(placed, twist))
    near = 0.5 * np.abs(bend).max(axis=1) / np.abs(displaced).max(axis=1)
    root = np.sqrt(np.maximum(1.0 - 4.0 * near, 0.0))
    with np.errstate(divide="ignore"):
        # (1 / r - 1) / (2 m) and (1 / r^3 - 1) / (6 m), written without the difference.
        speed = 2.0 / (root * (1.0 + root))
        second = 2.0 * (1.0 + root + root * root) / (3.0 * root**3 * (1.0 + root))
    return np.array((2.0 / (1.0 + root), speed, second))


def _answers(
    mechanism: Mechanism, motion: BodyMotion, series: Array, known: Array
) -> tuple[Array, Array, Array]:
    """What the doubts p, t, s of each row do to [o, turn] of the moving bodies and its rates.

    Returns:
        (4, N, rows, 6 * bodies): K, pose to p, velocity to t, acceleration to s; -K H K, velocity to p; the
        same of acceleration to p; and that of acceleration to t. (N, 3, rows) how far p, t, s are off by
        rounding. (3, N) as `Sensitivity.grown`.
    """
    stack = mechanism.stack
    placed = stack.place(motion.rotation, motion.origin)
    targets = mechanism.target_series(series)
    jacobian = stack.jacobian(placed)
    inverse = np.asarray(np.linalg.inv(jacobian), dtype=float)
    moving = stack.motion(placed, motion.velocity)
    # Of the accelerations only the first rates count: their squares may be beyond any number.
    with np.errstate(over="ignore", invalid="ignore"):
        bending = stack.motion(placed, motion.acceleration)
    speeds = motion.velocity[:, 1:].reshape(len(inverse), -1)
    rounded = np.stack(
        (
            pose_doubt(mechanism, placed, targets[0]),
            rate_doubt(moving, targets[1]),
            second_doubt(moving, bending, targets[2]),
        ),
        axis=1,
    )
    pose, rate, _ = (known + rounded).swapaxes(0, 1)
    by_velocity = drift_by_velocity(stack, moving)
    changes = (rate_by_pose(stack, moving), rate_by_pose(stack, bending) + drift_by_pose(stack, moving))
    count = stack.count
    # Both changes with the pose, and that of the drift with the velocities, times K, as one matrix.
    turned = np.concatenate((*changes, by_velocity), axis=1) @ inverse
    speed = -inverse @ turned[:, :count]
    turned[:, count : 2 * count] += by_velocity @ speed
    second, bent = -inverse @ turned[:, count : 2 * count], -inverse @ turned[:, 2 * count :]
    grown = fold(mechanism, placed, inverse, pose)
    # The drift is quadratic in the velocities: its next order is smaller by what these are off themselves.
    off = np.einsum("nij,nj->ni", np.abs(inverse), rate)
    fastest = np.abs(speeds).max(axis=1)
    share = np.divide(off.max(axis=1), fastest, out=np.zeros_like(fastest), where=fastest > 0)
    grown[2] *= 1.0 + share
    return np.stack((inverse, speed, second, bent)).swapaxes(-1, -2), rounded, grown


def _lengths(answers: Array, motion: BodyMotion, index: int, arms: Array) -> Array:
    """The turn of a body and its rates, and its points at arms (N, points, 3) from its origin.

    p = o + r,  p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r), where r turns by turn x r. Each vector
    product is a matrix here: answers are rows, and so are vectors.
    """
    spin, spin1 = (wheel(rates[:, index, 1])[:, None] for rates in (motion.velocity, motion.acceleration))
    r = -wheel(arms)
    turning = cross(motion.velocity[:, index, None, 1], arms)
    # Of points: turned is x r, moved is w x turned.
    moved = r @ spin
    bent = moved - wheel(turning)
    moved1 = r @ spin1 + moved @ spin
    first = 6 * (index - 1)
    origin, turn = answers[..., first : first + 3], answers[..., first + 3 : first + 6]
    turned = turn @ side_by_side(r)
    further = turn[0] @ side_by_side(np.concatenate((moved, bent, moved1), axis=1))
    width = turned.shape[-1]
    turned[1] += further[..., :width]
    turned[3] += further[..., width : 2 * width]
    turned[2] += further[..., 2 * width :]
    turned[2] += turn[1] @ side_by_side(bent)
    found = np.empty((*turned.shape[:-1], 3 + width))
    found[..., :3] = turn
    np.add(turned, np.tile(origin, len(arms[0])), out=found[..., 3:])
    return found


def wheel(vectors: Array) -> Array:
    """(..., 3, 3) matrices with  x @ wheel(v) = v x x  for a row x."""
    return np.asarray((vectors @ WHEEL).reshape(*vectors.shape, 3))


def side_by_side(matrices: Array) -> Array:
    """(N, 3, 3 * M) of (N, M, 3, 3)."""
    count, many = matrices.shape[:2]
    return matrices.swapaxes(1, 2).reshape(count, 3, 3 * many)


def _sums(mechanism: Mechanism, motion: BodyMotion, index: int, arms: Array, chassis: Array) -> Array:
    """What the sums that make points of their arms are rounded from, (3, N, points, 3), mm and s."""
    drawing = mechanism.drawing
    size = drawing.size
    rates = motion.velocity[:, index, None], motion.acceleration[:, index, None]
    reach, fast, faster = (
        length(vector)[..., None] for vector in (arms, rates[0][..., 1, :], rates[1][..., 1, :])
    )
    place = motion.origin[:, index, None] + arms
    given = place * size + drawing.middle
    position = (ARM * reach + SUMMED * np.abs(place)) * size
    position += 0.5 * EPS * (np.abs(given) + np.abs(given + chassis[:, None, 0]))
    velocity = (TURNED * fast * reach + SUMMED * np.abs(rates[0][..., 0, :])) * size
    velocity += 0.5 * EPS * np.abs(chassis[:, None, 1])
    turning_twice = (fast * fast + faster) * reach
    acceleration = (TURNED_TWICE * turning_twice + SUMMED * np.abs(rates[1][..., 0, :])) * size
    acceleration += 0.5 * EPS * np.abs(chassis[:, None, 2])
    return np.array((position, velocity, acceleration))


def further(total: Array, grown: Array) -> Array:
    """(3, N, 3 * of these) with the higher orders, which lead anywhere, not where the first leads.

    Nothing stays nothing, however near the fold.
    """
    each = total.reshape(*total.shape[:2], -1, 3)
    largest = each.max(axis=-1, keepdims=True)
    more = np.multiply(largest, grown[..., None, None] - 1.0, out=np.zeros_like(largest), where=largest > 0)
    return np.asarray((each + more).reshape(total.shape))


def by_row(each: Callable[[Array], Array], doubts: Array, lengths: Array) -> Array:
    """Sums over the rows for doubts p, t, s (N, 3, rows), each sum put through a function before it is
    added to others, for a quantity and its rates. Lengths are those of `Sensitivity`, or of one instant for
    all, (4, rows, 3 * of these).
    """
    own, speed, second, bent = lengths
    p, t = doubts[:, :1], doubts[:, 1:2]
    direct = each(doubts @ own).swapaxes(0, 1)
    direct[1] += each(p @ speed)[:, 0]
    direct[2] += each(p @ second)[:, 0] + each(t @ bent)[:, 0]
    return direct
