r"""How fast the knuckle turns, and how fast that changes.

A body turns as two edges of it do: with n = e1 x e2 and what an approximate rate w leaves of the edges'
rates, s_i = e_i' - w x e_i,

    omega - w = [ (s_1 . e2) n - (s_1 . n) e2 + (s_2 . n) e1 ] / |n|^2,

since s_i = (omega - w) x e_i exactly; alpha likewise from s_i = e_i'' - omega x (omega x e_i) - w x e_i. The
points of a rigid body give the same rates whichever of them are taken, so this proves how far off a rate is
that was found from all points by least squares (see `rigid`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects import rigid
from pointcoord.effects.effect import Effect, Point, Poses, Quantity, no_role
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.enclosure import Enclosed, both, cross, dot, quotient
from pointcoord.numerics.rounding import EPS

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Points
    from pointcoord.bounds.proof import Numbers

Array = NDArray[np.float64]
States = Mapping[str, Array]
Edges = tuple[Array, Array]

VELOCITY = Quantity("angular_velocity", "angular velocity", "rad/s", "body")
ACCELERATION = Quantity("angular_acceleration", "angular acceleration", "rad/s^2", "body")


class RatesFormula(Protocol):
    """A way to tell how a body turns from how its points move."""

    @property
    def no_number(self) -> str:
        """Why a rate may be no number; empty if each always is one."""
        ...

    def rates(self, position: States, velocity: States, acceleration: States) -> tuple[Array, Array]:
        """Angular velocity and acceleration from the states of the body's points, each (..., 3)."""
        ...

    def loss(self, edges: Edges, rates: Edges) -> Array:
        """How many times what looking at the equations rounds it may lose, shape (..., 1).

        Args:
            edges: from the body's first point to its second and its third, (..., 3); rates: theirs.
        """
        ...


@dataclass(frozen=True)
class LeastSquares:
    """The turn that all points of the body follow best (see `rigid`)."""

    no_number: str = ""

    def rates(self, position: States, velocity: States, acceleration: States) -> tuple[Array, Array]:
        """Angular velocity and acceleration of the body."""
        return rigid.body_rates(
            *(rigid.stack_points(list(states.values())) for states in (position, velocity, acceleration))
        )

    def loss(self, edges: Edges, rates: Edges) -> Array:
        """Of a thin triangle the inertia cancels.

        J has a condition number near k = ((|e1|^2 + |e2|^2) / |e1 x e2|)^2, and a refined solution keeps a
        rounding of eps k of what it corrects; 4e3 covers the sums that J is made of. Of any knuckle but a
        needle the loss is 1.
        """
        first, second = edges
        area = np.linalg.norm(np.cross(first, second), axis=-1, keepdims=True)
        squares = np.sum(first * first + second * second, axis=-1, keepdims=True)
        return np.asarray(1.0 + 4e3 * EPS * (squares / area) ** 2)


@dataclass(frozen=True)
class BodyRates(Effect):
    """Angular velocity and acceleration of each body that the topology names.

    Attributes:
        formula: how they are told from the body's points.
    """

    formula: RatesFormula = LeastSquares()

    @property
    def no_number(self) -> str:
        """Why a rate may be no number: the formula knows."""
        return self.formula.no_number

    def needs(self, topology: Topology) -> Collection[str]:
        """The points of the bodies."""
        return {point for points in topology.bodies.values() for point in points}

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], axes: CarAxes) -> str:
        """There is a body whose rates they are."""
        return "" if topology.bodies else no_role(self.name, "knuckle", topology)

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """Rates of each body in the user's axes, each (..., N, 3); the chassis' motion turns nothing."""
        found: dict[str, dict[str, Array]] = {VELOCITY.name: {}, ACCELERATION.name: {}}
        for body, points in poses.mechanism.topology.bodies.items():
            states = ({point: state[point] for point in points} for state in poses.states[:3])
            found[VELOCITY.name][body], found[ACCELERATION.name][body] = self.formula.rates(*states)
        return found

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """What the rates of the body's edges leave of the reported ones."""
        found: dict[str, dict[str, Array]] = {VELOCITY.name: {}, ACCELERATION.name: {}}
        for body in numbers[VELOCITY.name]:
            names, spin = poses.mechanism.topology.bodies[body], None
            loss = self.formula.loss(*(_middles(points, names) for points in poses.points[:2]))
            for d, quantity in enumerate(found, 1):
                reported = numbers[quantity][body]
                # About a rate that is no number nothing can be proven, but what is expected can be said.
                near = np.nan_to_num(reported, posinf=0.0, neginf=0.0) * poses.powers[d][..., None]
                off = body_rate_error(poses.points[0], poses.points[d], names, near, spin)
                error = np.where(np.isfinite(reported), np.abs(off.middle) + off.radius[0], np.inf)
                found[quantity][body] = both(error, loss * off.radius[1]) / poses.powers[d][..., None]
                spin = off.corrected(near)
        return found


def _middles(points: Points, names: Sequence[str]) -> Edges:
    first, second, third = (points[name].middle for name in names[:3])
    return second - first, third - first


def body_rate_error(
    points: Points, rates: Points, names: Sequence[str], found: Array, pull: Enclosed | None
) -> Enclosed:
    """Exact rate of a body less the one that was found, (N, 3).

    Args:
        points, rates: positions and velocities, or accelerations, of the body's points.
        names: of the body's points; the first three are taken.
        found: the computed rate, (N, 3).
        pull: the exact angular velocity where `rates` are accelerations.
    """
    from pointcoord.bounds.enclosed_points import edges_of

    e1, e2 = edges_of(points, names)
    turning = e1.like(found)
    v1, v2 = edges_of(rates, names)
    s1, s2 = v1 - cross(turning, e1), v2 - cross(turning, e2)
    if pull is not None:
        s1, s2 = (s - cross(pull, cross(pull, edge)) for s, edge in ((s1, e1), (s2, e2)))
    normal = cross(e1, e2)
    along = dot(s1, e2).spread_out * normal
    across = dot(s2, normal).spread_out * e1 - dot(s1, normal).spread_out * e2
    return quotient(along + across, dot(normal, normal).spread_out)


KNUCKLE_RATES = BodyRates(
    name="knuckle_rates",
    gives="angular velocity and acceleration of the knuckle, rad/s, rad/s^2",
    sign="components along the user's axes, right-handed",
    derivative=2,
    quantities=(VELOCITY, ACCELERATION),
)
