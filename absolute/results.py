"""Points, bodies and lines of a solved motion, from the poses and rates of its bodies."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.dual import Dual, constant
from absolute.mechanism import Mechanism
from absolute.model import CHASSIS, Corner
from absolute.solution import Solution
from absolute.vectors import EPS, Array, Counts, carried, cross


class Instants(NamedTuple):
    """Results at N instants, in units of size.

    Attributes:
        rotation, origin: (N, bodies, 3, 3) and (N, bodies, 3), the standing body first.
        rates: (N, R, bodies, 2, 3) velocities [o', w], accelerations [o'', w'] and higher rates of the
            bodies; zero for the standing body, and for all without rates.
        slopes: (N, K, bodies, 2, 3) velocities of the bodies for a unit rate of one input each.
        residual, condition, corrections: (N,) as in `Configurations`.
    """

    rotation: Array
    origin: Array
    rates: Array
    slopes: Array
    residual: Array
    condition: Array
    corrections: Counts


@dataclass(frozen=True)
class Motion:
    """Instants of a mechanism for effects and loads, in mm, before the car is displaced.

    Places are measured from the middle of the drawing, so that the distance of the car from its origin costs
    only the rounding of the last sum.

    Attributes:
        by: part, and "travel", "rack" or "roll", of the K inputs by which effects take derivatives; the
            derivatives by time follow these.
        part: the part whose wheel is used.
    """

    mechanism: Mechanism
    instants: Instants
    by: tuple[tuple[str, str], ...] = ()
    part: str = ""

    @property
    def corner(self) -> Corner:
        """The wheel of the part."""
        return self.mechanism.model.corners[self.part]

    @property
    def in_the_car(self) -> "Motion":
        """The motion in the frame of the chassis."""
        of, car = self.instants, self.mechanism.drawing.bodies[CHASSIS]
        if not car:
            return self
        turned, base = of.rotation[:, [car]], of.origin[:, [car]]
        back, arm = turned.swapaxes(-1, -2), of.origin - base
        slopes = self._slopes - self._slopes[:, :, [car]]
        slopes[..., 0, :] -= cross(self._slopes[:, :, [car], 1], arm[:, None])
        slopes = slopes @ turned[:, None]
        rotation, origin = back @ of.rotation, np.matvec(back, arm)
        still = of._replace(rotation=rotation, origin=origin, slopes=slopes[:, :-1], rates=slopes[:, -1:])
        return replace(self, instants=still)

    @cached_property
    def _slopes(self) -> Array:
        """(N, K + 1, bodies, 2, 3) velocities for unit rates of the inputs, then by time."""
        return np.concatenate((self.instants.slopes, self.instants.rates[:, :1]), 1)

    def components(self, vector: Dual) -> Dual:
        """Components of a vector (3, N) along outboard, rearward and up as drawn."""
        return vector.along(self.corner.axes)

    def line(self, start: str, end: str) -> Dual:
        """(3, N) from one point to another; within one body it is the rotated drawn vector."""
        drawing, bodies = self.mechanism.drawing, self.mechanism.model.bodies
        body = next((body for body, points in bodies.items() if {start, end} <= set(points)), None)
        if body is None:
            return self.place(end) - self.place(start)
        return self._turned(drawing.bodies[body], drawing.line(start, end))

    def moved(self, point: str) -> Dual:
        """(3, N) displacement of a point from its drawn place."""
        drawing = self.mechanism.drawing
        body = drawing.bodies[drawing.holders[point]]
        drawn = (drawing.origins[body] + drawing.arm(body, point)) * drawing.size
        return self.place(point) - constant(drawn[:, None])

    def drawn(self, point: str) -> Dual:
        """(3, 1) drawn place of a point."""
        return constant(self.mechanism.drawing.points[point][:, None])

    def riding(self, on: str, arm: Dual) -> Dual:
        """A vector (3, N) with its derivatives if it turns with a body."""
        return Dual(arm.value, cross(self.spin(on).T, arm.value.T).T)

    def spin(self, on: str) -> Array:
        """(3, N, K + 1) angular velocity of a body for unit rates of the inputs, then by time."""
        return self._slopes[:, :, self.mechanism.drawing.bodies[on], 1].transpose(2, 0, 1)

    def place(self, point: str) -> Dual:
        """(3, N) place of a point, from the middle."""
        drawing = self.mechanism.drawing
        body = drawing.bodies[drawing.holders[point]]
        arm = self._turned(body, drawing.arm(body, point))
        origin, slopes = self.instants.origin[:, body].T, self._slopes[:, :, body, 0].transpose(2, 0, 1)
        return Dual(origin * drawing.size, slopes * drawing.size) + arm

    def _turned(self, body: int, line: Array) -> Dual:
        """(3, N) a vector fixed in a body; given as drawn, (3,), in units of size."""
        turned = self.instants.rotation[:, body] @ (line * self.mechanism.drawing.size)
        return Dual(turned.T, cross(self._slopes[:, :, body, 1], turned[:, None]).transpose(2, 0, 1))


def solution_of(
    mechanism: Mechanism,
    found: Instants,
    displaced: Array,
    rates: bool,
    **asked: Mapping[str, Array],
) -> Solution:
    """The solution in mm, with the requested effects and forces by name.

    Args:
        displaced: (N, 1 + R, 3) displacement of the car and its rates, mm and s.
    """
    size, turns = mechanism.drawing.size, sum(drive.turns for drive in mechanism.model.inputs)
    states = _points(mechanism, found, displaced, 1 + found.rates.shape[1] if rates else 1)
    points = [dict(zip(mechanism.drawing.points, map(_locked, state), strict=True)) for state in states]
    # Without rates, all rates are empty.
    position, velocity, acceleration, *higher = points if rates else (*points, {}, {})
    bodies = {name: mechanism.drawing.bodies[name] for name in mechanism.model.reported if rates}
    spins = [{n: _locked(found.rates[:, order, k, 1]) for n, k in bodies.items()} for order in range(2)]
    return Solution(
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        higher=tuple(higher),
        angular_velocity=spins[0],
        angular_acceleration=spins[1],
        iterations=_locked(found.corrections),
        residual=_locked(found.residual * size),
        condition=_locked(found.condition),
        # Coordinates up to the diameter are rounded by half a unit in the last place. The body on which a car
        # turns has 13 roundings in its rotation and origin (see `rows`), so an error of sqrt(13) eps / 2,
        # which all points share.
        accuracy=_locked((found.residual + (1 + 2 * turns) * EPS) * size),
        **{kind: {n: _locked(a) for n, a in of.items()} for kind, of in asked.items()},
    )


def _points(mechanism: Mechanism, found: Instants, displaced: Array, orders: int) -> Array:
    """(orders, P, N, 3) all points and their rates, mm and s."""
    drawing, (body, arms) = mechanism.drawing, mechanism.drawing.held()
    arm = np.matvec(found.rotation[:, body].swapaxes(0, 1), arms[:, None])
    state = np.empty((orders, *arm.shape))
    state[0] = found.origin[:, body].swapaxes(0, 1) + arm
    if orders > 1:
        speeds, spins = found.rates[:, :, body].transpose(3, 1, 2, 0, 4)
        # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
        state[1:] = speeds + carried(arm, spins, orders)[1:]
    state *= drawing.size
    # The standing body's points are exactly where they are drawn.
    given, still = np.array(list(drawing.points.values()))[:, None], (body == 0)[:, None, None]
    base = np.where(still, given, drawing.middle)
    state[0] = np.where(still, 0.0, state[0])
    state += displaced.swapaxes(0, 1)[:orders, None]
    state[0] += base
    return state


def _locked(array: NDArray[Any]) -> Any:
    array.setflags(write=False)
    return array
