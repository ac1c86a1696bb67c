r"""A linkage in somebody's program: the program says what its loops miss, Newton's method closes them.

A program places its bodies from its joints' coordinates q, and says how far the two sides of each loop are
apart, r, and the Jacobian J of that by the joints' rates. With u the unknown and d the driven joints,

    J_u dq = -r,    J_u v_u = -J_d v_d,    J_u a_u = -J_d a_d - (dJ/dt) v.

The last two terms are how the sides of the loops accelerate apart while the unknown joints do not, which
programs tell of any point. Rows of J_u that depend on others in the drawing are left out, and what they miss
is looked at in every pose. Two assemblies meet where det J_u is zero, so its sign stays that of the drawing.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from validate.peers.errors import PeerError
from validate.peers.linkage import Linkage
from validate.peers.motion import Poses, Rates
from validate.spanning_tree.determined import independent_rows

Array = NDArray[np.float64]

# Newton's method doubles its digits: six steps lead from half a digit to all, and twice that leaves room.
LIMIT = 12
# rad and car sizes: a step that is longer may lead to another assembly, and the way is halved.
LONGEST_STEP = 0.25
# The same where the second step is more than this part of the first: then a pose nearby is not sure.
CONTRACTED = 0.25
HALVINGS = 40
# Car sizes. What depends on other rows is missed by the square of the last step, and by rounding raised by
# the condition number, some 1e-13 of the car.
HELD = 1e-11
# Below the root of the rounding unit a step that does not halve is rounding.
ROUNDING_STEP = 1e-8


class Program(ABC):
    """A linkage in a program, which keeps the pose that was computed last; not for two threads.

    Attributes:
        driven, unknown: places among the joints' rates, of those that are driven, and of all that are free.
        rows: that are solved. sign: of det J_u in the drawing.
    """

    linkage: Linkage
    driven: NDArray[np.intp]
    unknown: NDArray[np.intp]
    rows: slice | NDArray[np.int64] = slice(None)
    sign: float = 0.0

    @property
    @abstractmethod
    def coordinates(self) -> Array:
        """Of the joints, a copy."""

    @abstractmethod
    def put(self, coordinates: Array) -> None:
        """Set all joints."""

    @abstractmethod
    def drive(self, driven: Array) -> None:
        """Set the driven joints, (drives,)."""

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
        """Rates and accelerations with these of the joints: of all points, and then of the reported bodies'
        turns, (points + bodies, 3) each.
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
        self.drive(driven)
        jacobian = self.misses()[1][:, self.unknown]
        count = jacobian.shape[1]
        rows = independent_rows(jacobian, 0)
        if len(rows) < count:
            raise PeerError(f"the drawing is free to move: {len(rows)} independent rows for {count} unknowns")
        self.rows = slice(None) if len(rows) == len(jacobian) else rows
        self.sign = float(np.linalg.slogdet(jacobian[self.rows])[0])
        step = self._newton(driven, tolerance, LONGEST_STEP, counted, shorten=True)
        if step is None:
            raise PeerError("the drawing cannot be closed as the assembly that is drawn")
        here, places = self.coordinates[None], self.places()[None]
        return self._named(driven[None], here, places, np.array([step]), counted)

    def poses(self, driven: Array, tolerance: float, start: Poses) -> Poses:
        """Solve at driven inputs, each pose from the one before.

        Args:
            driven: driven coordinates, (N, drives).
            tolerance: see `closed`.
            start: whose last pose the first one is solved from.
        Raises:
            PeerError: a pose is not reached without meeting another assembly.
        """
        counted, count = _Count(), len(driven)
        coordinates = np.empty((count, start.coordinates.shape[1]))
        places = np.empty((count, len(self.linkage.points), 3))
        steps = np.empty(count)
        here = start.driven[-1]
        self.put(start.coordinates[-1])
        for i in range(count):
            step = self._go(here, driven[i], tolerance, counted)
            if step is None:
                raise PeerError("no pose is reached from the one before", i)
            here, steps[i], places[i], coordinates[i] = driven[i], step, self.places(), self.coordinates
            if not isinstance(self.rows, slice):
                missed = float(np.abs(self.misses()[0]).max())
                if not missed <= HELD + step**2:
                    raise PeerError(
                        f"closures that depend on others in the drawing miss by {missed:.3g} here", i
                    )
        return self._named(driven, coordinates, places, steps, counted)

    def rates(self, poses: Poses, rate: Array, bend: Array) -> Rates:
        """Velocities and accelerations of poses.

        Args:
            rate, bend: first and second time derivative of what is driven, (N, drives), per s and s^2.
        Raises:
            PeerError: the rates are not determined at a pose.
        """
        count, names = len(rate), list(self.linkage.points)
        bodies = list(self.linkage.bodies)
        first, second = (np.empty((count, len(names) + len(bodies), 3)) for _ in range(2))
        for i in range(count):
            self.put(poses.coordinates[i])
            jacobian = self.misses()[1][self.rows]
            velocity, acceleration = (np.zeros(jacobian.shape[1]) for _ in range(2))
            velocity[self.driven], acceleration[self.driven] = rate[i], bend[i]
            try:
                inverse = np.linalg.inv(jacobian[:, self.unknown])
            except np.linalg.LinAlgError:
                raise PeerError("the pose is where two assemblies meet", i) from None
            velocity[self.unknown] = -inverse @ (jacobian[:, self.driven] @ rate[i])
            self.set_rates(velocity)
            acceleration[self.unknown] = -inverse @ self.apart(acceleration)[self.rows]
            first[i], second[i] = self.moving(acceleration)
        velocities, accelerations = (
            {name: array[:, k] for k, name in enumerate(names)} for array in (first, second)
        )
        spins, rates = (
            {name: array[:, k] for k, name in enumerate(bodies, len(names))} for array in (first, second)
        )
        return Rates(velocities, accelerations, spins, rates)

    def _go(self, start: Array, goal: Array, tolerance: float, counted: _Count) -> float | None:
        """Follow the inputs to a goal, by halves where Newton's method would step too far; its last step."""
        done, share, step = 0.0, 1.0, None
        while done < 1.0:
            kept, share = self.coordinates, min(share, 1.0 - done)
            there = start + (done + share) * (goal - start) if done + share < 1.0 else goal
            step = self._newton(there, tolerance, LONGEST_STEP, counted)
            if step is None:
                self.put(kept)
                share *= 0.5
                if share < 0.5**HALVINGS:
                    return None
            else:
                done += share
                share *= 2.0
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
        if not len(unknown):
            return 0.0  # as of an arm on one hinge, which is driven
        step: Array | None = None
        for number in range(LIMIT):
            missed, jacobian = self.misses()
            if step is None:
                step = np.zeros(jacobian.shape[1])
            counted.jacobians += 1
            factors, swaps, solved, info = dgesv(jacobian[self.rows][:, unknown], -missed[self.rows])
            if info:
                return None
            step[unknown] = solved
            size = float(np.abs(solved).max())
            if not size <= longest:
                if not (shorten and np.isfinite(size)):
                    return None
                step *= longest / size
            elif number == 1 and size > CONTRACTED * previous and size > ROUNDING_STEP and not shorten:
                return None
            self.move(step)
            counted.steps += 1
            if size <= tolerance or (size < ROUNDING_STEP and size >= 0.5 * previous):
                return size if _sign(factors, swaps) == self.sign else None
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


def _sign(factors: Array, swaps: NDArray[np.intp]) -> float:
    """Sign of a determinant, from its factors and their swaps of rows."""
    turned = np.count_nonzero(swaps != np.arange(len(swaps))) + np.count_nonzero(np.diag(factors) < 0.0)
    return -1.0 if turned % 2 else 1.0


class _Count:
    """What Newton's method did."""

    def __init__(self) -> None:
        self.steps = 0
        self.jacobians = 0
