"""Through the instants of a motion, close to every pose: by runs of predicted instants, or one step each.

What is found lies a small correction from the exact pose and on its branch; `refine` takes all
instants to rounding together. A run is as many instants as the expansion of the pose at its start
(see `expansion`) holds for: the pose at its last instant is corrected and expanded as well, and those
between are predicted by both. Where runs would be short, each instant takes one tangent step and one
correction; where that does not do, the careful continuation goes on.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.backend import eigenpy
from absolute.continuation import LARGEST_CORRECTION, LONGEST_STEP
from absolute.continue_to import continue_to
from absolute.expansion import Expansion, between, expand, line_between, products
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.newton import Pose, correct
from absolute.solution import Array, Counts
from absolute.stack import Placed

# Poses nearer to a fold than this are left to the careful continuation: branches are at least
# about this far apart elsewhere.
SAFE_RCOND = 1e-4
# Corrections below this are always fine: held inputs step by nothing, but the pose before was
# left rough. A hundredth of the distance of branches.
SMALL = 1e-6

# A run ends where the second order of its expansion is this share of the first, so that with orders that
# fall like a geometric series the sixth, of 64 of which Hermite's interpolation is off by one, is some
# 1e-7 of the first: then one correction is enough.
LARGEST_BEND = 0.1
# Nor may it be longer than this, in units of size and quaternions, which turn by half of an angle.
LONGEST_RUN = 0.5 * LONGEST_STEP
# A third order below this needs no second expansion: one correction is enough then.
FLAT = 1e-9
# Beside the line between both ends of a run third orders count, but not below this.
BESIDE = 1e-7
# Inputs that have come back by this share of the way have turned: the end of the run is where they did.
TURNED = 0.2
# A prediction by the way behind is better than by one place as far ahead as this, where 1 is that place.
FURTHEST = 3.0
# The end of a run is corrected once more from here on: its expansion would be off by as much.
CLOSE = 1e-5
# Both ends of a run cost as much as so many single steps.
SHORTEST_RUN = 4
# Instants that are looked at for a run: at first, and at most.
FIRST_WINDOW = 32
LARGEST_WINDOW = 256


class Rough(NamedTuple):
    """A configuration close to a pose, and the factors of a Jacobian near it.

    Attributes:
        q: the configuration, the last correction made.
        rotation, placed, factors, sign: of the bodies, rows, Jacobian and its whole determinant before that.
        correction: size of that correction.
    """

    q: Array
    rotation: Array
    placed: Placed
    factors: eigenpy.PartialPivLU
    sign: float
    correction: float


class Found(NamedTuple):
    """Configurations close to the poses of N instants.

    Attributes:
        q: (N, configuration).
        corrections: (N,) spent on the way to each.
        predicted: (N,) whether nothing was evaluated there yet, so that `refine` must tell if it is right.
        signs: of the determinants on this branch, (groups,).
    """

    q: Array
    corrections: Counts
    predicted: NDArray[np.bool_]
    signs: Array

    def part(self, of: slice) -> "Found":
        """Some of the instants."""
        return Found(self.q[of], self.corrections[of], self.predicted[of], self.signs)


class Tracking:
    """The way through all instants of a motion; begins with the assembled drawing."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        pose, self._spent = assemble(mechanism)
        self._drawn = pose
        self._instant = 0
        self._careful = False
        # Instants to step through before the next run may begin, and after one that was too short.
        self._steps, self._pause = 0, SHORTEST_RUN
        self._window = FIRST_WINDOW
        self.found = self._room(0)
        self._begin()
        self._started = self._here, self._values, self._target

    def _begin(self) -> None:
        self._values: list[float] = self.mechanism.drawn_inputs.tolist()
        self._target = self.mechanism.targets(self._values)[0]
        self._here = rough_of(self._drawn)
        self._expansion: Expansion | None = None
        self._before: Expansion | None = None
        # The last exact pose, and its inputs.
        self._exact, self._exact_values = self._drawn, self._values

    def back_to(self, instant: int) -> None:
        """Go on with this instant, by the careful way from the assembled drawing."""
        self._begin()
        self._instant = instant
        self._careful = True

    def step_to(self, instant: int, q: Array | None, values: list[float], target: Array) -> None:
        """Go on with this instant, step by step, from the one before: its configuration, inputs and target.

        Args:
            q: None if that is where the last `advance` began.
        """
        self._instant = instant
        if q is None:
            self._arrive(*self._started)
        else:
            self._arrive(corrected(self.mechanism, q, target), values, target)
        self._steps = LARGEST_WINDOW

    def advance(self, values: list[list[float]], targets: Array) -> Found:
        """Configurations for further instants: inputs (N, inputs) and targets (N, rows).

        Raises:
            UnreachableError, SingularError: at the first instant without a pose; `found` holds the
                configurations before it.
        """
        self._started = self._here, self._values, self._target
        every = self._room(len(values))
        self.found = every.part(slice(0))
        done = 0
        while done < len(values):
            run = 0
            if not self._careful and self._steps <= 0 and len(values) - done >= SHORTEST_RUN:
                run = self._run(values, targets, every, done)
            if not run:
                self._step(values[done], targets[done], every, done)
                run = 1
            done += run
            self._instant += run
            self.found = every.part(slice(done))
        return self.found

    def _room(self, count: int) -> Found:
        return Found(
            np.empty((count, self.mechanism.pin_model.nq)),
            np.zeros(count, dtype=np.int64),
            np.zeros(count, dtype=np.bool_),
            self._drawn.signs,
        )

    def _arrive(self, there: Rough, values: list[float], target: Array) -> None:
        self._here, self._values, self._target = there, values, target
        self._expansion = self._before = None

    def _step(self, value: list[float], target: Array, every: Found, place: int) -> None:
        """One instant, by one step or with care."""
        there, spent = None, 1
        if not self._careful:
            there = glide(self.mechanism, self._here, target - self._target, target)
        if there is None:
            there, spent = self._careful_way(value)
        every.q[place], every.corrections[place] = there.q, spent + self._spent
        self._arrive(there, value, target)
        self._spent = 0
        self._careful = False
        self._steps -= 1

    def _run(self, values: list[list[float]], targets: Array, every: Found, done: int) -> int:
        """As many instants as can be predicted, from place `done` on; 0 where it would be too few."""
        mechanism = self.mechanism
        driven = slice(mechanism.joint_rows, None)
        places = targets[done : done + self._window, driven]
        here = self._expansion
        if here is None:
            if self._here.correction > SMALL:
                self._here = corrected(mechanism, self._here.q, self._target)
            here = self._expansion = expanded(mechanism, self._here, self._target[driven])
        ahead = Ahead.of(here, places - here.place)
        count = ahead.length()
        while count >= SHORTEST_RUN:
            line = line_between(here.place, places[count - 1], places[:count])
            third = float(Ahead.of(here, line.beside).third.max())
            if third <= BESIDE:
                break
            # A smooth way is beside its chord by the square of its length: this falls as the sixth power.
            count = min(count - 1, int(count * (BESIDE / third) ** (1.0 / 6.0)))
        else:
            return self._too_short()
        last, target = count - 1, targets[done + count - 1]
        start = ahead.q[last]
        if self._before is not None and ahead.third[last] > FLAT:
            # The way behind tells more of the way ahead than this place alone, if it leads on or back.
            onward = line_between(self._before.place, here.place, places[last:count])
            if 0.0 < onward.share[0, 0] < FURTHEST:
                start = between(self._before, here, onward)[0]
        there, spent = corrected(mechanism, mechanism.normalized(start), target), 1
        allowed = LARGEST_CORRECTION * float(ahead.size[last]) + SMALL
        if not there.correction <= allowed or not safe(there, self._here.sign):
            return self._too_short()
        if there.correction > CLOSE:
            first, spent = there.correction, 2
            there = corrected(mechanism, there.q, target)
            if not there.correction <= LARGEST_CORRECTION * first or not safe(there, self._here.sign):
                return self._too_short()
        end = expanded(mechanism, there, target[driven])
        bent = np.flatnonzero(ahead.third[:last] > FLAT)
        q = every.q[done : done + last]
        q[:] = ahead.q[:last]
        if bent.size:
            q[bent] = between(here, end, line.part(bent))
        for number in range(last):
            q[number] = mechanism.normalized(q[number])
        every.q[done + last] = there.q
        every.predicted[done : done + last] = True
        every.corrections[done] += self._spent
        every.corrections[done + last] += spent
        self._spent = 0
        self._arrive(there, values[done + last], target)
        self._before, self._expansion = here, end
        self._window = min(LARGEST_WINDOW, max(FIRST_WINDOW, 2 * count))
        self._pause = SHORTEST_RUN
        return count

    def _too_short(self) -> int:
        """Nothing of a run; the next one is looked for twice as late as after the last such."""
        self._steps, self._window = self._pause, FIRST_WINDOW
        self._pause = min(2 * self._pause, LARGEST_WINDOW)
        return 0

    def _careful_way(self, goal: list[float]) -> tuple[Rough, int]:
        """The careful way, from the pose here made exact (or from the last exact one)."""
        settled = correct(self.mechanism, self._here.q, self._target, SAFE_RCOND)
        if settled.pose is not None:
            self._exact, self._exact_values = settled.pose, self._values
        pose, spent = continue_to(self.mechanism, self._exact, self._exact_values, goal, self._instant)
        self._exact, self._exact_values = pose, goal
        return rough_of(pose), spent + settled.corrections


class Ahead(NamedTuple):
    """What an expansion says of N instants ahead.

    Attributes:
        q: (N, configuration) by the expansion alone.
        size, bend: (N,) its first and second order. third: (N,) what the third would be.
    """

    q: Array
    size: Array
    bend: Array
    third: Array

    @classmethod
    def of(cls, here: Expansion, change: Array) -> "Ahead":
        """For changes (N, inputs) of the targets."""
        count = change.shape[1]
        straight = change @ here.terms[1 : 1 + count]
        curve = products(change) @ here.terms[1 + count :]
        size, bend = np.sqrt(np.vecdot(straight, straight)), np.sqrt(np.vecdot(curve, curve))
        third = np.divide(bend * bend, size, out=np.zeros_like(size), where=size > 0.0)
        return cls(here.terms[0] + straight + curve, size, bend, third)

    def length(self) -> int:
        """How many of the instants make a run."""
        good = (self.size <= LONGEST_RUN) & (self.bend <= LARGEST_BEND * self.size)
        # Far from where the run ends, both expansions together would be worse than one.
        back = self.size < (1.0 - TURNED) * np.maximum.accumulate(self.size)
        back &= np.maximum.accumulate(self.third) > FLAT
        count = len(good) if good.all() else int(np.argmin(good))
        turn = int(np.argmax(back[:count])) if back[:count].any() else count
        return count if turn == count else int(np.argmax(self.size[:turn])) + 1


def rough_of(pose: Pose) -> Rough:
    """An exact pose is also a rough one."""
    sign = math.copysign(1.0, pose.factors.determinant())
    return Rough(pose.q, pose.poses.rotation, pose.placed, pose.factors, sign, 0.0)


def corrected(mechanism: Mechanism, q: Array, target: Array) -> Rough:
    """One Newton correction of a configuration."""
    poses = mechanism.poses(q)
    placed = mechanism.stack.place(*poses)
    factors = eigenpy.PartialPivLU(mechanism.stack.jacobian(placed))
    correction = factors.solve(mechanism.stack.gap(placed, target))
    sign = math.copysign(1.0, factors.determinant())
    size = math.sqrt(correction @ correction)
    return Rough(mechanism.moved(q, poses.rotation, correction), poses.rotation, placed, factors, sign, size)


def safe(there: Rough, sign: float) -> bool:
    """Whether a corrected configuration is on the side of the folds that it came from, and far from one."""
    return there.sign == sign and bool(there.factors.rcond() >= SAFE_RCOND)


def expanded(mechanism: Mechanism, here: Rough, place: Array) -> Expansion:
    """The expansion at a configuration, for targets of the inputs' rows (inputs,)."""
    return expand(mechanism, here.q, here.placed, here.factors, place)


def glide(mechanism: Mechanism, here: Rough, change: Array, target: Array) -> Rough | None:
    """One tangent step for a change of the targets, one Newton correction; None if that is not safe.

    Safe is a step that is short, needs a correction that is small against it, keeps the sign of
    the determinant and ends far from a fold.
    """
    step = here.factors.solve(change)
    size = math.sqrt(step @ step)
    if not size <= LONGEST_STEP:
        return None
    # The rotations before its last correction serve this step as they are.
    there = corrected(mechanism, mechanism.moved(here.q, here.rotation, step), target)
    small = there.correction <= LARGEST_CORRECTION * size + SMALL
    return there if small and safe(there, here.sign) else None
