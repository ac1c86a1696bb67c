"""The relative-coordinate model of a mechanism: built from its flat description, then solved at instants.

    model = build(plain)
    poses = model.poses(inputs, times, tolerance=1e-9)
    rates = model.rates(poses, inputs)
    numbers = model.positions(poses)

Lengths go in and come out in mm; inside, the car has a size between one and two, as its joints' angles have.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validate.relative.accuracy import (
    FOLD,
    Deviations,
    Line,
    angle_claims,
    body_claims,
    deviations,
    line_derivatives,
    point_claims,
    violated,
)
from validate.relative.errors import HardpointsError, InputError, PoseError
from validate.relative.follow import Blocked, Poses, at_places, closed, follow
from validate.relative.rates import Rates, rates_of
from validate.relative.tree import Places, Tree, U
from validate.spanning_tree.cut import CutError, cut
from validate.spanning_tree.wheels import Angle, knuckles, wheel_angles

Array = NDArray[np.float64]
Arrays = dict[str, Array]
Inputs = Mapping[str, ArrayLike]
# What an input may be: an angle is told by its cosine, and rods of no length have no direction.
BETWEEN = {
    "angle": (0.0, np.pi, "an angle from 0 to pi"),
    "distance": (np.nextafter(0.0, 1.0), np.inf, "a distance above 0"),
}


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
    """A mechanism whose drawing is closed.

    Attributes:
        tree: Pinocchio's model and the rows; its workspace serves one thread at a time.
        home: the closed drawing.
        bodies: those that are reported, by the name that they are reported by. wheel: likewise the angles.
    """

    tree: Tree
    home: Poses
    bodies: Mapping[str, str]
    wheel: Mapping[str, Angle]

    @property
    def unit(self) -> float:
        """In which lengths are counted inside, mm."""
        return self.tree.cut.unit

    @property
    def closing(self) -> dict[str, float]:
        """How far each point moves when the drawing is closed, mm."""
        drawn, places = self.tree.cut.drawn, at_places(self.home, self._places)[0]
        moved = zip(self.tree.cut.points, places, strict=True)
        return {name: self.unit * float(np.linalg.norm(at - drawn[name])) for name, at in moved}

    @cached_property
    def _places(self) -> Places:
        """All points that are reported."""
        return self.tree.together(tuple(self.tree.cut.points.values()))

    @cached_property
    def _lines(self) -> dict[tuple[str, str], Line]:
        """Lines of the angles, by their points."""
        ends = dict.fromkeys((angle.start, angle.end) for angle in self.wheel.values())
        return {pair: Line.of(self.tree, *self.tree.cut.line(*pair)) for pair in ends}

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
        drives = self.tree.drives
        series = np.stack([self._series(d.input, inputs, count, 3) for d in drives], axis=1)
        for k, drive in enumerate(drives):
            if not drive.is_angle:
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
            PoseError: a pose is so near to a fold that its branch cannot be told, or violates a row that is
                left out; `partial` has those before.
        """
        try:
            found = deviations(self.tree, poses, motion.rates, motion.inputs)
        except np.linalg.LinAlgError as error:
            raise self._singular(poses, motion.inputs) from error
        near = ~(found.fold < FOLD)
        if near.any():
            raise self._near_fold(poses, motion.inputs, found, int(np.argmax(near)))
        broken = violated(self.tree, poses, motion.rates, motion.inputs, found)
        if broken.any():
            k, row = (int(i) for i in np.argwhere(broken)[0])
            name = self.tree.left_out.rows[row].name
            words = f"does not hold {name}, which follows from the other rows only as drawn"
            raise self._at_fold(words, poses, motion.inputs, k, float(found.condition[k]))
        return found

    def positions(self, poses: Poses) -> Arrays:
        """Every point, (N, 3), mm."""
        return self._by_point(at_places(poses, self._places) * self.unit + self.tree.cut.origin)

    def velocities(self, poses: Poses, motion: Motion) -> Arrays:
        """Every point's, (N, 3), mm/s."""
        found = self._places.now(motion.rates.matrices[1])
        return self._by_point(self._timed(motion, 1, self.unit, found))

    def accelerations(self, poses: Poses, motion: Motion) -> Arrays:
        """Every point's, (N, 3), mm/s^2."""
        found = self._places.now(motion.rates.matrices[2])
        return self._by_point(self._timed(motion, 2, self.unit, found))

    def angular_velocities(self, motion: Motion) -> Arrays:
        """Of the bodies that are reported, (N, 3), rad/s."""
        twists = motion.rates.twists
        return {
            name: self._timed(motion, 1, 1.0, twists[:, self.tree.number[body], 3:])
            for name, body in self.bodies.items()
        }

    def angular_accelerations(self, motion: Motion) -> Arrays:
        """Of the bodies that are reported, (N, 3), rad/s^2."""
        second = motion.rates.accelerations
        return {
            name: self._timed(motion, 2, 1.0, second[:, self.tree.number[body], 3:])
            for name, body in self.bodies.items()
        }

    def angles(self, poses: Poses, turn: Array | None = None) -> Arrays:
        """Angles of the wheels, (N,), rad; on a chassis that is turned, (N, 3, 3)."""
        lines = {ends: self._turned(line.now(poses.matrices), turn) for ends, line in self._lines.items()}
        return {name: angle.of(lines[angle.start, angle.end]) for name, angle in self.wheel.items()}

    @staticmethod
    def _turned(vectors: Array, turn: Array | None) -> Array:
        return vectors if turn is None else np.asarray(np.einsum("nij,n...j->n...i", turn, vectors))

    def numbers(
        self, poses: Poses, motion: Motion | None = None, turn: Array | None = None
    ) -> dict[str, Arrays]:
        """By quantity and point, body or angle: all, or positions and angles where no rates are given.

        Args:
            turn: of the chassis, which only angles are given with, (N, 3, 3).
        """
        found = {"position": self.positions(poses), "wheel": self.angles(poses, turn)}
        if motion is None:
            return found
        return found | {
            "velocity": self.velocities(poses, motion),
            "acceleration": self.accelerations(poses, motion),
            "angular_velocity": self.angular_velocities(motion),
            "angular_acceleration": self.angular_accelerations(motion),
        }

    def claims(
        self, poses: Poses, motion: Motion, known: Deviations, turn: Array | None = None
    ) -> dict[str, Arrays]:
        """How far each number of `numbers` may be off."""
        position, velocity, acceleration = self.point_claims(poses, motion, known)
        angular_velocity, angular_acceleration = self.body_claims(poses, motion, known)
        return {
            "position": position,
            "velocity": velocity,
            "acceleration": acceleration,
            "angular_velocity": angular_velocity,
            "angular_acceleration": angular_acceleration,
            "wheel": self.angle_claims(poses, known, turn),
        }

    def point_claims(self, poses: Poses, motion: Motion, known: Deviations) -> tuple[Arrays, Arrays, Arrays]:
        """How far places, velocities and accelerations may be off, by point, (N, 3), mm and s."""
        claims = point_claims(self.tree, poses, motion.rates, known, self._places)
        place, velocity, acceleration = (
            self._timed(motion, order, self.unit, claim) for order, claim in enumerate(claims)
        )
        place += U * np.abs(at_places(poses, self._places) * self.unit + self.tree.cut.origin)
        return self._by_point(place), self._by_point(velocity), self._by_point(acceleration)

    def body_claims(self, poses: Poses, motion: Motion, known: Deviations) -> tuple[Arrays, Arrays]:
        """How far angular velocities and accelerations may be off, by body, (N, 3), rad and s."""
        found: tuple[Arrays, Arrays] = ({}, {})
        for name, body in self.bodies.items():
            claims = body_claims(self.tree, poses, motion.rates, known, body)
            for order, (arrays, claim) in enumerate(zip(found, claims, strict=True), 1):
                arrays[name] = self._timed(motion, order, 1.0, claim)
        return found

    def angle_claims(self, poses: Poses, known: Deviations, turn: Array | None = None) -> Arrays:
        """How far the angles may be off, (N,), rad."""
        moved = {}
        for ends, line in self._lines.items():
            found = line_derivatives(self.tree, poses, known, line)
            vector, by = self._turned(found.vector, turn), self._turned(found.by, turn)
            moved[ends] = replace(found, vector=vector, by=by)
        return {
            name: angle_claims(known, moved[angle.start, angle.end], angle.sine, angle.cosine)
            for name, angle in self.wheel.items()
        }

    def _by_point(self, array: Array) -> Arrays:
        """Of all points, (N, P, 3), by name."""
        return {name: array[:, k] for k, name in enumerate(self.tree.cut.points)}

    def _timed(self, motion: Motion, order: int, unit: float, array: Array) -> Array:
        """In mm and s."""
        exponent = (-order * motion.exponent).reshape(-1, *[1] * (array.ndim - 1))
        with np.errstate(over="ignore", under="ignore"):
            return np.ldexp(array, exponent) * unit if order else np.asarray(array * unit)

    def _series(self, name: str, inputs: Inputs, count: int, columns: int) -> Array:
        if name not in inputs:
            raise InputError(name, "missing", "; ".join(d.input for d in self.tree.drives))
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
        drives = self.tree.drives
        values = np.stack([self._series(d.input, inputs, count, 1) for d in drives], axis=1)
        for k, drive in enumerate(drives):
            if not drive.is_angle:
                values[:, k] /= self.unit
            if drive.kind not in BETWEEN:
                continue
            least, most, words = BETWEEN[drive.kind]
            wrong = ~((values[:, k] >= least) & (values[:, k] <= most))
            if wrong.any():
                first = int(np.argmax(wrong))
                value = self.tree.cut.told(values[first])[drive.input]
                raise InputError(drive.input, value, words, first)
        return values

    def _refusal(self, end: Blocked, wanted: Array) -> PoseError:
        wanted_here, reached = (self.tree.cut.told(values) for values in (wanted, end.here))
        error = PoseError(end.problem, end.instant, wanted_here, reached, end.condition, end.links)
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
        there = self.tree.cut.told(series[k, :, 0])
        links = self.tree.holding(poses.jacobian[k])
        error = PoseError(words, k, there, there, condition, links)
        error.partial = poses.first(k) if k else None
        return error


def build(plain: Mapping[str, Any]) -> Model:
    """A model of a flat mechanism, with its drawing closed.

    Raises:
        HardpointsError: the points make no mechanism, or the inputs do not drive it.
        PoseError: the drawing does not close on the side that it is drawn on, or lies on a fold.
    """
    try:
        tree = Tree(cut(plain))
    except CutError as error:
        raise HardpointsError(error.name, error.problem, error.allowed) from error
    try:
        home = closed(tree, float(np.linalg.norm(tree.noise)))
    except Blocked as end:
        there = tree.cut.told(end.here)
        raise PoseError(end.problem, None, there, there, end.condition, end.links) from end
    return Model(tree, home, knuckles(plain), wheel_angles(plain))
