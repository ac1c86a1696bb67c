"""Error bounds of every number that a motion reports, rates and angles too, component by component."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.enclosed_points import EnclosedPoses, enclosed_points
from pointcoord.bounds.enclosed_rates import enclosed_coordinates
from pointcoord.bounds.solved_coordinates import SolvedCoordinates
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION, Certificate
from pointcoord.numerics.linear import Factors
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
POSITION = "position"
Numbers = Mapping[str, Mapping[str, Array]]
"""Arrays by quantity and by name: of a point or a body (N, 3), of a car (N,)."""

# Solving rounds a few times as often as looking at an equation does: a factorisation, its use, a refinement;
# and a series leaves out less than the last two terms that its expected error counts.
ROUNDINGS = 3.0
# Powers of two by which a unit of time is chosen: its square still is a number.
LONGEST = 400


class Bounded(Protocol):
    """Something that reports numbers and knows how far they are off."""

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> Numbers:
        """Proven and expected error of each of its numbers, each with a leading dimension of 2.

        Args:
            numbers: everything that is reported, its own among it.
        """
        ...


@dataclass(frozen=True)
class Reported:
    """What a motion reports, and what went into it beside the coordinates.

    Attributes:
        numbers: what is to be bounded.
        effects: what gave them.
        axes: the car's, along which angles are measured.
        chassis: what it does, which was added to every point.
        laws: the driving inputs.
        solved: the coordinates, and how they were found.
    """

    numbers: Numbers
    effects: Sequence[Bounded]
    axes: CarAxes
    chassis: ChassisMotion
    laws: Mapping[str, TimeFunction]
    solved: SolvedCoordinates

    def enclosed_laws(self, times: Array) -> dict[str, list[Enclosed]]:
        """By input, where its value, rate and acceleration exactly are, each (N,)."""
        with np.errstate(all="ignore"):  # what overflows comes out infinite, which proves nothing
            laws = {**self.laws, **self.chassis.functions}
            return {name: law.enclosed(times) for name, law in laws.items()}

    def doubts(self, times: Array, certain: bool) -> dict[str, Array]:
        """How far the computed value of each law may be from the law's own, each (N,), rad or mm.

        Args:
            certain: take them for exact.
        """
        if certain:
            return {name: np.zeros_like(times) for name in self.laws}
        return {name: law.rounding(times) for name, law in self.laws.items()}

    def added(self, times: Array, origin: Array) -> Array | None:
        """What was added to every position to report it, as it was computed, (3, N), mm; None if nothing."""
        moved = self.chassis.states(times, 0)
        if moved:
            return (origin + moved[0]).T
        return np.repeat(origin[:, None], len(times), axis=1) if origin.any() else None

    def part(self, here: slice | NDArray[np.intp]) -> Reported:
        """The same at some of the instants."""
        part = {q: {n: a[here] for n, a in arrays.items()} for q, arrays in self.numbers.items()}
        return replace(self, numbers=part)


@dataclass(frozen=True)
class Proven:
    """Poses that are proven, with what their rates depend on.

    Attributes:
        times: (N,), s.
        states: computed coordinates y and their time derivatives, (N, size), units per s^d.
        data: what the known coordinates of y lack, their uncertainty and the one that is expected, (N, size).
        driven: by place in y, where each driven coordinate and its two derivatives are, each (N,).
        laws: by input, where its value and its two derivatives are, each (N,).
    """

    factors: Factors
    certificate: Certificate
    times: Array
    states: Sequence[Array]
    data: tuple[Array, Array, Array]
    driven: Mapping[int, Sequence[Enclosed]]
    laws: Mapping[str, Sequence[Enclosed]]


def driven_coordinates(
    mechanism: Mechanism, laws: Mapping[str, Sequence[Enclosed]]
) -> dict[int, tuple[Enclosed, Enclosed, Enclosed]]:
    """By place in y, where each driven coordinate and its two derivatives are, each (N,)."""
    with np.errstate(all="ignore"):
        return {
            mechanism.layout.scalar(drive.coordinate): drive.enclosed(laws[drive.input], mechanism.drawing)
            for drive in mechanism.topology.drives
        }


def reported_bounds(mechanism: Mechanism, pose: Proven, reported: Reported) -> tuple[Numbers, Numbers]:
    """Proven error of every number, and the error that the method makes at most where nothing is wrong."""
    with np.errstate(all="ignore"):
        return bounds_of_numbers(_enclosed(mechanism, pose, reported), reported.effects, reported.numbers)


def bounds_of_numbers(
    poses: EnclosedPoses, effects: Sequence[Bounded], numbers: Numbers
) -> tuple[Numbers, Numbers]:
    """The same of numbers, from where the points exactly are."""
    found: dict[str, dict[str, Array]] = {quantity: {} for quantity in numbers}
    with np.errstate(all="ignore"):  # what overflows comes out infinite, which proves nothing
        for effect in effects:
            for quantity, errors in effect.errors(poses, numbers).items():
                found[quantity] |= errors
    return _inflated(found, 0, INFLATION), _inflated(found, 1, ROUNDINGS)


def _inflated(found: Numbers, which: int, factor: float) -> dict[str, dict[str, Array]]:
    """One of two bounds of each number, times a factor, in place; what cannot be told is not bounded."""
    inflated = {q: {n: e[which] for n, e in part.items()} for q, part in found.items()}
    for part in inflated.values():
        for bound in part.values():
            bound *= factor
            np.copyto(bound, np.inf, where=np.isnan(bound))
    return inflated


def _enclosed(mechanism: Mechanism, pose: Proven, reported: Reported) -> EnclosedPoses:
    """Where the points of proven poses are."""
    time = unit_of_time(pose.states)
    powers = [time**d for d in range(3)]
    driven = {
        place: [part.scaled(power) for part, power in zip(parts, powers, strict=True)]
        for place, parts in pose.driven.items()
    }
    scaled = [state * p[:, None] for state, p in zip(pose.states, powers, strict=False)]
    summed, unsolved = reported.solved.summed(pose.times), reported.solved.unsolved(pose.times)
    coordinates = enclosed_coordinates(
        mechanism, pose.factors, pose.certificate, scaled, pose.data, driven, summed, unsolved, powers
    )
    added = reported.chassis.enclosed(pose.laws, mechanism.origin)
    points: Sequence[Mapping[str, Enclosed]] = enclosed_points(mechanism, coordinates)
    if reported.chassis.turns:
        laws = {
            name: [part.scaled(power) for part, power in zip(law, powers, strict=True)]
            for name, law in pose.laws.items()
        }
        points = reported.chassis.turned_exactly(laws, points, float(mechanism.unit))
    return EnclosedPoses(mechanism, reported.axes, points, added, powers)


def unit_of_time(states: Sequence[Array]) -> Array:
    """Powers of two that make rates and the roots of accelerations about 1 per unit of time, (N,), s.

    Args:
        states: coordinates and their derivatives, (N, ...), each over all that share the unit.
    """
    fastest = np.zeros(len(states[0]))
    for d, state in enumerate(states[1:], 1):
        every = tuple(range(1, state.ndim))
        largest = np.maximum(state.max(axis=every), -state.min(axis=every))
        fastest = np.maximum(fastest, largest ** (1.0 / d))
    exponent = np.frexp(np.where(np.isfinite(fastest) & (fastest > 0.0), fastest, 1.0))[1]
    return np.asarray(np.ldexp(1.0, -np.clip(exponent, -LONGEST, LONGEST)))
