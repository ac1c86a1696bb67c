"""The record of a motion while it is solved, and the points and bodies read from it."""

import numpy as np

from absolute.assembly import Mechanism
from absolute.mapping import ReadOnly
from absolute.newton import Pose
from absolute.solution import Array, Solution
from absolute.vectors import cross

# Jacobians per batch when condition numbers are asked for: a few megabytes at a time.
BATCH = 256


class Record:
    """Body poses and rates instant by instant, in units of size."""

    def __init__(self, mechanism: Mechanism, count: int, rates: bool, conditions: bool) -> None:
        bodies = len(mechanism.drawing.bodies)
        self._mechanism = mechanism
        self._rates = rates
        self._conditions = conditions
        self._rotation = np.zeros((count, bodies, 3, 3))
        self._origin = np.zeros((count, bodies, 3))
        # [origin, angular] of each body; the chassis stays at zero.
        self._velocity = np.zeros((count if rates else 0, bodies, 2, 3))
        self._acceleration = np.zeros((count if rates else 0, bodies, 2, 3))
        self._iterations = np.zeros(count, dtype=np.int64)
        self._residual = np.zeros(count)
        self.written = 0

    def write(self, instant: int, pose: Pose, motion: tuple[Array, Array] | None, iterations: int) -> None:
        """Keep one solved instant."""
        self._rotation[instant] = pose.poses.rotation
        self._origin[instant] = pose.poses.origin
        if motion is not None:
            self._velocity[instant, 1:] = motion[0].reshape(-1, 2, 3)
            self._acceleration[instant, 1:] = motion[1].reshape(-1, 2, 3)
        self._iterations[instant] = iterations
        self._residual[instant] = pose.residual
        self.written = instant + 1

    def solution(self, count: int, chassis: Array) -> Solution:
        """The first `count` instants in mm, carried by the chassis motion (N, 3, 3)."""
        drawing, model = self._mechanism.drawing, self._mechanism.model
        position: dict[str, Array] = {}
        velocity: dict[str, Array] = {}
        acceleration: dict[str, Array] = {}
        for body, index in drawing.bodies.items():
            for point in model.bodies[body]:
                if point in position:
                    continue
                if index == 0:
                    position[point] = np.array(model.points[point]) + chassis[:count, 0]
                    if self._rates:
                        velocity[point] = chassis[:count, 1].copy()
                        acceleration[point] = chassis[:count, 2].copy()
                    continue
                arm = self._rotation[:count, index] @ drawing.arm(body, point)
                position[point] = (
                    (self._origin[:count, index] + arm) * drawing.size + drawing.middle + chassis[:count, 0]
                )
                if self._rates:
                    # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
                    speed, spin = self._velocity[:count, index, 0], self._velocity[:count, index, 1]
                    second, spin1 = self._acceleration[:count, index, 0], self._acceleration[:count, index, 1]
                    turning = cross(spin, arm)
                    velocity[point] = (speed + turning) * drawing.size + chassis[:count, 1]
                    acceleration[point] = (
                        second + cross(spin1, arm) + cross(spin, turning)
                    ) * drawing.size + chassis[:count, 2]
        turns = drawing.bodies if self._rates else {}
        spins = {body: self._velocity[:count, i, 1].copy() for body, i in turns.items() if i}
        spins1 = {body: self._acceleration[:count, i, 1].copy() for body, i in turns.items() if i}
        iterations = self._iterations[:count].copy()
        iterations.setflags(write=False)
        in_order = {name: position[name] for name in model.points}
        return Solution(
            position=_fixed(in_order),
            velocity=_fixed({name: velocity[name] for name in model.points} if self._rates else {}),
            acceleration=_fixed({name: acceleration[name] for name in model.points} if self._rates else {}),
            angular_velocity=_fixed(spins),
            angular_acceleration=_fixed(spins1),
            iterations=iterations,
            residual=_locked(self._residual[:count] * drawing.size),
            condition=_locked(self._condition_numbers(count)) if self._conditions else None,
        )

    def _condition_numbers(self, count: int) -> Array:
        stack = self._mechanism.stack
        numbers = np.zeros(count)
        for start in range(0, count, BATCH):
            part = slice(start, min(start + BATCH, count))
            numbers[part] = np.linalg.cond(
                stack.jacobian(stack.place(self._rotation[part], self._origin[part]))
            )
        return numbers


def _locked(array: Array) -> Array:
    array.setflags(write=False)
    return array


def _fixed(arrays: dict[str, Array]) -> ReadOnly[Array]:
    return ReadOnly({name: _locked(array) for name, array in arrays.items()})
