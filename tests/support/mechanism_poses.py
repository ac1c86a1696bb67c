"""Poses of the witness: followed in doubles from the drawing, refined to many digits, and their rates.

Along a straight step the Jacobian of quadratic rows changes by a matrix that is known. While its norm is
below the smallest singular value, no pose on the step is singular: the assembly is the one reached from the
drawing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from mechanism_equations import DIGITS, SINGULAR, Array, Equations
from mpmath import mp, mpf

# Each chord step gains the digits that doubles have, less those of the condition: 3 gain 30.
CHORDS = 3

Points = dict[str, Array]


class Stuck(Exception):
    """A singular pose is in the way, the inputs are not the freedoms, or rows contradict each other."""


def least_squares(matrix: Array, right: Array) -> Array:
    """By the normal equations: what they lose, the next step of Newton's method finds."""
    try:
        return np.asarray(np.linalg.solve(matrix.T @ matrix, matrix.T @ right))
    except np.linalg.LinAlgError:
        raise Stuck("a direction is free: the pose is singular") from None


def follow(e: Equations, path: Sequence[Mapping[str, Any]]) -> Array:
    """Poses of the assembly reached from the drawing along straight ways in the inputs, (N, unknowns).

    Raises:
        Stuck: with what is in the way.
    """
    now, poses = dict(e.at_drawing), []
    y = _corrected(e, e.start.astype(float), now)  # what is drawn off its line is put on it
    for goal in path:
        y = _along(e, y, now, {name: mpf(goal[name]) for name in now})
        now = {name: mpf(goal[name]) for name in now}
        poses.append(y)
    return np.array(poses)


def _along(e: Equations, y: Array, now: Mapping[str, Any], goal: Mapping[str, Any]) -> Array:
    done, longest = 0.0, 1.0
    while True:
        at = {name: now[name] + done * (goal[name] - now[name]) for name in now}
        jacobian = e.jacobian(y)
        least = np.linalg.svd(jacobian, compute_uv=False)[-1]
        if len(jacobian) < len(y) or least < SINGULAR:
            where = {name: float(value) for name, value in at.items()}
            raise Stuck(f"the pose at {where} is singular: a direction is free")
        if done == 1.0:
            return y
        pull = e.targets(at, 1) * e.per_row({name: goal[name] - now[name] for name in now})
        step = least_squares(jacobian, pull.astype(float))
        size = float(np.linalg.norm(e.change(np.append(step, 0.0))))
        part = min(1.0 - done, longest, 0.5 * least / max(size, 1e-300))
        ahead = 1.0 if part == 1.0 - done else done + part
        there = {name: now[name] + ahead * (goal[name] - now[name]) for name in now}
        try:
            found = _corrected(e, y + part * step, there)
            if np.linalg.norm(e.change(np.append(found - y, 0.0))) >= least:
                raise Stuck("the step is too long to tell assemblies apart")
        except Stuck as reason:
            longest = 0.5 * part
            if longest < 1e-9:
                where = {name: float(value) for name, value in at.items()}
                raise Stuck(f"no pose is reached beyond {where}: a singular one is there") from reason
            continue
        y, done, longest = found, ahead, 2.0 * part


def _corrected(e: Equations, y: Array, inputs: Mapping[str, Any]) -> Array:
    targets = e.targets(inputs).astype(float)
    for _ in range(8):
        residual = e.residual(y, targets)
        step = least_squares(e.jacobian(y), residual)
        y = y - step
        # Rows are of order 1 and at most 100 roundings each: a residual of 1e-13 is what doubles leave.
        if np.linalg.norm(step) < 1e-12:
            if np.max(np.abs(e.residual(y, targets))) > 1e-13:
                break
            return y
    raise Stuck(f"no pose meets all rows at { {name: float(w) for name, w in inputs.items()} }")


def placed(e: Equations, path: Sequence[Mapping[str, Any]]) -> list[Points]:
    """Points of the poses at some inputs, followed from the drawing, in many digits, mm."""
    return [e.points(refined(e, y, inputs)) for y, inputs in zip(follow(e, path), path, strict=True)]


def refined(e: Equations, y: Array, inputs: Mapping[str, Any]) -> Array:
    """A pose in many digits."""
    with mp.workdps(DIGITS):
        inverse = np.linalg.pinv(e.jacobian(y)).astype(object)
        exact, targets = y.astype(object) * mpf(1), e.targets(inputs)
        for _ in range(CHORDS):
            exact = exact - inverse @ e.exact_residual(exact, targets)
        return exact


def rates(e: Equations, y: Array, inputs: Mapping[str, Sequence[Any]]) -> tuple[Points, Points]:
    """Velocities and accelerations of the points of a refined pose in the chassis' frame, mm and s.

    Rows C are quadratic, so J v = (C(y + v) - C(y - v)) / 2, and C(y + v) + C(y - v) - 2 C(y) is what the
    velocity adds to the acceleration's equations.

    Args:
        inputs: value, rate and acceleration of each.
    """
    with mp.workdps(DIGITS):
        values = {name: states[0] for name, states in inputs.items()}
        first, second = (e.targets(values, k) for k in (1, 2))
        rate, bend = (e.per_row({name: mpf(jet[k]) for name, jet in inputs.items()}) for k in (1, 2))
        inverse = np.linalg.pinv(e.jacobian(y.astype(float))).astype(object)

        def both(v: Array) -> tuple[Array, Array]:
            return e.exact_residual(y + v, 0), e.exact_residual(y - v, 0)

        def solved(right: Array) -> Array:
            v = 0 * y
            for _ in range(CHORDS + 1):
                ahead, behind = both(v)
                v = v + inverse @ (right - (ahead - behind) / 2)
            return v

        speed = solved(first * rate)
        ahead, behind = both(speed)
        pulled = solved(second * rate**2 + first * bend - (ahead + behind - 2 * e.exact_residual(y, 0)))
        velocity, acceleration = (
            {name: e.point(name)[:, :-1] @ part * e.unit for name in e.named} for part in (speed, pulled)
        )
        return velocity, acceleration
