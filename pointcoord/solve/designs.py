"""Many designs of one suspension solved together: those that can be, and why the others cannot.

A batch of cars shares the segments of one chain of series. A design that cannot be closed, assembled or moved
drops out with its status, and the others go on as if it had not been there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import AssemblyError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve.assembly import Path, Pose, assemble, close_drawing
from pointcoord.solve.status import COMPLETE, Blocked, Status
from pointcoord.solve.taylor import Chain, Settings, build_chain
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]


@dataclass(frozen=True)
class SolvedDesigns:
    """What became of a batch of designs.

    Attributes:
        alive: numbers of the designs that were solved to the end, in increasing order, (A,).
        chain: of those, its coefficients of shape (A, order + 1, size); without segments if there are none.
        start: the poses of those at the first instant; None if there are none.
        closed: coordinates of the closed drawings, (D, size); NaN where there is none.
        failures: by number, what stopped each of the others.
    """

    alive: Numbers
    chain: Chain | None
    start: Pose | None
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
    follow = _Follow(functions, start, stop, settings, tolerance)
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
        elif len(members) == 1:
            failures[int(members[0])] = ended.status
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
    return SolvedDesigns(numbers, ended.chain, ended.pose, closed, failures)


@dataclass(frozen=True)
class _Ended:
    """How far a batch came as a whole."""

    drawing: Path | None
    pose: Pose | None
    chain: Chain | None
    status: Status


@dataclass(frozen=True)
class _Follow:
    """What a batch is to follow, and how finely."""

    functions: Mapping[str, TimeFunction]
    start: float
    stop: float
    settings: Settings
    tolerance: float

    def together(self, mechanism: Mechanism) -> _Ended:
        """Solve a batch; the status is that of the first member that stops it."""
        drawing, start = None, self.start
        try:
            drawing = close_drawing(mechanism, start, self.tolerance)
            inputs = {name: law.series(start, 0)[..., 0] for name, law in self.functions.items()}
            pose = assemble(mechanism, inputs, start, drawing, self.tolerance)
        except AssemblyError as error:
            return _Ended(drawing, None, None, _status(error))
        chain = build_chain(mechanism, self.functions, pose, start, self.stop, self.settings)
        return _Ended(drawing, pose, chain, chain.status)


def _status(error: AssemblyError) -> Blocked:
    return Blocked(
        error.problem,
        reached=error.reached,
        wanted=error.wanted,
        condition=error.condition,
        reduce=error.reduce,
        limits=error.limits,
        instant=error.instant,
    )
