"""Many designs of one suspension solved together: those that can be, and why the others cannot.

A batch of cars shares the segments of one chain of series. A design that cannot be closed, assembled or moved
drops out with its status, and the others go on as if it had not been there.

Many designs are solved as columns (see `paths_together` and `chains_together`), with one operation for all of
them. What does not go well there is solved again by itself in the plain form, which decides, and words the
reason. Few designs, and whatever the columns cannot do at all, are solved in the plain form from the start.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.errors import AssemblyError
from pointcoord.linkage.drawing_orientation import turned_over
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve.assembly import Path, Pose, assemble, close_drawing
from pointcoord.solve.chains_together import Course, NotTogether
from pointcoord.solve.paths_together import Columns, columns_of, follow_together
from pointcoord.solve.status import COMPLETE, Status, TooLong, blocked_by
from pointcoord.solve.taylor import Chain, Settings, build_chain
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Fewer designs are solved in the plain form: the operations on columns cost as much for one as for some
# dozens.
FEW = 8


@dataclass(frozen=True)
class SolvedDesigns:
    """What became of a batch of designs.

    Attributes:
        alive: numbers of the designs that were solved to the end, in increasing order, (A,).
        chain: of those, its coefficients of shape (A, order + 1, size); without segments if there are none.
        start: coordinates of those at the first instant, (A, size); None if there are none.
        closed: coordinates of the closed drawings, (D, size); NaN where there is none.
        failures: by number, what stopped each of the others.
    """

    alive: Numbers
    chain: Chain | None
    start: Array | None
    closed: Array
    failures: Mapping[int, Status]


def solve_designs(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    start: float,
    stop: float,
    settings: Settings,
    tolerance: float,
) -> SolvedDesigns:
    """Close, assemble and move a batch of designs.

    Args:
        mechanism: of all designs, with one batch dimension, (D,).
        functions: the laws of the inputs that drive the linkage, which all designs share.
        start, stop: of the motion, s; they may be the same.
        settings: how the chain is cut, as finely as the design that needs it finest.
        tolerance: how far a pose may be from the exact assembly, rounding apart, in units.
    Raises:
        InputOutOfRange: a law has no meaning at an instant, whatever the design.
    """
    plain = Follow(functions, start, stop, settings, tolerance)
    if len(mechanism.drawn) >= FEW and tolerance > 0.0:
        solved = _Together(mechanism, plain).solve()
        if solved is not None:
            return solved
    return solve_plainly(mechanism, plain)


def solve_plainly(mechanism: Mechanism, follow: Follow) -> SolvedDesigns:
    """The same in the plain form: all together, and in halves where one of them cannot be followed."""
    closed = np.full(mechanism.drawn.shape, np.nan)
    failures: dict[int, Status] = {}
    alive: list[Numbers] = []
    waiting = [np.arange(len(closed))] if len(closed) else []
    ended = _Ended(None, None, None, COMPLETE)
    while waiting:
        members = waiting.pop()
        ended = follow.together(mechanism.taken(members))
        if ended.drawing is not None:
            closed[members] = ended.drawing.y
        if ended.status.complete:
            alive.append(members)
        elif len(members) == 1 or isinstance(ended.status, TooLong):
            # How long a motion is hangs on its laws, which all of them share.
            failures |= dict.fromkeys(members.tolist(), ended.status)
        else:
            # Which of them it was shows in halves.
            middle = len(members) // 2
            waiting += [members[middle:], members[:middle]]
    numbers = np.concatenate([np.empty(0, dtype=np.intp), *alive])
    if failures or len(alive) > 1:
        ended = _Ended(None, None, None, COMPLETE)
        if len(numbers):
            ended = follow.together(mechanism.taken(numbers))
        if not ended.status.complete:
            # Each can be followed, but all together take too many segments.
            failures |= dict.fromkeys(numbers.tolist(), ended.status)
            return SolvedDesigns(numbers[:0], None, None, closed, failures)
    return SolvedDesigns(numbers, ended.chain, None if ended.pose is None else ended.pose.y, closed, failures)


@dataclass(frozen=True)
class _Ended:
    """How far a batch came as a whole."""

    drawing: Path | None
    pose: Pose | None
    chain: Chain | None
    status: Status


@dataclass(frozen=True)
class Follow:
    """What a batch is to follow, and how finely."""

    functions: Mapping[str, TimeFunction]
    start: float
    stop: float
    settings: Settings
    tolerance: float

    def together(self, mechanism: Mechanism) -> _Ended:
        """Solve a batch; the status is that of the first member that stops it."""
        drawing, pose = self.begun(mechanism)
        if not isinstance(pose, Pose):
            return _Ended(drawing, None, None, pose)
        chain = build_chain(mechanism, self.functions, pose, self.start, self.stop, self.settings)
        return _Ended(drawing, pose, chain, chain.status)

    def begun(self, mechanism: Mechanism) -> tuple[Path | None, Pose | Status]:
        """The closed drawings of a batch, and its poses at the start, or what stops the first without one."""
        drawing, start = None, self.start
        try:
            drawing = close_drawing(mechanism, start, self.tolerance)
            inputs = {name: law.series(start, 0)[..., 0] for name, law in self.functions.items()}
            return drawing, assemble(mechanism, inputs, start, drawing, self.tolerance)
        except AssemblyError as error:
            return drawing, blocked_by(error)


@dataclass(frozen=True)
class _Together:
    """Designs as columns."""

    mechanism: Mechanism
    plain: Follow

    def solve(self) -> SolvedDesigns | None:
        """What became of them; None where it takes the plain form."""
        mechanism, system, topology = self.mechanism, self.mechanism.map, self.mechanism.topology
        driven = [mechanism.layout.scalar(drive.coordinate) for drive in topology.drives]
        constants = ((mechanism.layout.zero, 0.0), (mechanism.layout.one, 1.0))
        columns = columns_of(system, constants, driven, mechanism.drawn[0])
        if columns is None:
            return None
        failures: dict[int, Status] = {}
        closed, pose, left = self._start(columns, failures)
        begun = np.flatnonzero(np.isfinite(left))
        if not len(begun):
            return SolvedDesigns(begun, None, None, closed, failures)
        taken = mechanism.taken(begun)

        def goes_on(place: int) -> bool:
            number = int(begun[place])
            ended = self.plain.together(mechanism.taken(np.array([number])))
            if not ended.status.complete:
                failures[number] = ended.status
            return ended.status.complete

        plain = self.plain
        course = Course(columns, plain.functions, plain.start, plain.stop, plain.settings.kept, goes_on)
        y = np.ascontiguousarray(pose[:, begun])
        try:
            places, segments, work = course.build(taken, y, left[begun])
        except NotTogether:
            return self._plainly(begun, closed, failures)
        alive = begun[places]
        return SolvedDesigns(alive, Chain(segments, work), pose.T[alive], closed, failures)

    def _plainly(self, begun: Numbers, closed: Array, failures: dict[int, Status]) -> SolvedDesigns:
        """The motion of designs that have a start, in the plain form."""
        begun = np.array([number for number in begun.tolist() if number not in failures], dtype=np.intp)
        solved = solve_plainly(self.mechanism.taken(begun), self.plain)
        failures |= {int(begun[place]): status for place, status in solved.failures.items()}
        return SolvedDesigns(begun[solved.alive], solved.chain, solved.start, closed, failures)

    def _start(self, columns: Columns, failures: dict[int, Status]) -> tuple[Array, Array, Array]:
        """Closed drawings, (D, size), poses at the start, (size, D), and what is left of them, (D,).

        NaN, and infinite, where there is none.
        """
        mechanism, n = self.mechanism, self.mechanism.map.unknowns
        drawn = np.ascontiguousarray(mechanism.drawn.T)
        drawing = follow_together(columns, drawn, drawn[n:], self.plain.tolerance, closing=True)
        series = {name: law.series(self.plain.start, 0) for name, law in self.plain.functions.items()}
        target = np.array(drawn[n:])
        for drive, place in zip(mechanism.topology.drives, columns.driven, strict=True):
            target[place - n] = drive.series(series[drive.input], mechanism.drawing)[..., 0]
        reached = follow_together(columns, drawing.y, target, self.plain.tolerance, closing=False)
        sound = drawing.done & reached.done
        sound &= ~turned_over(mechanism, np.ascontiguousarray(drawing.y.T))[0]
        closed, pose = np.ascontiguousarray(drawing.y.T), reached.y
        left = np.where(sound, reached.left, np.inf)
        for number in np.flatnonzero(~sound).tolist():
            one, end = self.plain.begun(mechanism.taken(np.array([number])))
            closed[number] = np.nan if one is None else one.y[0]
            if isinstance(end, Pose):
                pose[:, number], left[number] = end.y[0], end.left[0]
            else:
                failures[number] = end
        return closed, pose, left
