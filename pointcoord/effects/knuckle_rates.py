r"""Angular velocity and angular acceleration of the knuckle.

They follow from the rates of two edges of the body (see `corner`). For an approximate rate w, the formula
with the remaining rates of the edges,

    s_i = e_i' - w x e_i = (omega - w) x e_i,

gives omega - w. For alpha the remaining rates are s_i = e_i'' - omega x (omega x e_i) - w x e_i. This refines
a rate, and it also proves an error bound for a rate found in any other way. The paper's quotient v65 x v75 /
(v65 . r75) is 0/0 whenever omega lies in the points' plane.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from pointcoord.effects.arithmetic import P, cross, multiple, plain, still
from pointcoord.effects.corner import turn_of_edges
from pointcoord.effects.effect import ALONG, Effect, Poses, Quantity, no_role
from pointcoord.errors import SingularConfiguration
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.enclosure import both
from pointcoord.numerics.rounding import EPS

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers

States = Mapping[str, Array]
Edges = tuple[Array, Array]

# Each refinement multiplies the first solution's rounding error by some EPS k (see `BodyRates.loss`): some
# 1e-3 for a needle 1e-6 as thick as long, where the error was still visible after one refinement.
REFINEMENTS = 2
TURNS = f"{ALONG}, right-handed"
VELOCITY = Quantity("angular_velocity", "angular velocity", "rad/s", "body", sign=TURNS)
ACCELERATION = Quantity("angular_acceleration", "angular acceleration", "rad/s^2", "body", sign=TURNS)


def _edges(points: Mapping[str, P], names: Iterable[str]) -> tuple[P, P]:
    first, second, third = (points[name] for name in islice(names, 3))
    return second - first, third - first


def body_rate_error(edges: tuple[P, P], rates: tuple[P, P], found: P, pull: P | None) -> P:
    """Exact rate of a body minus the computed one, (N, 3).

    Args:
        edges, rates: two edges of the body, and their velocities or accelerations.
        found: the computed rate.
        pull: the exact angular velocity if `rates` are accelerations, else None.
    """
    rest = [v - cross(found, edge) for v, edge in zip(rates, edges, strict=True)]
    if pull is not None:
        rest = [s - cross(pull, cross(pull, edge)) for s, edge in zip(rest, edges, strict=True)]
    return turn_of_edges(*edges, *rest)


def _require_apart(p: Array, q: Array) -> None:
    """Refuse a flat triangle, by the condition number of the inertia of unit masses at its corners.

    With s the sum of the squared side lengths, it is 2 s^2 / (3 |p x q|^2) + 2.
    """
    sides = sum(np.vecdot(side, side) for side in (p, q, p - q))
    normal = cross(p, q)
    with np.errstate(divide="ignore", invalid="ignore"):
        condition = 2.0 * sides**2 / (3.0 * np.vecdot(normal, normal)) + 2.0
    if not (condition * 8 * EPS < 1.0).all():
        raise SingularConfiguration(
            "the points of a body are in one line, so its turn about that line is free",
            float(np.max(condition)),
        )


@dataclass(frozen=True, eq=False)
class BodyRates(Effect):
    """Angular velocity and acceleration of each body in the topology's `bodies`."""

    def rates(self, position: States, velocity: States, acceleration: States) -> tuple[Array, Array]:
        """Angular velocity and acceleration of a body from the states of its points, each (..., 3).

        Raises:
            SingularConfiguration: the points are in one line; the rotation about it is free.
        """
        edges, *rates = (_edges(states, states) for states in (position, velocity, acceleration))
        # Scaled by a power of two near the body's size: products of lengths neither over- nor underflow.
        size = max(float(np.abs(plain(edge)).max(initial=0.0)) for edge in edges)
        scale = float(np.ldexp(1.0, -np.frexp(size or 1.0)[1]))
        edges, *rates = ((multiple(scale, p), multiple(scale, q)) for p, q in (edges, *rates))
        _require_apart(*map(plain, edges))

        def refined(of: Edges, pull: Array | None = None) -> Array:
            turn = still(edges[0])
            for _ in range(1 + REFINEMENTS):
                turn = turn + body_rate_error(edges, of, turn, pull)
            return turn

        omega = refined(rates[0])
        return omega, refined(rates[1], omega)

    def loss(self, edges: Edges, rates: Edges) -> Array:
        """Factor by which the rates' errors may exceed the rounding of the equations, shape (..., 1).

        In a thin triangle the first solution cancels. Its relative error is EPS k,
        k = ((|e1|^2 + |e2|^2) / |e1 x e2|)^2, and a refined solution has a rounding of that share in its
        correction; 4e3 covers the sums. The factor is 1 for any knuckle but a needle.

        Args:
            edges: from the body's first point to its second and its third, (..., 3); rates: of the edges.
        """
        first, second = edges
        area = np.linalg.norm(np.cross(first, second), axis=-1, keepdims=True)
        squares = np.sum(first * first + second * second, axis=-1, keepdims=True)
        return np.asarray(1.0 + 4e3 * EPS * (squares / area) ** 2)

    def needs(self, topology: Topology) -> Collection[str]:
        return {point for points in topology.bodies.values() for point in points}

    def refusal(self, topology: Topology, axes: CarAxes) -> str:
        return "" if topology.bodies else no_role(self.name, "knuckle", topology)

    def evaluate(self, poses: Poses | EnclosedPoses) -> dict[str, dict[str, Any]]:
        """Rates of each body in the user's axes, each (..., N, 3), with the chassis' rotations included."""
        found: dict[str, dict[str, Any]] = {VELOCITY.name: {}, ACCELERATION.name: {}}
        for body, points in poses.mechanism.topology.bodies.items():
            states: Iterator[Any] = ({point: state[point] for point in points} for state in poses.points[:3])
            found[VELOCITY.name][body], found[ACCELERATION.name][body] = self.rates(*states)
        return found

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Error bounds from the remaining rates of the edges at the reported body rates."""
        found: dict[str, dict[str, Array]] = {VELOCITY.name: {}, ACCELERATION.name: {}}
        for body in numbers[VELOCITY.name]:
            names, spin = poses.mechanism.topology.bodies[body], None
            edges, *rates = (_edges(points, names) for points in poses.points[:3])
            loss = self.loss(*((one.middle, other.middle) for one, other in (edges, rates[0])))
            for d, quantity in enumerate(found, 1):
                reported = numbers[quantity][body]
                # For a rate that is NaN nothing can be proven, but an expected error can be given.
                near = np.nan_to_num(reported, posinf=0.0, neginf=0.0) * poses.powers[d][..., None]
                off = body_rate_error(edges, rates[d - 1], edges[0].like(near), spin)
                error = np.where(np.isfinite(reported), np.abs(off.middle) + off.radius[0], np.inf)
                found[quantity][body] = both(error, loss * off.radius[1]) / poses.powers[d][..., None]
                spin = off.corrected(near)
        return found


KNUCKLE_RATES = BodyRates(
    name="knuckle_rates",
    gives="angular velocity and acceleration of the knuckle, rad/s, rad/s^2",
    derivative=2,
    quantities=(VELOCITY, ACCELERATION),
)
