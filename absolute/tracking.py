"""Through the instants of a motion, close to every pose: by runs of predicted instants, or one step each.

What is found lies a small correction from the exact pose and on its branch; `refine` takes all
instants to rounding together. A run is as many instants as the expansion of the pose at its start
(see `expansion`) holds for: the pose at its last instant is corrected and expanded as well, and those
between are predicted by both. Where runs would be short, the careful continuation leads to each instant.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.continuation import LARGEST_CORRECTION, LONGEST_STEP
from absolute.continue_to import continue_to
from absolute.expansion import Expansion, between, expand, line_between, products
from absolute.mechanism import Mechanism
from absolute.newton import Pose, correct
from absolute.solution import Array, Counts

# A run that ends nearer to a fold than this is left to the careful continuation: branches are at least
# about this far apart elsewhere.
SAFE_RCOND = 1e-4

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
# The end of a run costs as much as a single step.
SHORTEST_RUN = 2
# Instants that are looked at for a run: at first, and at most.
FIRST_WINDOW = 8
LARGEST_WINDOW = 256


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

    def __init__(self, mechanism: Mechanism, drawn: Pose, spent: int) -> None:
        self.mechanism = mechanism
        self._drawn, self._spent = drawn, spent
        self._window = FIRST_WINDOW
        # Instants to step through before the next run may begin, after one that was too short, or wrong.
        self._steps, self._pause, self._caution = 1, 1, SHORTEST_RUN
        self.found = self._room(0)
        self.back_to(0)
        self._started = self._here, self._values

    def back_to(self, instant: int) -> None:
        """Go on with this instant, by the careful way from the assembled drawing."""
        self._arrive(self._drawn, self.mechanism.drawn_inputs.tolist())
        self._instant, self._steps = instant, 1

    def step_to(self, instant: int, q: Array | None, values: list[float], target: Array) -> None:
        """Go on with this instant, step by step, from the one before: its configuration, inputs and target.

        Args:
            q: None if that is where the last `advance` began.
        """
        there = None if q is None else correct(self.mechanism, q, target, SAFE_RCOND).pose
        self._arrive(*(self._started if there is None else (there, values)))
        # All beyond is found again, so after each wrong prediction the next one comes twice as late.
        self._instant, self._steps = instant, self._caution
        self._window, self._caution = FIRST_WINDOW, min(2 * self._caution, LARGEST_WINDOW)

    def advance(self, values: list[list[float]], targets: Array) -> Found:
        """Configurations for further instants: inputs (N, inputs) and targets (N, rows).

        Raises:
            UnreachableError, SingularError: at the first instant without a pose; `found` holds the
                configurations before it.
        """
        self._started = self._here, self._values
        every = self._room(len(values))
        self.found = every.part(slice(0))
        done = 0
        while done < len(values):
            run = 0
            if self._steps <= 0 and len(values) - done >= SHORTEST_RUN:
                run = self._run(values, targets, every, done)
            if not run:
                self._step(values[done], every, done)
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

    def _arrive(self, there: Pose, values: list[float]) -> None:
        self._here, self._values = there, values
        self._expansion: Expansion | None = None
        self._before: Expansion | None = None

    def _step(self, value: list[float], every: Found, place: int) -> None:
        """One instant, with care."""
        there, spent = continue_to(self.mechanism, self._here, self._values, value, self._instant)
        every.q[place], every.corrections[place] = there.q, spent + self._spent
        self._arrive(there, value)
        self._spent = 0
        self._steps -= 1

    def _run(self, values: list[list[float]], targets: Array, every: Found, done: int) -> int:
        """As many instants as can be predicted, from place `done` on; 0 where it would be too few."""
        mechanism = self.mechanism
        driven = slice(mechanism.joint_rows, None)
        places = targets[done : done + self._window, driven]
        if self._expansion is None:
            self._expansion = expanded(mechanism, self._here, mechanism.targets(self._values)[0, driven])
        here = self._expansion
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
        if self._before is not None:
            # The way behind tells more of the way ahead than this place alone, if it leads on or back.
            onward = line_between(self._before.place, here.place, places[last:count])
            if 0.0 < onward.share[0, 0] < FURTHEST:
                start = between(self._before, here, onward)[0]
        outcome = correct(mechanism, mechanism.normalized(start), target, self._here.rcond)
        there = outcome.pose
        if (
            there is None
            or not outcome.first <= LARGEST_CORRECTION * float(ahead.size[last]) + there.floor
            or not there.rcond >= SAFE_RCOND
            or (there.signs != self._here.signs).any()
        ):
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
        every.corrections[done + last] += outcome.corrections
        self._spent = 0
        self._arrive(there, values[done + last])
        self._before, self._expansion = here, end
        self._window = min(LARGEST_WINDOW, 2 * count)
        self._pause = 1
        return count

    def _too_short(self) -> int:
        """Nothing of a run; the next one is looked for twice as late as after the last such."""
        self._steps, self._window = self._pause, FIRST_WINDOW
        self._pause = min(2 * self._pause, LARGEST_WINDOW)
        return 0


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


def expanded(mechanism: Mechanism, here: Pose, place: Array) -> Expansion:
    """The expansion at a pose, for targets of the inputs' rows (inputs,)."""
    return expand(mechanism, here.q, here.placed, here.factors, place)
