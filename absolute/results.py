"""The points, bodies and lines of a solved motion, from the poses and rates of its bodies."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from absolute.description import Corner
from absolute.effects import Effect
from absolute.mapping import ReadOnly
from absolute.mechanism import Mechanism
from absolute.precision import EPS
from absolute.solution import Array, Counts, Solution
from absolute.turning import Turning
from absolute.vectors import cross

# Jacobians at once when condition numbers are asked for: what stays in fast memory.
BATCH = 32
OF_POINTS = ("position", "velocity", "acceleration")
OF_BODIES = ("angular_velocity", "angular_acceleration")


class Instants(NamedTuple):
    """What was solved at N instants, in units of size.

    Attributes:
        rotation, origin: (N, bodies, 3, 3) and (N, bodies, 3), the chassis first.
        rates: (N, 2, bodies, 2, 3) velocities [o', w] and accelerations [o'', w'] of the bodies; the chassis,
            and all where they are not asked for, stay at zero.
        residual: (N,) largest violation of a row.
        corrections: (N,) of Newton.
    """

    rotation: Array
    origin: Array
    rates: Array
    residual: Array
    corrections: Counts


@dataclass(frozen=True)
class Motion:
    """Instants of a mechanism with a chassis that is turned and displaced; it is what effects look at.

    Lengths are measured from the middle of the drawing until the last sum, so that the distance of the car
    from its origin costs no more than one rounding.

    Attributes:
        chassis: (N, 3, 3) displacement of the chassis and its rates, mm and s, after its turns.
    """

    mechanism: Mechanism
    instants: Instants
    chassis: Array
    turns: tuple[Turning, ...]

    def solution(self, rates: bool, conditions: bool, effects: Sequence[Effect]) -> Solution:
        """The motion in mm, seen from the ground, with what is asked for."""
        size, model = self.mechanism.drawing.size, self.mechanism.model
        # Of body rates, angular velocity is the first.
        orders = 3 if rates else 1
        numbers: dict[str, dict[str, Array]] = {kind: {} for kind in (*OF_POINTS, *OF_BODIES)}
        for name in model.reported:
            for kind, state in zip(OF_POINTS[:orders], self._point(name), strict=False):
                numbers[kind][name] = state
        for body in model.moving:
            if body not in model.aids:
                for kind, state in zip(OF_BODIES[: orders - 1], self._body(body), strict=False):
                    numbers[kind][body] = state
        numbers["effects"] = {effect.name: effect.value(self) for effect in effects}
        iterations, residual = self.instants.corrections, self.instants.residual
        iterations.setflags(write=False)
        return Solution(
            iterations=iterations,
            residual=_locked(residual * size),
            condition=_locked(self._condition_numbers()) if conditions else None,
            # Points are rounded too, whatever is left of the rows: half a unit in the last place of lengths
            # up to the diameter.
            accuracy=_locked((residual + EPS) * size),
            **{kind: ReadOnly({n: _locked(a) for n, a in of.items()}) for kind, of in numbers.items()},
        )

    @property
    def corner(self) -> Corner:
        """What of the linkage is the wheel, and which way the car points."""
        return self.mechanism.model.corner

    def line(self, ends: tuple[str, str]) -> Array:
        """(N, 3) from one point to another, mm, in the axes of the frame of the points.

        A line between two points of one body turns with it and is nothing but turned.
        """
        drawing, bodies = self.mechanism.drawing, self.mechanism.model.bodies
        body = next((body for body, points in bodies.items() if set(ends) <= set(points)), None)
        if body is None:
            line = self._place(ends[1]) - self._place(ends[0])
        else:
            line = self.instants.rotation[:, drawing.bodies[body]] @ drawing.line(*ends)
        for turn in self.turns:
            line = turn.seen(line[None])[0]
        return np.asarray(line * drawing.size)

    def _holder(self, point: str) -> tuple[int, Array]:
        """The body of a point, and the (N, 3) arm to the point from its origin, in units of size."""
        drawing, bodies = self.mechanism.drawing, self.mechanism.model.bodies
        body, index = next(of for of in drawing.bodies.items() if point in bodies[of[0]])
        return index, np.asarray(self.instants.rotation[:, index] @ drawing.arm(body, point))

    def _place(self, point: str) -> Array:
        """(N, 3) on the chassis, in units of size."""
        index, arm = self._holder(point)
        return np.asarray(self.instants.origin[:, index] + arm)

    def _point(self, name: str) -> Array:
        """(3, N, 3) a point and its rates, mm and s."""
        drawing, given = self.mechanism.drawing, np.array(self.mechanism.model.points[name])
        index, arm = self._holder(name)
        state = np.zeros((3, *arm.shape))
        base = drawing.middle if index or self.turns else given
        if index:
            (speed, spin), (second, spin1) = np.moveaxis(self.instants.rates[:, :, index], 0, 2)
            # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
            turning = cross(spin, arm)
            state[0] = self.instants.origin[:, index] + arm
            state[1] = speed + turning
            state[2] = second + cross(spin1, arm) + cross(spin, turning)
            state *= drawing.size
        else:
            state[0] = given - base
        for turn in self.turns:
            state = turn.seen_point(state, base)
        state += self.chassis.swapaxes(0, 1)
        state[0] += base
        return state

    def _body(self, name: str) -> Array:
        """(2, N, 3) angular velocity and acceleration of a body, rad and s."""
        index = self.mechanism.drawing.bodies[name]
        state = self.instants.rates[:, :, index, 1].swapaxes(0, 1)
        for turn in self.turns:
            state = turn.seen(state) + turn.rates
        return state.copy()

    def _condition_numbers(self) -> Array:
        stack, count = self.mechanism.stack, len(self.instants.residual)
        numbers = np.zeros(count)
        for start in range(0, count, BATCH):
            part = slice(start, start + BATCH)
            placed = stack.place(self.instants.rotation[part], self.instants.origin[part])
            numbers[part] = np.linalg.cond(stack.jacobian(placed))
        return numbers


def _locked(array: Array) -> Array:
    array.setflags(write=False)
    return array
