"""The record of a motion while it is solved, and the points, bodies and lines read from it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from absolute.description import Corner
from absolute.effects.effect import Effect
from absolute.mapping import ReadOnly
from absolute.mechanism import Mechanism
from absolute.newton import Configurations
from absolute.precision import EPS
from absolute.solution import Array, Solution
from absolute.turning import Turning
from absolute.vectors import cross

# Jacobians at once when condition numbers are asked for: what stays in fast memory.
BATCH = 32
OF_POINTS = ("position", "velocity", "acceleration")
OF_BODIES = ("angular_velocity", "angular_acceleration")


class Asked(NamedTuple):
    """What shall be told of each instant beside the poses.

    Attributes:
        rates: velocities and accelerations. conditions: condition numbers.
        effects: those whose values are told.
    """

    rates: bool
    conditions: bool
    effects: tuple[Effect, ...]


class Record:
    """Body poses and rates of the instants solved so far, in units of size; it is what effects look at.

    Lengths are measured from the middle of the drawing until the last sum, so that the distance of the car
    from its origin costs no more than one rounding.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        chassis: Array,
        asked: Asked,
        turns: Sequence[Turning] = (),
    ) -> None:
        count, bodies = len(chassis), len(mechanism.drawing.bodies)
        self._mechanism = mechanism
        self._chassis, self._turns, self._asked = chassis, turns, asked
        self._rotation = np.zeros((count, bodies, 3, 3))
        self._origin = np.zeros((count, bodies, 3))
        # [origin, angular] of each body; the chassis, and all without rates, stay at zero.
        self._velocity, self._acceleration = np.zeros((2, count, bodies, 2, 3))
        self._iterations = np.zeros(count, dtype=np.int64)
        self._residual = np.zeros(count)
        self.written = 0

    def store(
        self,
        found: Configurations,
        residual: Array,
        velocity: Array | None = None,
        acceleration: Array | None = None,
    ) -> None:
        """Keep some instants, after those kept before, with rates of their moving bodies if there are any."""
        part = slice(self.written, self.written + len(found.q))
        self._rotation[part], self._origin[part] = found.rotation, found.origin
        if velocity is not None and acceleration is not None:
            bodies = self._velocity[part, 1:]
            bodies[...] = velocity.reshape(bodies.shape)
            self._acceleration[part, 1:] = acceleration.reshape(bodies.shape)
        self._iterations[part] = found.corrections
        self._residual[part] = residual
        self.written += len(found.q)

    def solution(self) -> Solution:
        """The instants solved so far in mm, seen from the ground."""
        count, size, model = self.written, self._mechanism.drawing.size, self._mechanism.model
        # Of body rates, angular velocity is the first.
        orders = 3 if self._asked.rates else 1
        numbers: dict[str, dict[str, Array]] = {kind: {} for kind in (*OF_POINTS, *OF_BODIES)}
        for name in model.reported:
            for kind, state in zip(OF_POINTS, self._point(name)[:orders], strict=False):
                numbers[kind][name] = state
        for body in model.moving:
            if body not in model.aids:
                for kind, state in zip(OF_BODIES, self._body(body)[: orders - 1], strict=False):
                    numbers[kind][body] = state
        numbers["effects"] = {effect.name: effect.value(self) for effect in self._asked.effects}
        iterations = self._iterations[:count].copy()
        iterations.setflags(write=False)
        residual = self._residual[:count]
        return Solution(
            iterations=iterations,
            residual=_locked(residual * size),
            condition=_locked(self._condition_numbers(count)) if self._asked.conditions else None,
            # Half a unit in the last place of lengths up to the diameter.
            accuracy=_locked(np.maximum(residual, EPS) * size),
            **{kind: ReadOnly({n: _locked(a) for n, a in of.items()}) for kind, of in numbers.items()},
        )

    @property
    def corner(self) -> Corner:
        """What of the linkage is the wheel, and which way the car points."""
        return self._mechanism.model.corner

    def line(self, ends: tuple[str, str]) -> Array:
        """(N, 3) from one point to another, mm, in the axes of the frame of the points.

        A line between two points of one body turns with it and is nothing but turned.
        """
        drawing, bodies, count = self._mechanism.drawing, self._mechanism.model.bodies, self.written
        body = next((body for body, points in bodies.items() if set(ends) <= set(points)), None)
        if body is None:
            line = self._place(ends[1]) - self._place(ends[0])
        else:
            line = self._rotation[:count, drawing.bodies[body]] @ drawing.line(*ends)
        for turn in self._turns:
            line = turn.first(count).seen(line[None])[0]
        return np.asarray(line * drawing.size)

    def _holder(self, point: str) -> tuple[str, int]:
        bodies = self._mechanism.model.bodies
        return next(of for of in self._mechanism.drawing.bodies.items() if point in bodies[of[0]])

    def _place(self, point: str) -> Array:
        """(N, 3) on the chassis, in units of size."""
        body, index = self._holder(point)
        arm = self._mechanism.drawing.arm(body, point)
        return np.asarray(self._origin[: self.written, index] + self._rotation[: self.written, index] @ arm)

    def _point(self, name: str) -> Array:
        """(3, N, 3) a point and its rates, mm and s."""
        drawing, model, count = self._mechanism.drawing, self._mechanism.model, self.written
        body, index = self._holder(name)
        state, given = np.zeros((3, count, 3)), np.array(model.points[name])
        base = drawing.middle if index or self._turns else given
        if index:
            arm = self._rotation[:count, index] @ drawing.arm(body, name)
            speed, spin = self._velocity[:count, index].swapaxes(0, 1)
            second, spin1 = self._acceleration[:count, index].swapaxes(0, 1)
            # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
            turning = cross(spin, arm)
            state[0] = self._origin[:count, index] + arm
            state[1] = speed + turning
            state[2] = second + cross(spin1, arm) + cross(spin, turning)
            state *= drawing.size
        else:
            state[0] = given - base
        for turn in self._turns:
            state = turn.first(count).seen_point(state, base)
        state += self._chassis[:count].swapaxes(0, 1)
        state[0] += base
        return state

    def _body(self, name: str) -> Array:
        """(2, N, 3) angular velocity and acceleration of a body, rad and s."""
        index, count = self._mechanism.drawing.bodies[name], self.written
        state = np.array([self._velocity[:count, index, 1], self._acceleration[:count, index, 1]])
        for turn in self._turns:
            state = turn.first(count).seen(state) + turn.first(count).rates
        return state

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
