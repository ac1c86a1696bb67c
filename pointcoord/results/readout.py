"""From the states of points to what a scene asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.reported_bounds import BodyLoss, loss_of_least_squares
from pointcoord.effects import rigid
from pointcoord.effects import wheel_angles as wheel
from pointcoord.effects.effect import Plan
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.results.motion import Channel, Samples

Array = NDArray[np.float64]
States = Sequence[Mapping[str, Array]]
"""For each time derivative, the points' states of shape (..., N, 3), mm, in the chassis' frame, from the
mechanism's origin."""

BodyRates = Callable[[Mapping[str, Array], Mapping[str, Array], Mapping[str, Array]], tuple[Array, Array]]


@dataclass(frozen=True)
class Readout:
    """How states become results.

    Attributes:
        chassis: what it does, which is added to the points' states.
        outboard: unit vector away from the car's middle.
        body_rates: angular velocity and acceleration of a body from its points' states; the least
            squares of `rigid` unless a variant replaces it.
        body_loss: how many times what least squares loses `body_rates` may lose.
    """

    mechanism: Mechanism
    plan: Plan
    chassis: ChassisMotion
    outboard: Array
    body_rates: BodyRates
    body_loss: BodyLoss = loss_of_least_squares

    def samples(self, times: Array, states: States) -> Samples:
        """Name the states and compute the effects of the plan from them."""
        asked = self.plan.effects
        shift = self.chassis.states(times, self.plan.derivative_of_points)
        position = _added(states[0], self.offset(times))
        derivatives = {
            quantity: _added(states[order], shift[order] if shift else None) if quantity in asked else None
            for order, quantity in ((1, "velocity"), (2, "acceleration"))
        }
        omegas: dict[str, Array] | None = None
        alphas: dict[str, Array] | None = None
        if "knuckle_rates" in asked:
            omegas, alphas = {}, {}
            for body, points in self.mechanism.topology.bodies.items():
                omegas[body], alphas[body] = self.body_rates(
                    *({point: states[order][point] for point in points} for order in range(3))
                )
        angles = None
        if "wheel_angles" in asked:
            angles = wheel_angles(self.mechanism, states[0], self.outboard)
        times = times.copy()
        times.setflags(write=False)
        return Samples(
            times=times,
            position=Channel("position", "", position),
            velocity=Channel("velocity", "velocity", derivatives["velocity"]),
            acceleration=Channel("acceleration", "acceleration", derivatives["acceleration"]),
            angular_velocity=Channel("angular velocity", "knuckle_rates", omegas),
            angular_acceleration=Channel("angular acceleration", "knuckle_rates", alphas),
            wheel=Channel("wheel angle", "wheel_angles", angles),
        )

    def offset(self, times: Array) -> Array | None:
        """What is added to every position, the origin and the chassis' displacement; None if it is zero."""
        origin = self.mechanism.origin[..., None, :]
        shift = self.chassis.states(times, 0)
        if not shift:
            return origin if origin.any() else None
        return origin + shift[0]

    @property
    def angle_lines(self) -> dict[str, tuple[str, str]]:
        """The line that each wheel angle is of, from point to point."""
        topology = self.mechanism.topology
        return {"camber": topology.wheel_axis, "kingpin": topology.steering_axis}

    @property
    def angle_axes(self) -> dict[str, tuple[Array, Array]]:
        """Directions whose components along the lines give minus the sine and the cosine of the angles."""
        up = self.mechanism.drawing.vectors["up"]
        return {"camber": (up, self.outboard), "kingpin": (self.outboard, up)}


def wheel_angles(mechanism: Mechanism, position: Mapping[str, Array], outboard: Array) -> dict[str, Array]:
    """Camber and kingpin angle of poses, rad, from positions of shape (..., 3)."""
    topology, up = mechanism.topology, mechanism.drawing.vectors["up"]
    inner, centre = (position[name] for name in topology.wheel_axis)
    lower, upper = (position[name] for name in topology.steering_axis)
    return {
        "camber": wheel.camber_angle(inner, centre, up, outboard),
        "kingpin": wheel.kingpin_angle(lower, upper, up, outboard),
    }


def _added(states: Mapping[str, Array], offset: Array | None) -> Mapping[str, Array]:
    return states if offset is None else {name: state + offset for name, state in states.items()}


def least_squares_rates(
    position: Mapping[str, Array], velocity: Mapping[str, Array], acceleration: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Angular velocity and acceleration of a body from all its points."""
    return rigid.body_rates(
        *(rigid.stack_points(list(s.values())) for s in (position, velocity, acceleration))
    )
