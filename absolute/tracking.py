"""From instant to instant by one tangent step and one correction each, close to every pose.

What is found lies a small correction from the exact pose and on its branch; `refine` takes all
instants to rounding together. Where a single step does not do, the careful continuation goes on.
"""

import math
from typing import NamedTuple

from absolute.backend import eigenpy
from absolute.continuation import LONGEST_STEP
from absolute.continue_to import continue_to
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Pose, correct
from absolute.solution import Array

# Poses nearer to a fold than this are left to the careful continuation: branches are at least
# about this far apart elsewhere.
SAFE_RCOND = 1e-4
# The correction must be small against the step: a larger one means that the step bends much.
LARGEST_CORRECTION = 0.1
# Corrections below this are always fine: held inputs step by nothing, but the pose before was
# left rough. A hundredth of the distance of branches.
SMALL = 1e-6


class Rough(NamedTuple):
    """A configuration close to a pose, and the factors of a Jacobian near it."""

    q: Array
    rotation: Array
    factors: eigenpy.PartialPivLU
    sign: float


class Found(NamedTuple):
    """A configuration close to the pose of an instant, and the corrections spent on it."""

    q: Array
    corrections: int


class Tracking:
    """The way through all instants of a motion; begins with the assembled drawing."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.found: list[Found] = []
        pose, self._spent = assemble(mechanism)
        self._drawn = pose
        self._instant = 0
        self._careful = False
        self._begin()

    def _begin(self) -> None:
        self._values: list[float] = self.mechanism.drawn_inputs.tolist()
        zeros = [0.0] * len(self._values)
        self._target = self.mechanism.targets(self._values, zeros, zeros)[0]
        self._here = rough_of(self._drawn)
        # The last exact pose, and its inputs.
        self._exact, self._exact_values = self._drawn, self._values

    def back_to(self, instant: int) -> None:
        """Go on with this instant, by the careful way from the assembled drawing."""
        self._begin()
        self._instant = instant
        self._careful = True

    def advance(self, values: list[list[float]], targets: Array) -> list[Found]:
        """Configurations for further instants: inputs (N, inputs) and targets (N, rows).

        Raises:
            UnreachableError, SingularError: at the first instant without a pose; `found` holds the
                configurations before it.
        """
        self.found = []
        for value, target in zip(values, targets, strict=True):
            there, spent = None, 1
            if not self._careful:
                there = glide(self.mechanism, self._here, target - self._target, target)
            if there is None:
                there, spent = self._careful_way(value)
            self.found.append(Found(there.q, spent + self._spent))
            self._here, self._values, self._target, self._spent = there, value, target, 0
            self._instant += 1
            self._careful = False
        return self.found

    def _careful_way(self, goal: list[float]) -> tuple[Rough, int]:
        """The careful way, from the pose here made exact (or from the last exact one)."""
        settled = correct(self.mechanism, self._here.q, self._target, SAFE_RCOND)
        if settled.pose is not None:
            self._exact, self._exact_values = settled.pose, self._values
        pose, spent = continue_to(self.mechanism, self._exact, self._exact_values, goal, self._instant)
        self._exact, self._exact_values = pose, goal
        return rough_of(pose), spent + settled.corrections


def rough_of(pose: Pose) -> Rough:
    """An exact pose is also a rough one."""
    return Rough(pose.q, pose.poses.rotation, pose.factors, pose.sign)


def glide(mechanism: Mechanism, here: Rough, change: Array, target: Array) -> Rough | None:
    """One tangent step for a change of the targets, one Newton correction; None if that is not safe.

    Safe is a step that is short, needs a correction that is small against it, keeps the sign of
    the determinant and ends far from a fold.
    """
    step = here.factors.solve(change)
    size = math.sqrt(step @ step)
    if not size <= LONGEST_STEP:
        return None
    q = mechanism.moved(here.q, here.rotation, step)
    poses = mechanism.poses(q)
    placed = mechanism.stack.place(*poses)
    factors = eigenpy.PartialPivLU(mechanism.stack.jacobian(placed))
    correction = factors.solve(target - placed.values)
    added = math.sqrt(correction @ correction)
    sign = math.copysign(1.0, factors.determinant())
    small = added <= LARGEST_CORRECTION * size + SMALL
    if not small or sign != here.sign or not factors.rcond() >= SAFE_RCOND:
        return None
    # The rotations before the correction serve the next tangent step as they are.
    return Rough(mechanism.moved(q, poses.rotation, correction), poses.rotation, factors, sign)
