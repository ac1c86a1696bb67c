"""The relative-coordinate model of a mechanism: built from its flat description, then solved at instants.

    model = build(plain)
    poses = model.poses(inputs, times, tolerance=1e-9)
    rates = model.rates(poses, inputs)
    numbers = model.positions(poses)

Lengths go in and come out in mm; inside, the car has a size between one and two, as its joints' angles have.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validate.reference.effects.registry import ANGLES
from validate.relative.errors import HardpointsError, InputError, PoseError
from validate.relative.follow import Blocked, Poses, at_places, closed, follow
from validate.relative.rates import Rates, rates_of
from validate.relative.tree import Places, Tree, U
from validate.spanning_tree.cut import CutError, Place, cut
from validate.spanning_tree.wheels import OF_CAR, Wheels, knuckles

Array = NDArray[np.float64]
Arrays = dict[str, Array]
Inputs = Mapping[str, ArrayLike]
# What an input may be: an angle is told by its cosine, and rods of no length have no direction.
BETWEEN = {
    "angle": (0.0, np.pi, "an angle from 0 to pi"),
    "distance": (np.nextafter(0.0, 1.0), np.inf, "a distance above 0"),
}


# Sizes of the car. What follows from other rows is missed by rounding, raised by the condition number.
HELD = 1e-11
# A place at the end of a chain of joints is rounded some four times; lengths of the car are up to two inside.
ROUNDING = 4.0 * U


@dataclass(frozen=True)
class Line:
    """A line through two points, of which numbers of the wheel are made.

    Attributes:
        places: start and end, or, where one body carries both, their difference as drawn: a direction, which
            is exact where they lie near to each other.
    """

    places: Places

    @classmethod
    def of(cls, tree: Tree, start: Place, end: Place) -> Line:
        """From one point to another."""
        if start.body == end.body:
            return cls(tree.together([Place(end.body, end.at - start.at)], np.zeros(1)))
        return cls(tree.together([start, end]))

    def now(self, matrices: Array) -> Array:
        """From start to end, (..., 3)."""
        at = self.places.now(matrices)
        return np.asarray(at[..., 0, :] if at.shape[-2] == 1 else at[..., 1, :] - at[..., 0, :])


@dataclass(frozen=True)
class Model:
    """A mechanism whose drawing is closed.

    Attributes:
        tree: Pinocchio's model and the rows; its workspace serves one thread at a time.
        home: the closed drawing.
        bodies: those that are reported, by the name that they are reported by.
        wheels: what numbers of the wheels are made of.
    """

    tree: Tree
    home: Poses
    bodies: Mapping[str, str]
    wheels: Wheels

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
        """Lines of the wheels, by their points."""
        return {pair: Line.of(self.tree, *self.tree.cut.line(*pair)) for pair in self.wheels.ends}

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

    def rates(self, poses: Poses, inputs: Inputs) -> Rates:
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
        try:
            return rates_of(self.tree, poses, series)
        except np.linalg.LinAlgError as error:
            raise self._singular(poses, series) from error

    def accuracy(self, poses: Poses) -> Array:
        """How exactly points are placed, mm, (N,): what is left of all rows, and what rounds lengths."""
        left = np.concatenate([poses.residual, self._left_out(poses)], axis=1)
        return np.asarray((np.abs(left).max(axis=1) + ROUNDING) * self.unit)

    def _left_out(self, poses: Poses) -> Array:
        rows = self.tree.left_out
        return rows.values(poses.matrices, poses.q, rows.target)

    def require_left_out(self, poses: Poses, inputs: Inputs) -> None:
        """Hold poses to the rows that depend on others in the drawing.

        Raises:
            PoseError: one of them does not hold at a pose; `partial` has those before.
        """
        broken = ~(np.abs(self._left_out(poses)) <= HELD)
        if broken.any():
            k, row = (int(i) for i in np.argwhere(broken)[0])
            name = self.tree.left_out.rows[row].name
            words = f"does not hold {name}, which follows from the other rows only as drawn"
            raise self._at_fold(words, poses, self._values(inputs, len(poses.q)), k)

    def positions(self, poses: Poses) -> Arrays:
        """Every point, (N, 3), mm."""
        return self._by_point(at_places(poses, self._places) * self.unit + self.tree.cut.origin)

    def velocities(self, rates: Rates) -> Arrays:
        """Every point's, (N, 3), mm/s."""
        return self._by_point(self._places.now(rates.matrices[1]) * self.unit)

    def accelerations(self, rates: Rates) -> Arrays:
        """Every point's, (N, 3), mm/s^2."""
        return self._by_point(self._places.now(rates.matrices[2]) * self.unit)

    def angular_velocities(self, rates: Rates) -> Arrays:
        """Of the bodies that are reported, (N, 3), rad/s."""
        return {name: rates.twists[:, self.tree.number[body], 3:] for name, body in self.bodies.items()}

    def angular_accelerations(self, rates: Rates) -> Arrays:
        """Of the bodies that are reported, (N, 3), rad/s^2."""
        second = rates.accelerations
        return {name: second[:, self.tree.number[body], 3:] for name, body in self.bodies.items()}

    def numbers(
        self,
        poses: Poses,
        rates: Rates | None = None,
        inputs: Mapping[str, Array] | None = None,
        effects: Iterable[str] = ANGLES,
    ) -> dict[str, Arrays]:
        """By quantity and name: all, or what positions tell where no rates are given.

        Args:
            inputs: as for `rates`; of those that turn the chassis, which only the numbers of the wheels are
                given with.
            effects: names of the numbers of the wheels that are wanted, see `spanning_tree.wheels`.
        """
        along = {ends: line.now(poses.matrices) for ends, line in self._lines.items()}
        places = self._by_point(at_places(poses, self._places))
        found = {
            "position": self.positions(poses),
            OF_CAR: self.wheels.numbers(places, inputs or {}, effects, along),
        }
        if rates is None:
            return found
        return found | {
            "velocity": self.velocities(rates),
            "acceleration": self.accelerations(rates),
            "angular_velocity": self.angular_velocities(rates),
            "angular_acceleration": self.angular_accelerations(rates),
        }

    def _by_point(self, array: Array) -> Arrays:
        """Of all points, (N, P, 3), by name."""
        return {name: array[:, k] for k, name in enumerate(self.tree.cut.points)}

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
        for k in range(len(poses.q) - 1):
            try:
                rates_of(self.tree, poses.first(k + 1), series[: k + 1])
            except np.linalg.LinAlgError:
                return self._at_fold("is singular", poses, series[..., 0], k)
        return self._at_fold("is singular", poses, series[..., 0], len(poses.q) - 1)

    def _at_fold(self, words: str, poses: Poses, values: Array, k: int) -> PoseError:
        there = self.tree.cut.told(values[k])
        jacobian = poses.jacobian[k]
        condition = float(np.linalg.cond(jacobian))
        error = PoseError(words, k, there, there, condition, self.tree.holding(jacobian))
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
    return Model(tree, home, knuckles(plain), Wheels.of(plain, tree.cut))
