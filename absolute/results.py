"""Points, bodies and lines of a solved motion, from the poses and rates of its bodies."""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from absolute.dual import Dual
from absolute.model import CHASSIS, Corner, Model
from absolute.solution import Solution
from absolute.vectors import EPS, Array, Counts, carried, cross


class Instants(NamedTuple):
    """Results at N instants, in units of size.

    Attributes:
        rotation, origin: (N, bodies, 3, 3) and (N, bodies, 3), the standing body first.
        slopes: (N, K + 1, bodies, 2, 3) velocities [o', w] of the bodies for a unit rate of one input each,
            then as they move.
        higher: (N, R - 1, bodies, 2, 3) accelerations [o'', w'] and higher rates of the bodies.
        residual, condition, corrections: (N,) as in `Configurations`.

    Rates are zero for the standing body, and those of the motion for all bodies if they were not asked for.
    """

    rotation: Array
    origin: Array
    slopes: Array
    higher: Array
    residual: Array
    condition: Array
    corrections: Counts


@dataclass(frozen=True)
class Motion:
    """Bodies of a model at N instants for effects and loads, in mm, before the car is displaced.

    Places are measured from the middle of the drawing, so that the distance of the car from its origin costs
    only the rounding of the last sum.

    Attributes:
        rotation, origin, slopes: as in `Instants`, in units of size.
        by: part, and "travel", "rack" or "roll", of the K inputs by which effects take derivatives; the
            derivatives by time follow these.
        part: the part whose wheel is used.
    """

    model: Model
    rotation: Array
    origin: Array
    slopes: Array
    by: tuple[tuple[str, str], ...] = ()
    part: str = ""

    @property
    def corner(self) -> Corner:
        """The wheel of the part."""
        return self.model.corners[self.part]

    @property
    def in_the_car(self) -> "Motion":
        """The motion in the frame of the chassis."""
        car = self.model.numbers[CHASSIS]
        if not car:
            return self
        turned, moving = self.rotation[:, [car]], self.slopes[:, :, [car]]
        back, arm = turned.swapaxes(-1, -2), self.origin - self.origin[:, [car]]
        slopes = self.slopes - moving
        slopes[..., 0, :] -= cross(moving[..., 1, :], arm[:, None])
        poses = {"rotation": back @ self.rotation, "origin": np.matvec(back, arm)}
        return replace(self, slopes=slopes @ turned[:, None], **poses)

    @property
    def drawn(self) -> "Motion":
        """The drawing, as one instant at rest."""
        bodies = len(self.model.bodies)
        rotation = np.broadcast_to(np.eye(3), (1, bodies, 3, 3))
        slopes = np.zeros((1, 1, bodies, 2, 3))
        return replace(self, rotation=rotation, origin=self.model.origins[None], slopes=slopes)

    def components(self, vector: Dual) -> Dual:
        """Components of a vector (3, N) along outboard, rearward and up as drawn."""
        return vector.along(self.corner.axes)

    def line(self, start: str, end: str) -> Dual:
        """(3, N) from one point to another; within one body it is the rotated drawn vector."""
        model = self.model
        body = next((body for body, points in model.bodies.items() if {start, end} <= set(points)), None)
        if body is None:
            return self.place(end) - self.place(start)
        return self._turned(model.numbers[body], model.line(start, end))

    def spin(self, by: str) -> Array:
        """(3, N) angular velocity of the knuckle for a unit rate of "travel", "rack" or "roll"."""
        body = self.model.numbers[self.corner.need("knuckle")]
        return np.asarray(self.slopes[:, self.by.index((self.part, by)), body, 1].T)

    def place(self, point: str) -> Dual:
        """(3, N) place of a point, from the middle."""
        size, body = self.model.size, self.model.holders[point]
        origin = Dual(self.origin[:, body].T * size, self.slopes[:, :, body, 0].transpose(2, 0, 1) * size)
        return origin + self._turned(body, self.model.arms[point])

    def _turned(self, body: int, line: Array) -> Dual:
        """(3, N) a vector fixed in a body; given as drawn, (3,), in units of size."""
        turned = self.rotation[:, body] @ (line * self.model.size)
        return Dual(turned.T, cross(self.slopes[:, :, body, 1], turned[:, None]).transpose(2, 0, 1))


def solution_of(model: Model, found: Instants, displaced: Array, rates: bool, **asked: Any) -> Solution:
    """The solution in mm, with the requested effects and forces by name.

    Args:
        displaced: (N, 1 + R, 3) displacement of the car and its rates, mm and s.
    """
    moving = np.concatenate((found.slopes[:, -1:], found.higher), 1) if rates else found.higher[:, :0]
    states = [dict(zip(model.points, of, strict=True)) for of in _points(model, found, moving, displaced)]
    # Without rates, all rates are empty.
    position, velocity, acceleration, *higher = states if rates else (*states, {}, {})
    spins = [{n: moving[:, order, model.numbers[n], 1] for n in model.reported if rates} for order in (0, 1)]
    # Coordinates up to the diameter are rounded by half a unit in the last place. The body on which a car
    # turns has 13 roundings in its rotation and origin (see `rows`), so an error of sqrt(13) eps / 2, which
    # all points share.
    rounding = (1 + 2 * sum(bool(drive.turns) for drive in model.inputs)) * EPS
    return Solution(
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        higher=tuple(higher),
        angular_velocity=spins[0],
        angular_acceleration=spins[1],
        iterations=found.corrections,
        residual=found.residual * model.size,
        condition=found.condition,
        accuracy=(found.residual + rounding) * model.size,
        **asked,
    )


def _points(model: Model, found: Instants, moving: Array, displaced: Array) -> Array:
    """(1 + R, P, N, 3) all points and their rates, mm and s, from the rates of the bodies."""
    body, arms = model.held()
    arm = np.matvec(found.rotation[:, body].swapaxes(0, 1), arms[:, None])
    state = np.empty((1 + moving.shape[1], *arm.shape))
    state[0] = found.origin[:, body].swapaxes(0, 1) + arm
    speeds, spins = moving[:, :, body].transpose(3, 1, 2, 0, 4)
    # p' = o' + w x r,  p'' = o'' + w' x r + w x (w x r)
    state[1:] = speeds + np.array(carried(arm, spins, len(state))[1:]).reshape(speeds.shape)
    state *= model.size
    # The standing body's points are exactly where they are drawn.
    given, still = np.array(list(model.points.values()))[:, None], (body == 0)[:, None, None]
    state[0] = np.where(still, 0.0, state[0])
    state += displaced.swapaxes(0, 1)[: len(state), None]
    state[0] += np.where(still, given, model.middle)
    return state
