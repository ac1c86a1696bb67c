r"""A linkage in somebody's program: the program says what its loops miss, Newton's method closes them.

A program places its bodies from its joints' coordinates q, and says how far the two sides of each loop are
apart, r, and the Jacobian J of that by the joints' rates. With u the unknown and d the driven joints,

    J_u dq = -r,    J_u v_u = -J_d v_d,    J_u a_u = -J_d a_d - (dJ/dt) v.

The last two terms are how the sides of the loops accelerate apart while the unknown joints do not, which
programs tell of any point.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from validate.peers.linkage import Linkage, PeerError
from validate.peers.motion import Poses, Rates

Array = NDArray[np.float64]

# Newton's method doubles its digits: six steps lead from half a digit to all, and twice that leaves room.
LIMIT = 12
# rad and car sizes: a step that is longer may lead to another assembly, and the way is halved.
LONGEST_STEP = 0.25
HALVINGS = 12
# Where that did lead to another assembly, or nowhere, it is tried with steps that are so much shorter.
SHORTER = 0.125
SHORTEST_STEP = 1e-3
# Poses whose sides are checked at once.
TOGETHER = 32
# Below the root of the rounding unit a step that does not halve is rounding.
ROUNDING_STEP = 1e-8


class Program(ABC):
    """A linkage in a program, which keeps the pose that was computed last; not for two threads.

    Attributes:
        driven, unknown: places among the joints' rates, of the arm and the rack, and of all that are free.
    """

    linkage: Linkage
    driven: NDArray[np.intp]
    unknown: NDArray[np.intp]

    @property
    @abstractmethod
    def coordinates(self) -> Array:
        """Of the joints, a copy."""

    @abstractmethod
    def put(self, coordinates: Array) -> None:
        """Set all joints."""

    @abstractmethod
    def drive(self, driven: Array) -> None:
        """Set the driven joints, (2,)."""

    @abstractmethod
    def put_as_drawn(self) -> None:
        """Set all joints as the car is drawn."""

    @abstractmethod
    def move(self, step: Array) -> None:
        """Move all joints by a small step, as their rates would in a unit of time."""

    @abstractmethod
    def misses(self) -> tuple[Array, Array]:
        """Place all bodies; what the loops miss, (rows,), and its Jacobian by the joints' rates."""

    @abstractmethod
    def places(self) -> Array:
        """Place all bodies; where the linkage's points are, (points, 3)."""

    @abstractmethod
    def set_rates(self, rates: Array) -> None:
        """Set the joints' rates, at the pose that `misses` was asked of."""

    @abstractmethod
    def apart(self, accelerations: Array) -> Array:
        """How the sides of the loops accelerate apart with these accelerations of the joints, (rows,)."""

    @abstractmethod
    def moving(self, accelerations: Array) -> tuple[Array, Array]:
        """Rates and accelerations with these of the joints: of all points and at last of the knuckle's turn,
        (points + 1, 3) each.
        """

    def closed(self, tolerance: float) -> Poses:
        """The drawing, closed at its own inputs: one pose.

        Args:
            tolerance: Newton's method ends with a correction of all joints below it, rad and car sizes.
        Raises:
            PeerError: it cannot be closed, or only as another assembly.
        """
        counted = _Count()
        self.put_as_drawn()
        driven = self.linkage.drawn_inputs
        step = self._newton(driven, tolerance, LONGEST_STEP, counted, shorten=True)
        if step is None:
            raise PeerError("the drawing cannot be closed")
        here, places = self.coordinates[None], self.places()[None]
        poses = self._named(driven[None], here, places, np.array([step]), counted)
        if self._on_other_side(places).any():
            raise PeerError("closing the drawing leads to another assembly than is drawn")
        return poses

    def poses(self, driven: Array, tolerance: float, start: Poses) -> Poses:
        """Solve at driven inputs, each pose from the one before.

        Args:
            driven: turn of the arm and travel of the rack, (N, 2).
            tolerance: see `closed`.
            start: whose last pose the first one is solved from.
        Raises:
            PeerError: a pose is not reached, or is one of another assembly.
        """
        counted, count = _Count(), len(driven)
        coordinates = np.empty((count, start.coordinates.shape[1]))
        places = np.empty((count, len(self.linkage.points), 3))
        steps = np.empty(count)

        def before(i: int) -> tuple[Array, Array]:
            """Inputs and coordinates of the pose before another one."""
            return (driven[i - 1], coordinates[i - 1]) if i else (start.driven[-1], start.coordinates[-1])

        done = 0
        while done < count:
            here, pose = before(done)
            self.put(pose)
            stop = reached = min(done + TOGETHER, count)
            for i in range(done, stop):
                step = self._go(here, driven[i], tolerance, LONGEST_STEP, counted)
                if step is None:
                    reached = i
                    break
                here, steps[i], places[i], coordinates[i] = driven[i], step, self.places(), self.coordinates
            other = self._on_other_side(places[done:reached])
            done = done + int(np.argmax(other)) if other.any() else reached
            if done < stop:
                steps[done] = self._go_by_sides(*before(done), driven[done], tolerance, counted, done)
                places[done], coordinates[done] = self.places(), self.coordinates
                done += 1
        return self._named(driven, coordinates, places, steps, counted)

    def _go_by_sides(
        self, start: Array, pose: Array, goal: Array, tolerance: float, counted: _Count, i: int
    ) -> float:
        """Go from a pose to a goal by ever shorter steps until it is on the drawing's side; the last step."""
        longest, elsewhere = LONGEST_STEP, False
        while longest > SHORTEST_STEP:
            self.put(pose)
            step = self._go(start, goal, tolerance, longest, counted)
            if step is not None:
                if not self._on_other_side(self.places()[None]).any():
                    return step
                elsewhere = True
            longest *= SHORTER
        if elsewhere:
            raise PeerError("Newton's method came to another assembly than is drawn", i)
        raise PeerError("no pose is reached from the one before", i)

    def _on_other_side(self, places: Array) -> NDArray[np.bool_]:
        """Which poses, by the places of their points, (N, points, 3), are not of the drawing's assembly."""
        named = {name: places[:, k] for k, name in enumerate(self.linkage.points)}
        return self.linkage.on_other_side(self.linkage.with_chassis(named))

    def rates(self, poses: Poses, rate: Array, bend: Array) -> Rates:
        """Velocities and accelerations of poses.

        Args:
            rate, bend: first and second time derivative of what is driven, (N, 2), per s and s^2.
        Raises:
            PeerError: the rates are not determined at a pose.
        """
        count, names = len(rate), list(self.linkage.points)
        first, second = (np.empty((count, len(names) + 1, 3)) for _ in range(2))
        for i in range(count):
            self.put(poses.coordinates[i])
            _, jacobian = self.misses()
            velocity, acceleration = (np.zeros(jacobian.shape[1]) for _ in range(2))
            velocity[self.driven], acceleration[self.driven] = rate[i], bend[i]
            try:
                inverse = np.linalg.inv(jacobian[:, self.unknown])
            except np.linalg.LinAlgError:
                raise PeerError("the pose is where two assemblies meet", i) from None
            velocity[self.unknown] = -inverse @ (jacobian[:, self.driven] @ rate[i])
            self.set_rates(velocity)
            acceleration[self.unknown] = -inverse @ self.apart(acceleration)
            first[i], second[i] = self.moving(acceleration)
        velocities, accelerations = (
            {name: array[:, k] for k, name in enumerate(names)} for array in (first, second)
        )
        return Rates(velocities, accelerations, first[:, -1], second[:, -1])

    def _go(
        self, start: Array, goal: Array, tolerance: float, longest: float, counted: _Count
    ) -> float | None:
        """Follow the inputs to a goal, by halves where Newton's method would step too far; its last step."""
        done, share, step = 0.0, 1.0, None
        while done < 1.0:
            kept, share = self.coordinates, min(share, 1.0 - done)
            there = start + (done + share) * (goal - start) if done + share < 1.0 else goal
            step = self._newton(there, tolerance, longest, counted)
            if step is None:
                self.put(kept)
                share *= 0.5
                if share < 0.5**HALVINGS:
                    return None
            else:
                done += share
        return step

    def _newton(
        self, driven: Array, tolerance: float, longest: float, counted: _Count, shorten: bool = False
    ) -> float | None:
        """Close the loops at driven inputs; the last step, None if it fails.

        Args:
            longest: step that is taken.
            shorten: whether a longer one is shortened, or fails.
        """
        self.drive(driven)
        unknown, previous = self.unknown, np.inf
        step: Array | None = None
        for _ in range(LIMIT):
            missed, jacobian = self.misses()
            if step is None:
                step = np.zeros(jacobian.shape[1])
            counted.jacobians += 1
            try:
                step[unknown] = np.linalg.solve(jacobian[:, unknown], -missed)
            except np.linalg.LinAlgError:
                return None
            size = float(np.abs(step).max())
            if not size <= longest:
                if not (shorten and np.isfinite(size)):
                    return None
                step *= longest / size
            self.move(step)
            counted.steps += 1
            if size <= tolerance or (size < ROUNDING_STEP and size >= 0.5 * previous):
                return size
            previous = size
        return None

    def _named(
        self, driven: Array, coordinates: Array, places: Array, steps: Array, counted: _Count
    ) -> Poses:
        counts = {
            "newton_steps": counted.steps,
            "factorisations": counted.jacobians,
            "jacobians": counted.jacobians,
            "residuals": counted.jacobians,
        }
        named = {name: places[:, k] for k, name in enumerate(self.linkage.points)}
        return Poses(driven, coordinates, named, steps, counts)


class _Count:
    """What Newton's method did."""

    def __init__(self) -> None:
        self.steps = 0
        self.jacobians = 0
