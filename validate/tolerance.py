r"""Tolerances, each derived from what two formulations say of their own accuracy.

For a pair of formulations 1, 2 at one instant, with e the error of a pose, k the condition number, s1
and s2 the largest change of a velocity and of an acceleration per displacement of the pose (the larger
known value), V and A the largest speed and acceleration of any point in the scene or, if larger, of the
terms that they are summed from (a sum that is zero is still rounded as its terms are), eps the rounding
unit and C = 8 (each row of the linear systems takes at most 8 roundings of eps / 2 in each of two
formulations):

    T(pose)         = e1 + e2
    T(position)     = T(pose) + r1 + r2
    T(velocity)     = s1 T(pose) + [C eps (k1 + k2) + truncation] V
    T(acceleration) = s2 T(pose) + 2 s1 T(velocity) + [C eps (k1 + k2) + truncation] A + C eps s1 V

The pose error of pointcoord is a proven bound; of the absolute model it is C eps k size. Both solve near
the mechanism; r is the rounding of what is reported from the user's origin, and no rate sees it. The velocity
solves C_u v = -C_w w', so a pose displaced by d changes it by C_u^-1 2 B(d, v), at most s1 |d|. The
acceleration solves C_u a = -C_w w'' - 2 B(v, v), where a velocity error enters as 4 B(v, .).

A point that rides on a body, the wheel centre, moves g times as much as the points that carry it, and
its velocity and acceleration have these tolerances times g with s1 T(pose), and s1 T(velocity) added
once more for the turning of its arm.

The rates of a body with points r_i about their centroid, |r_i| <= R, are least squares with the inertia
tensor J = sum (|r_i|^2 I - r_i r_i^T); with w, a its largest angular velocity and acceleration,

    T(omega) = b [T(velocity) + w T(pose)],    b = max row sum of |J^-1 [r_1]x ... J^-1 [r_k]x|
    T(alpha) = b [T(acceleration) + (a + 2 w^2) T(pose) + 2 w R T(omega)]

and an angle of a line of length l turns by at most T(angle) = 4 T(position) / l + 4 eps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.formulation import Solution

Array = NDArray[np.float64]

EPS = float(np.finfo(float).eps)
ROUNDINGS = 8.0

KNUCKLE = ("lower_ball_joint", "tie_rod_outer", "strut_lower")
CARRIED = ("wheel_centre", "wheel_axis_inner")
ANGLE_LINES = {
    "camber": ("strut_lower", "wheel_centre"),
    "kingpin": ("lower_ball_joint", "strut_lower"),
}


@dataclass(frozen=True)
class Factors:
    """The factors of a pair's tolerances, for the report; arrays over the instants where they vary."""

    pose: Array
    position: Array
    carried_gain: Array
    condition: Array
    velocity_sensitivity: Array
    acceleration_sensitivity: Array
    truncation: float
    speed: float
    acceleration: float


def factors(first: Solution, second: Solution) -> Factors:
    """What two solutions of a scene say of their accuracy, put together.

    V and A are taken over both, so that a wrong rate widens its own tolerance by no more than itself.
    """
    a, b = first.accuracy, second.accuracy
    return Factors(
        pose=a.pose_error + b.pose_error,
        position=a.pose_error + b.pose_error + a.stored + b.stored,
        carried_gain=np.maximum(a.carried_gain, b.carried_gain),
        condition=a.condition + b.condition,
        velocity_sensitivity=np.maximum(a.velocity_sensitivity, b.velocity_sensitivity),
        acceleration_sensitivity=np.maximum(a.acceleration_sensitivity, b.acceleration_sensitivity),
        truncation=a.truncation + b.truncation,
        speed=max(min(_largest(first.velocity), _largest(second.velocity)), a.speed_terms, b.speed_terms),
        acceleration=max(
            min(_largest(first.acceleration), _largest(second.acceleration)),
            a.acceleration_terms,
            b.acceleration_terms,
        ),
    )


def _largest(vectors: Mapping[str, Array]) -> float:
    return max((_length(v) for v in vectors.values() if v.size), default=0.0)


def _length(vectors: Array) -> float:
    """Largest length of vectors, shape (..., 3), whose squares may overflow."""
    size = float(np.abs(vectors).max())
    if size == 0.0 or not np.isfinite(size):
        return size
    return size * float(np.max(np.linalg.norm(vectors / size, axis=-1)))


def point_tolerances(f: Factors) -> dict[str, Array]:
    """Tolerances of pose and position (mm), velocity (mm/s), acceleration (mm/s^2), each of shape (N,)."""
    relative = ROUNDINGS * EPS * f.condition + f.truncation
    velocity = f.velocity_sensitivity * f.pose + relative * f.speed
    acceleration = (
        f.acceleration_sensitivity * f.pose
        + 2.0 * f.velocity_sensitivity * velocity
        + relative * f.acceleration
        + ROUNDINGS * EPS * f.velocity_sensitivity * f.speed
    )
    return {"pose": f.pose, "position": f.position, "velocity": velocity, "acceleration": acceleration}


def carried_tolerances(f: Factors) -> dict[str, Array]:
    """The same for a point that rides on a body."""
    own = point_tolerances(f)
    turned = own["velocity"] + f.velocity_sensitivity * own["pose"]
    return {
        "pose": f.carried_gain * own["pose"],
        "position": f.carried_gain * own["position"],
        "velocity": f.carried_gain * turned,
        "acceleration": f.carried_gain * (own["acceleration"] + f.velocity_sensitivity * turned),
    }


def body_tolerances(
    points: Mapping[str, Array], tolerances: Mapping[str, Array], spin: float, spin_rate: float
) -> dict[str, Array]:
    """Tolerances of a body's angular velocity (rad/s) and acceleration (rad/s^2), shape (N,).

    Args:
        points: positions of the body's points, (N, 3), mm.
        tolerances: of the points, as `point_tolerances` gives them.
        spin, spin_rate: the body's largest angular velocity and acceleration.
    """
    stack = np.stack(list(points.values()), axis=-2)
    r = stack - stack.mean(axis=-2, keepdims=True)
    lengths = np.linalg.norm(r, axis=-1)
    inertia = np.sum(lengths**2, axis=-1)[:, None, None] * np.eye(3) - np.swapaxes(r, -2, -1) @ r
    moments = np.cross(r[..., None, :], np.eye(3))  # row j of matrix i: r_i x e_j
    solved = np.linalg.solve(inertia[:, None], np.swapaxes(moments, -2, -1))
    gain = np.abs(solved).sum(axis=(-3, -1)).max(axis=-1)
    omega = gain * (tolerances["velocity"] + spin * tolerances["pose"])
    pulled = (spin_rate + 2.0 * spin**2) * tolerances["pose"]
    turned = 2.0 * spin * lengths.max(axis=-1) * omega
    return {
        "angular_velocity": omega,
        "angular_acceleration": gain * (tolerances["acceleration"] + pulled + turned),
    }


def angle_tolerance(name: str, position: Mapping[str, Array], f: Factors) -> Array:
    """Tolerance of camber or kingpin angle, shape (N,), rad."""
    start, end = ANGLE_LINES[name]
    tolerance = f.position * (f.carried_gain if end in CARRIED else 1.0)
    length = np.linalg.norm(position[end] - position[start], axis=-1)
    return np.asarray(4.0 * tolerance / length + 4.0 * EPS)
