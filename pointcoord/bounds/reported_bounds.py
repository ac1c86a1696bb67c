"""Error bounds of every number that a motion reports, rates and angles too, component by component."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_effects import Points, angle_error, body_rate_error, enclosed_points
from pointcoord.bounds.enclosed_rates import Summed, enclosed_coordinates
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed, dot
from pointcoord.numerics.kantorovich import INFLATION, Certificate
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.rounding import EPS
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Arrays = Mapping[str, Array]
BodyLoss = Callable[[tuple[Array, Array], tuple[Array, Array]], Array]
"""From the first two edges of a body and their rates, (..., 3), a factor of shape (..., 1)."""

RATES = ("position", "velocity", "acceleration")
TURNS = ("angular_velocity", "angular_acceleration")
# Solving rounds a few times as often as looking at an equation does: a factorisation, its use, a refinement;
# and a series leaves out less than the last two terms that its expected error counts.
ROUNDINGS = 3.0
# Powers of two by which a unit of time is chosen: its square still is a number.
LONGEST = 400


def loss_of_least_squares(edges: tuple[Array, Array], rates: tuple[Array, Array]) -> Array:
    """How many times more than its terms least squares lose: the inertia of a thin triangle cancels.

    J has a condition number near k = ((|e1|^2 + |e2|^2) / |e1 x e2|)^2, and a refined solution keeps a
    rounding of eps k of what it corrects; 4e3 covers the sums that J is made of. Of any knuckle but a needle
    it is 1.
    """
    first, second = edges
    area = np.linalg.norm(np.cross(first, second), axis=-1, keepdims=True)
    squares = np.sum(first * first + second * second, axis=-1, keepdims=True)
    return np.asarray(1.0 + 4e3 * EPS * (squares / area) ** 2)


@dataclass(frozen=True)
class Bounds:
    """A bound for every reported number; empty where a quantity was not asked for.

    Attributes:
        position, velocity, acceleration: by point, (N, 3), mm and s.
        angular_velocity, angular_acceleration: by body, (N, 3), rad/s and rad/s^2.
        wheel: by angle, (N,), rad.
    """

    position: Arrays = field(default_factory=dict)
    velocity: Arrays = field(default_factory=dict)
    acceleration: Arrays = field(default_factory=dict)
    angular_velocity: Arrays = field(default_factory=dict)
    angular_acceleration: Arrays = field(default_factory=dict)
    wheel: Arrays = field(default_factory=dict)


@dataclass(frozen=True)
class Reported:
    """What a motion reports, and what went into it beside the coordinates.

    Attributes:
        numbers: what is to be bounded, as arrays like those of `Bounds`.
        chassis: what it does, which was added to every point.
        laws: the driving inputs.
        lines: for each wheel angle the line that leans, from point to point.
        axes: for each wheel angle the directions whose components along the line give -sine and cosine.
        summed: how the coordinates and their derivatives were summed at instants; nothing if solved for.
        body_loss: how many times what least squares loses the formula of the bodies' rates may lose.
    """

    numbers: Bounds
    chassis: ChassisMotion
    laws: Mapping[str, TimeFunction]
    lines: Mapping[str, tuple[str, str]]
    axes: Mapping[str, tuple[Array, Array]]
    summed: Callable[[Array], Sequence[Summed]]
    body_loss: BodyLoss

    def driven(self, mechanism: Mechanism, times: Array) -> dict[int, tuple[Enclosed, Enclosed, Enclosed]]:
        """By place in y, where each driven coordinate and its two derivatives are, each (N,)."""
        found = {}
        with np.errstate(all="ignore"):  # what overflows comes out infinite, which proves nothing
            for drive in mechanism.topology.drives:
                law = self.laws[drive.input].enclosed(times)
                found[mechanism.layout.scalar(drive.coordinate)] = drive.enclosed(law, mechanism.drawing)
        return found

    def part(self, low: int, high: int) -> Reported:
        """The same at some of the instants."""
        return Reported(
            _each(self.numbers, lambda array: array[low:high]),
            self.chassis,
            self.laws,
            self.lines,
            self.axes,
            self.summed,
            self.body_loss,
        )


@dataclass(frozen=True)
class Proven:
    """Poses that are proven, with what their rates depend on.

    Attributes:
        times: (N,), s.
        states: computed coordinates y and their time derivatives, (N, size), units per s^d.
        data: what the known coordinates of y lack, their uncertainty and the one that is expected, (N, size).
        driven: by place in y, where each driven coordinate and its two derivatives are, each (N,).
    """

    factors: Factors
    certificate: Certificate
    times: Array
    states: Sequence[Array]
    data: tuple[Array, Array, Array]
    driven: Mapping[int, Sequence[Enclosed]]


def reported_bounds(mechanism: Mechanism, pose: Proven, reported: Reported) -> tuple[Bounds, Bounds]:
    """Proven error of every number, and the error that the method makes at most where nothing is wrong."""
    times, states = pose.times, pose.states
    with np.errstate(all="ignore"):  # what overflows comes out infinite, which proves nothing
        time = _unit_of_time(states)
        powers = [time**d for d in range(3)]
        driven = {
            place: [part.scaled(power) for part, power in zip(parts, powers, strict=True)]
            for place, parts in pose.driven.items()
        }
        scaled = [state * p[:, None] for state, p in zip(states, powers, strict=False)]
        summed = reported.summed(times)
        coordinates = enclosed_coordinates(
            mechanism, pose.factors, pose.certificate, scaled, pose.data, driven, summed, powers
        )
        points = enclosed_points(mechanism, coordinates)
        numbers, added = reported.numbers, reported.chassis.enclosed(times, mechanism.origin)
        found = {
            quantity: _of_points(mechanism, points[d], getattr(numbers, quantity), added[d], powers[d])
            for d, quantity in enumerate(RATES[: len(states)])
        }
        if len(states) == len(RATES):
            found |= _of_bodies(mechanism, points, numbers, powers, reported.body_loss)
        found["wheel"] = {
            name: _of_angle(points[0], reported.lines[name], reported.axes[name], angle)
            for name, angle in numbers.wheel.items()
        }
        # What cannot be told is not bounded.
        each = {
            q: {n: np.where(np.isnan(b), np.inf, b) for n, b in part.items()} for q, part in found.items()
        }
    proven = {q: {n: INFLATION * b[0] for n, b in part.items()} for q, part in each.items()}
    expected = {q: {n: ROUNDINGS * b[1] for n, b in part.items()} for q, part in each.items()}
    return Bounds(**proven), Bounds(**expected)


def _unit_of_time(states: Sequence[Array]) -> Array:
    """Powers of two that make rates and the roots of accelerations about 1 per unit of time, (N,), s."""
    fastest = np.zeros(len(states[0]))
    for d, state in enumerate(states[1:], 1):
        fastest = np.maximum(fastest, np.abs(state).max(axis=-1) ** (1.0 / d))
    exponent = np.frexp(np.where(np.isfinite(fastest) & (fastest > 0.0), fastest, 1.0))[1]
    return np.asarray(np.ldexp(1.0, -np.clip(exponent, -LONGEST, LONGEST)))


def _of_points(
    mechanism: Mechanism, points: Points, numbers: Arrays, added: Enclosed, power: Array
) -> dict[str, Array]:
    """Both bounds of a derivative of all points, (2, N, 3)."""
    unit = (float(mechanism.unit) / power)[:, None]
    places = {name: points[name].scaled(unit) + added for name in numbers}
    return {name: np.stack([place.apart(numbers[name]), place.radius[1]]) for name, place in places.items()}


def _of_bodies(
    mechanism: Mechanism,
    points: Sequence[Points],
    numbers: Bounds,
    powers: Sequence[Array],
    body_loss: BodyLoss,
) -> dict[str, dict[str, Array]]:
    """Both bounds of the rates of bodies, (2, N, 3)."""
    found: dict[str, dict[str, Array]] = {name: {} for name in TURNS}
    for body in numbers.angular_velocity:
        names, spin = mechanism.topology.bodies[body], None
        places, rates = (
            (second.middle - first.middle, third.middle - first.middle)
            for first, second, third in ([state[name] for name in names[:3]] for state in points[:2])
        )
        loss = body_loss(places, rates)
        for d, quantity in enumerate(TURNS, 1):
            reported = getattr(numbers, quantity)[body]
            # About a rate that is no number nothing can be proven, but what is expected can be said.
            near = np.nan_to_num(reported, posinf=0.0, neginf=0.0) * powers[d][:, None]
            off = body_rate_error(points[0], points[d], names, near, spin)
            error = np.where(np.isfinite(reported), np.abs(off.middle) + off.radius[0], np.inf)
            found[quantity][body] = np.stack([error, loss * off.radius[1]]) / powers[d][:, None]
            spin = Enclosed.of(near, off.middle, *off.radius)
    return found


def _of_angle(points: Points, line: tuple[str, str], axes: tuple[Array, Array], angle: Array) -> Array:
    """Both bounds of an angle of a line, (2, N)."""
    start, end = (points[point] for point in line)
    sine, cosine = (dot(end - start, Enclosed.of(axis)) for axis in axes)
    return angle_error(-sine, cosine, angle)


def joined(parts: Sequence[Bounds]) -> Bounds:
    """Bounds of consecutive instants as one; none of none."""
    if not parts:
        return Bounds()
    return Bounds(
        **{
            f.name: {
                name: np.concatenate([getattr(part, f.name)[name] for part in parts])
                for name in getattr(parts[0], f.name)
            }
            for f in fields(Bounds)
        }
    )


def _each(numbers: Bounds, change: Callable[[Array], Array]) -> Bounds:
    return Bounds(
        **{f.name: {n: change(a) for n, a in getattr(numbers, f.name).items()} for f in fields(Bounds)}
    )
