"""The record of a motion while it is solved, and the points and bodies read from it."""

import numpy as np

from absolute.assembly import Mechanism
from absolute.finish import Finished
from absolute.mapping import ReadOnly
from absolute.solution import Array, Solution
from absolute.vectors import cross

# Jacobians at once when condition numbers are asked for: a few megabytes.
BATCH = 256


class Record:
    """Body poses and rates of the instants solved so far, in units of size."""

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

    def store(self, finished: Finished, count: int) -> None:
        """Keep the first `count` of some finished instants, after those kept before."""
        part = slice(self.written, self.written + count)
        self._rotation[part] = finished.rotation[:count]
        self._origin[part] = finished.origin[:count]
        if self._rates:
            self._velocity[part, 1:] = finished.velocity[:count].reshape(self._velocity[part, 1:].shape)
            self._acceleration[part, 1:] = finished.acceleration[:count].reshape(
                self._velocity[part, 1:].shape
            )
        self._iterations[part] = finished.corrections[:count]
        self._residual[part] = finished.residual[:count]
        self.written += count

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
