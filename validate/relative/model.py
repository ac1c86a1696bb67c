"""The relative-coordinate model of a suspension: built once from hardpoints, then solved at instants.

    model = build("macpherson", points, side="left", closure="drawn")
    poses = model.poses(inputs, times, tolerance=1e-9)
    rates = model.rates(poses, inputs)
    numbers = model.positions(poses)

Lengths go in and come out in mm; inside, the car has a size between one and two, as its joints' angles have.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validate.relative.accuracy import (
    FOLD,
    Deviations,
    angle_claims,
    body_claims,
    deviations,
    line_derivatives,
    line_vector,
    point_claims,
)
from validate.relative.angles import ANGLES, car_directions
from validate.relative.errors import HardpointsError, InputError, PoseError
from validate.relative.follow import Blocked, Poses, at_places, closed, follow, room
from validate.relative.linkage import Linkage
from validate.relative.rates import Rates, point_accelerations, point_velocities, rates_of
from validate.relative.suspensions import SUSPENSIONS
from validate.relative.suspensions.steered_arm import Axes
from validate.relative.tree import Places, Tree, U

Array = NDArray[np.float64]
Arrays = dict[str, Array]
Inputs = Mapping[str, ArrayLike]

TINIEST = 1e-250  # mm: the square of a smaller car is no normal number


@dataclass(frozen=True)
class Motion:
    """Rates at solved poses, counted in a unit of time of their own at each instant.

    Attributes:
        rates: in that unit. inputs: likewise, (N, drives, 3), rad and sizes of the car.
        exponent: the unit is two to this power, (N,), s.
    """

    rates: Rates
    inputs: Array
    exponent: NDArray[np.int64]


@dataclass(frozen=True)
class Model:
    """A suspension whose drawing is closed.

    Attributes:
        tree: Pinocchio's model and the closure equations; its workspace serves one thread at a time.
        home: the closed drawing.
        origin, unit: where it is measured from, (3,), mm, and in what, mm.
        directions: of the car, by name.
        drawn: hardpoints as drawn, (3,), mm.
    """

    tree: Tree
    home: Poses
    origin: Array
    unit: float
    directions: Mapping[str, Array]
    drawn: Mapping[str, Array]

    @property
    def linkage(self) -> Linkage:
        """Joints, closures and inputs as data."""
        return self.tree.linkage

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(drive.input for drive in self.linkage.drives)

    @property
    def closing(self) -> dict[str, float]:
        """How far each point moves when the drawing is closed, mm."""
        found = {}
        for name, place in zip(self.linkage.points, at_places(self.home, self._places)[0], strict=True):
            moved = place - (self.drawn[name] - self.origin) / self.unit
            found[name] = self.unit * float(np.linalg.norm(moved))
        return found

    @cached_property
    def _places(self) -> Places:
        """All points that are reported."""
        return self.tree.together(tuple(self.linkage.points.values()))

    def poses(self, inputs: Inputs, times: ArrayLike, tolerance: float = 0.0) -> Poses:
        """Solve the poses at instants one after the other, from the closed drawing.

        Args:
            inputs: by name, rad or mm: (N,), or (N, 3) of which the first column is used.
            times: increasing, (N,), s; they predict the next pose and say nothing else.
            tolerance: mm; Newton's method ends where the rows' root of the sum of squares is at most that. 0:
                where rounding ends it.
        Raises:
            InputError: an input is missing, is no number, or an angle is not from 0 to pi.
            PoseError: a pose does not exist, or the way to it is blocked; its `partial` has the poses before.
        """
        instants = np.asarray(times, dtype=float)
        values = self._values(inputs, len(instants))
        goal = max(tolerance / self.unit, float(np.linalg.norm(self.tree.noise)))
        try:
            # An input that is far too large leads to no pose, which is found out by overflow.
            with np.errstate(over="ignore", invalid="ignore"):
                return follow(self.tree, self.home, values, instants, goal)
        except Blocked as end:
            raise self._refusal(end, values[end.instant]) from end

    def rates(self, poses: Poses, inputs: Inputs) -> Motion:
        """Rates at solved poses.

        Args:
            inputs: value, rate and acceleration by name, (N, 3), rad or mm, and s.
        Raises:
            InputError: an input is missing or no number.
            PoseError: a pose is singular to rounding.
        """
        count = len(poses.q)
        series = np.stack([self._series(name, inputs, count, 3) for name in self.inputs], axis=1)
        for k, drive in enumerate(self.linkage.drives):
            if drive.kind == "travel":
                series[:, k] /= self.unit
        fastest = np.maximum(np.abs(series[..., 1]), np.sqrt(np.abs(series[..., 2]))).max(axis=1)
        exponent = np.where(fastest > 0.0, -np.frexp(fastest)[1], 0).astype(np.int64)
        series[..., 1] = np.ldexp(series[..., 1], exponent[:, None])
        series[..., 2] = np.ldexp(series[..., 2], 2 * exponent[:, None])
        try:
            return Motion(rates_of(self.tree, poses, series), series, exponent)
        except np.linalg.LinAlgError as error:
            raise self._singular(poses, series) from error

    def deviations(self, poses: Poses, motion: Motion) -> Deviations:
        """What the claims of accuracy are made of.

        Raises:
            PoseError: a pose is so near to a fold that its branch cannot be told; `partial` has those before.
        """
        try:
            found = deviations(self.tree, poses, motion.rates, motion.inputs)
        except np.linalg.LinAlgError as error:
            raise self._singular(poses, motion.inputs) from error
        near = ~(found.fold < FOLD)
        if near.any():
            raise self._near_fold(poses, motion.inputs, found, int(np.argmax(near)))
        return found

    def positions(self, poses: Poses) -> Arrays:
        """Every point, (N, 3), mm."""
        return self._by_point(at_places(poses, self._places) * self.unit + self.origin)

    def velocities(self, poses: Poses, motion: Motion) -> Arrays:
        """Every point's, (N, 3), mm/s."""
        found = point_velocities(poses, motion.rates.twists, self._places)
        return self._by_point(self._timed(motion, 1, self.unit, found))

    def accelerations(self, poses: Poses, motion: Motion) -> Arrays:
        """Every point's, (N, 3), mm/s^2."""
        rates = motion.rates
        found = point_accelerations(poses, rates.twists, rates.accelerations, self._places)
        return self._by_point(self._timed(motion, 2, self.unit, found))

    def angular_velocities(self, motion: Motion) -> Arrays:
        """Of the bodies that are reported, (N, 3), rad/s."""
        twists = motion.rates.twists
        return {
            name: self._timed(motion, 1, 1.0, twists[:, self.tree.bodies.index(body), 3:])
            for name, body in self.linkage.bodies.items()
        }

    def angular_accelerations(self, motion: Motion) -> Arrays:
        """Of the bodies that are reported, (N, 3), rad/s^2."""
        second = motion.rates.accelerations
        return {
            name: self._timed(motion, 2, 1.0, second[:, self.tree.bodies.index(body), 3:])
            for name, body in self.linkage.bodies.items()
        }

    def angles(self, poses: Poses) -> Arrays:
        """Camber, kingpin, toe and caster, (N,), rad."""
        found = {}
        for name, angle in ANGLES.items():
            line = self.linkage.spin_axis if angle.of == "spin" else self.linkage.steering_axis
            vector = line_vector(self.tree, poses, line)
            sine, cosine = (vector @ self.directions[axis] for axis in (angle.sine, angle.cosine))
            found[name] = np.arctan2(sine, cosine)
        return found

    def numbers(self, poses: Poses, motion: Motion | None = None) -> dict[str, Arrays]:
        """By quantity and point, body or angle: all, or positions and angles where no rates are given."""
        found = {"position": self.positions(poses), "wheel": self.angles(poses)}
        if motion is None:
            return found
        return found | {
            "velocity": self.velocities(poses, motion),
            "acceleration": self.accelerations(poses, motion),
            "angular_velocity": self.angular_velocities(motion),
            "angular_acceleration": self.angular_accelerations(motion),
        }

    def claims(self, poses: Poses, motion: Motion, known: Deviations) -> dict[str, Arrays]:
        """How far each number of `numbers` may be off."""
        position, velocity, acceleration = self.point_claims(poses, motion, known)
        angular_velocity, angular_acceleration = self.body_claims(poses, motion, known)
        return {
            "position": position,
            "velocity": velocity,
            "acceleration": acceleration,
            "angular_velocity": angular_velocity,
            "angular_acceleration": angular_acceleration,
            "wheel": self.angle_claims(poses, known),
        }

    def point_claims(self, poses: Poses, motion: Motion, known: Deviations) -> tuple[Arrays, Arrays, Arrays]:
        """How far places, velocities and accelerations may be off, by point, (N, 3), mm and s."""
        claims = point_claims(self.tree, poses, motion.rates, known, self._places)
        place, velocity, acceleration = (
            self._timed(motion, order, self.unit, claim) for order, claim in enumerate(claims)
        )
        place += U * np.abs(at_places(poses, self._places) * self.unit + self.origin)
        return self._by_point(place), self._by_point(velocity), self._by_point(acceleration)

    def body_claims(self, poses: Poses, motion: Motion, known: Deviations) -> tuple[Arrays, Arrays]:
        """How far angular velocities and accelerations may be off, by body, (N, 3), rad and s."""
        found: tuple[Arrays, Arrays] = ({}, {})
        for name, body in self.linkage.bodies.items():
            claims = body_claims(self.tree, poses, motion.rates, known, body)
            for order, (arrays, claim) in enumerate(zip(found, claims, strict=True), 1):
                arrays[name] = self._timed(motion, order, 1.0, claim)
        return found

    def angle_claims(self, poses: Poses, known: Deviations) -> Arrays:
        """How far the angles may be off, (N,), rad."""
        lines = {"spin": self.linkage.spin_axis, "steering": self.linkage.steering_axis}
        moved = {of: line_derivatives(self.tree, poses, known, line) for of, line in lines.items()}
        return {
            name: angle_claims(
                known, moved[angle.of], self.directions[angle.sine], self.directions[angle.cosine]
            )
            for name, angle in ANGLES.items()
        }

    def _by_point(self, array: Array) -> Arrays:
        """Of all points, (N, P, 3), by name."""
        return {name: array[:, k] for k, name in enumerate(self.linkage.points)}

    def _timed(self, motion: Motion, order: int, unit: float, array: Array) -> Array:
        """In mm and s."""
        exponent = (-order * motion.exponent).reshape(-1, *[1] * (array.ndim - 1))
        with np.errstate(over="ignore", under="ignore"):
            return np.ldexp(array, exponent) * unit if order else np.asarray(array * unit)

    def _series(self, name: str, inputs: Inputs, count: int, columns: int) -> Array:
        if name not in inputs:
            raise InputError(name, "missing", "; ".join(self.inputs))
        array = np.array(inputs[name], dtype=float)
        if columns == 1 and array.ndim == 2:
            array = array[:, 0]
        shape = (count,) if columns == 1 else (count, columns)
        if array.shape != shape:
            raise InputError(name, f"of the shape {array.shape}", f"{shape}")
        finite = np.isfinite(array).reshape(count, -1).all(axis=1)
        if not finite.all():
            wrong = int(np.argmin(finite))
            raise InputError(name, float(np.ravel(array[wrong])[0]), "finite numbers and rates", wrong)
        return array

    def _values(self, inputs: Inputs, count: int) -> Array:
        values = np.stack([self._series(name, inputs, count, 1) for name in self.inputs], axis=1)
        for k, drive in enumerate(self.linkage.drives):
            if drive.kind == "travel":
                values[:, k] /= self.unit
                continue
            wrong = ~((values[:, k] >= 0.0) & (values[:, k] <= np.pi))
            if wrong.any():
                first = int(np.argmax(wrong))
                raise InputError(drive.input, float(values[first, k]), "an angle from 0 to pi", first)
        return values

    def _told(self, values: Array) -> dict[str, float]:
        """Inputs in rad and mm, by name."""
        return {
            drive.input: float(value) * (self.unit if drive.kind == "travel" else 1.0)
            for drive, value in zip(self.linkage.drives, values, strict=True)
        }

    def _refusal(self, end: Blocked, wanted: Array) -> PoseError:
        error = PoseError(end.problem, end.instant, self._told(wanted), self._told(end.here), end.condition)
        error.partial = end.solved
        return error

    def _singular(self, poses: Poses, series: Array) -> PoseError:
        """Which pose is singular."""
        for k in range(len(poses.q)):
            one = poses.first(k + 1)
            try:
                rates_of(self.tree, one, series[: k + 1])
            except np.linalg.LinAlgError:
                return self._at_fold("is singular", poses, series, k, float("inf"))
        return self._at_fold("is singular", poses, series, len(poses.q) - 1, float("inf"))

    def _near_fold(self, poses: Poses, series: Array, found: Deviations, k: int) -> PoseError:
        words = "is so near to a fold that the pose cannot be told from that on its other side"
        return self._at_fold(words, poses, series, k, float(found.condition[k]))

    def _at_fold(self, words: str, poses: Poses, series: Array, k: int, condition: float) -> PoseError:
        there = self._told(series[k, :, 0])
        error = PoseError(words, k, there, there, condition)
        error.partial = poses.first(k) if k else None
        return error


def build(
    type: str,
    points: Mapping[str, Any],
    *,
    up: Any = (0.0, 0.0, 1.0),
    right: Any = (0.0, 1.0, 0.0),
    side: str = "left",
    closure: str = "drawn",
) -> Model:
    """A model of a suspension, with its drawing closed.

    Args:
        type: of suspension. points: by name, (3,), mm; `rack_centre` may be left out.
        up, right: axes of the car. side: of the car. closure: what closes the drawing.
    Raises:
        HardpointsError: the points make no mechanism.
        PoseError: the drawing does not close on the side that it is drawn on, or lies on a fold.
    """
    if type not in SUSPENSIONS:
        raise HardpointsError(repr(type), "is no suspension that this model has", ", ".join(SUSPENSIONS))
    drawn = {name: np.array(place, dtype=float) for name, place in points.items()}
    drawn.setdefault("rack_centre", drawn["tie_rod_inner"])
    origin, unit = _measure(drawn)
    near = {name: (place - origin) / unit for name, place in drawn.items()}
    axes = Axes(np.array(up, dtype=float), np.array(right, dtype=float))
    tree = Tree(SUSPENSIONS[type](near, axes, closure))
    goal = float(np.linalg.norm(tree.noise))
    directions = car_directions(axes.up, axes.right, side)
    try:
        home = closed(tree, goal)
    except Blocked as end:
        model = Model(tree, room(tree, 0), origin, unit, directions, drawn)
        told = model._told(end.here)
        raise PoseError(end.problem, None, told, told, end.condition) from end
    return Model(tree, home, origin, unit, directions, drawn)


def _measure(points: Mapping[str, Array]) -> tuple[Array, float]:
    """A place near the car from which differences are exact, (3,), mm, and a power of two, its size, mm.

    Raises:
        HardpointsError: the car has no size, or one that no number has the square of.
    """
    stack = np.array(list(points.values()))
    if not np.isfinite(stack).all():
        raise HardpointsError("hardpoints", "are not all numbers", "finite numbers")
    largest = float(np.abs(stack).max())
    if not largest < 2.0**1000:
        raise HardpointsError("hardpoints", f"lie {largest:.3g} mm away", "less than 1e300 mm")
    size = float(np.ptp(stack, axis=0).max())
    if not size > TINIEST:
        raise HardpointsError("hardpoints", f"lie within {size:.3g} mm", f"more than {TINIEST:g} mm")
    unit = float(np.ldexp(1.0, np.frexp(size)[1] - 1))
    grid = 8.0 * unit
    return np.asarray(np.trunc(stack.mean(axis=0) / grid) * grid + 0.0), unit
