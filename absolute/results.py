"""The points, bodies and lines of a solved motion, from the poses and rates of its bodies."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from absolute.dual import Dual, constant
from absolute.mechanism import Mechanism
from absolute.model import Corner
from absolute.solution import Array, Counts, Solution
from absolute.turning import Turning
from absolute.vectors import EPS, carried, cross

OF_POINTS = ("position", "velocity", "acceleration")
OF_BODIES = ("angular_velocity", "angular_acceleration")


class Instants(NamedTuple):
    """What was solved at N instants, in units of size.

    Attributes:
        rotation, origin: (N, bodies, 3, 3) and (N, bodies, 3), the chassis first.
        rates: (N, R, bodies, 2, 3) velocities [o', w], accelerations [o'', w'] and so on of the bodies; the
            chassis, and all where they are not asked for, stay at zero.
        slopes: (N, K, bodies, 2, 3) velocities of the bodies for a unit rate of one input each.
        residual: (N,) largest violation of a row.
        corrections: (N,) of Newton.
    """

    rotation: Array
    origin: Array
    rates: Array
    slopes: Array
    residual: Array
    corrections: Counts


@dataclass(frozen=True)
class Motion:
    """Instants of a mechanism with a chassis that is turned and displaced; it is what effects look at.

    Lengths are measured from the middle of the drawing until the last sum, so that the distance of the car
    from its origin costs no more than one rounding.

    Attributes:
        chassis: (N, 1 + R, 3) displacement of the chassis and its rates, mm and s, after its turns.
        by: part, and "travel", "rack" or "roll", of the K inputs that effects take derivatives by; behind
            these are those by time.
        part: whose wheel is looked at.
    """

    mechanism: Mechanism
    instants: Instants
    chassis: Array
    turns: tuple[Turning, ...]
    by: tuple[tuple[str, str], ...] = ()
    part: str = ""

    def solution(self, rates: bool, conditions: bool, **asked: Mapping[str, Array]) -> Solution:
        """The motion in mm, seen from the ground, with what is asked for: effects and forces by name."""
        size, model = self.mechanism.drawing.size, self.mechanism.model
        # Of body rates, angular velocity is the first.
        orders = 1 + self.instants.rates.shape[1] if rates else 1
        numbers: dict[str, dict[str, Array]] = {kind: {} for kind in (*OF_POINTS, *OF_BODIES)}
        states = [
            {n: _locked(a) for n, a in zip(self.mechanism.drawing.points, state, strict=True)}
            for state in self._points(orders)
        ]
        numbers |= zip(OF_POINTS, states, strict=False)
        bodies = [name for name in model.moving if name not in model.aids]
        for kind, state in zip(OF_BODIES if rates else (), self._bodies(bodies), strict=False):
            numbers[kind] = dict(zip(bodies, state, strict=True))
        numbers |= {kind: dict(of) for kind, of in asked.items()}
        iterations, residual = self.instants.corrections, self.instants.residual
        iterations.setflags(write=False)
        return Solution(
            iterations=iterations,
            residual=_locked(residual * size),
            condition=_locked(self._condition_numbers()) if conditions else None,
            # Points are rounded too, whatever is left of the rows: half a unit in the last place of lengths
            # up to the diameter.
            accuracy=_locked((residual + EPS) * size),
            higher=tuple(states[len(OF_POINTS) :]),
            **{kind: {n: _locked(a) for n, a in of.items()} for kind, of in numbers.items()},
        )

    @property
    def corner(self) -> Corner:
        """What of the linkage is the wheel, and which way the car points."""
        return self.mechanism.model.corners[self.part]

    def components(self, vector: Dual) -> Dual:
        """A vector (3, N) along outboard, rearward and up, which do not turn."""
        return vector.along(self.corner.axes)

    def line(self, start: str, end: str) -> Dual:
        """(3, N) from one point to another, mm.

        A line between two points of one body turns with it and is nothing but turned.
        """
        drawing, bodies = self.mechanism.drawing, self.mechanism.model.bodies
        body = next((body for body, points in bodies.items() if {start, end} <= set(points)), None)
        if body is None:
            return self._seen(self.place(end) - self.place(start))
        return self._seen(self._turned_line(drawing.bodies[body], drawing.line(start, end)))

    def moved(self, point: str) -> Dual:
        """(3, N) from the place where a point is drawn to where it is, mm, without the displacement of the
        chassis, which is the same for all points."""
        body, arm = self._holder(point)
        moved = self.place(point)
        moved[0] -= self.mechanism.drawing.origins[body] + arm
        # A turn takes the difference of two places as a vector, and moves the drawn one as well.
        slopes = np.zeros_like(moved[1:])
        for column, turns in self._turning:
            turned = np.zeros((2, *moved.shape[1:]))
            for turn in turns:
                turned = turn.seen_point(turned, self.mechanism.drawing.points[point])
            slopes[column] = turned[1]
        return self._seen(moved) + Dual(turned[0].T, slopes.T)

    def drawn(self, point: str) -> Dual:
        """(3, 1) where a point is drawn, mm."""
        return constant(self.mechanism.drawing.points[point][:, None])

    def riding(self, on: str, arm: Dual) -> Dual:
        """An arm (3, N) that from now on turns with a body."""
        return Dual(arm.value, cross(self.spin(on).T, arm.value.T).T)

    def spin(self, on: str) -> Array:
        """(3, N, K + 1) angular velocity of a body for unit rates of inputs, and over time, as the ground
        sees it."""
        spins = self._slopes(self.mechanism.drawing.bodies[on], 1)
        seen = self.turned(spins)
        for column, turns in self._turning:
            spin = spins[column][None]
            for turn in turns:
                spin = turn.seen(spin) + turn.rates[:1]
            seen[column] = spin[0]
        return seen.T

    @property
    def _turning(self) -> tuple[tuple[int, tuple[Turning, ...]], ...]:
        """The slopes in which the chassis turns, and how: by roll, and by time."""
        rolling = tuple(turn.by_roll for turn in self.turns)
        return (*((k, rolling) for k, (_, by) in enumerate(self.by) if by == "roll"), (-1, self.turns))

    def turned_back(self, vector: Array) -> Array:
        """Vectors (N, 3) that the ground sees, in the frame of the chassis."""
        for turn in reversed(self.turns):
            vector = np.matvec(turn.rotation.swapaxes(-1, -2), vector)
        return vector

    def turned(self, vector: Array) -> Array:
        """Vectors (..., N, 3) in the frame of the chassis, as the ground sees them."""
        for turn in self.turns:
            vector = np.matvec(turn.rotation, vector)
        return vector

    def _seen(self, vector: Array) -> Dual:
        """A vector and its slopes (2 + K, N, 3), in units of size, as the ground sees it, mm."""
        seen = self.turned(vector)
        for column, turns in self._turning:
            state = np.stack((vector[0], vector[1:][column]))
            for turn in turns:
                state = turn.seen(state)
            seen[1:][column] = state[1]
        seen = (seen * self.mechanism.drawing.size).T
        return Dual(seen[..., 0], seen[..., 1:])

    def _slopes(self, body: int, kind: int) -> Array:
        """(K + 1, N, 3) velocity of the origin of a body, or angular velocity (1), for unit rates of inputs,
        and over time."""
        by_inputs, over_time = self.instants.slopes, self.instants.rates[:, :1]
        return np.concatenate((by_inputs[:, :, body, kind], over_time[:, :, body, kind]), 1).swapaxes(0, 1)

    def _turned_line(self, body: int, line: Array) -> Array:
        """(2 + K, N, 3) a line of a body, (3,), and its slopes."""
        turned = self.instants.rotation[:, body] @ line
        return np.concatenate((turned[None], cross(self._slopes(body, 1), turned)))

    def place(self, point: str) -> Array:
        """(2 + K, N, 3) a point from the middle, on the chassis, and its slopes, in units of size."""
        body, arm = self._holder(point)
        origin = self.instants.origin[:, body]
        return np.concatenate((origin[None], self._slopes(body, 0))) + self._turned_line(body, arm)

    def _holder(self, point: str) -> tuple[int, Array]:
        """The body of a point, and the arm to the point from its origin in the drawing, in units of size."""
        drawing = self.mechanism.drawing
        body = drawing.bodies[drawing.holders[point]]
        return body, drawing.arm(body, point)

    def _points(self, orders: int) -> Array:
        """(orders, P, N, 3) all points and as many of their rates, mm and s."""
        drawing, (body, arms) = self.mechanism.drawing, self.mechanism.drawing.held()
        arm = np.matvec(self.instants.rotation[:, body].swapaxes(0, 1), arms[:, None])
        states = [self.instants.origin[:, body].swapaxes(0, 1) + arm]
        if orders > 1:
            speeds, spins = self.instants.rates[:, :, body].transpose(3, 1, 2, 0, 4)
            # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
            turning = carried(arm, spins, orders)[1:]
            states += [speed + turned for speed, turned in zip(speeds, turning, strict=True)]
        state = np.array(states) * drawing.size
        # What stands is where it is drawn, to the last digit.
        given, still = np.array(list(drawing.points.values()))[:, None], (body == 0)[:, None, None]
        base = drawing.middle if self.turns else np.where(still, given, drawing.middle)
        state[0] = np.where(still, given - base, state[0])
        for turn in self.turns:
            state = turn.seen_point(state, base)
        state += self.chassis.swapaxes(0, 1)[:orders, None]
        state[0] += base
        return state

    def _bodies(self, names: Sequence[str]) -> Array:
        """(2, B, N, 3) angular velocity and acceleration of bodies, rad and s."""
        indices = [self.mechanism.drawing.bodies[name] for name in names]
        state = self.instants.rates[:, :2, indices, 1].transpose(1, 2, 0, 3)
        for turn in self.turns:
            state = turn.seen(state) + turn.rates[:2, None]
        return state

    def _condition_numbers(self) -> Array:
        stack = self.mechanism.stack
        placed = stack.place(self.instants.rotation, self.instants.origin)
        return np.asarray(np.linalg.cond(stack.jacobian(placed)))


def _locked(array: Array) -> Array:
    array.setflags(write=False)
    return array
