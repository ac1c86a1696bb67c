"""Solves many designs of one suspension together, and says what stopped those that cannot be solved.

All drawings are closed and all poses assembled in one batch, each along proven steps of its own. Then the
designs share one series in the inputs, if the inputs repeat often enough (see `series_in_inputs`), or the
segments of a chain of series in time. A design that needs much shorter segments leaves the others (see
`build_chains`). A design that cannot be closed, assembled or moved is left out with its error and does not
affect the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.errors import PointcoordError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array, Indices
from pointcoord.solve.assembly import assembled, closed_drawings
from pointcoord.solve.series_in_inputs import follow_by_inputs
from pointcoord.solve.step_rule import Settings
from pointcoord.solve.taylor import Chain, build_chains
from pointcoord.time_functions import TimeFunction


@dataclass(frozen=True)
class Followed:
    """Designs that share the segments of one chain.

    Attributes:
        numbers: numbers of the designs, in increasing order, (A,).
        chain: coefficients of shape (A, order + 1, size), or (A, powers, size) in an `InputSeries`.
    """

    numbers: Indices
    chain: Chain

    @property
    def bytes_of_a_design(self) -> int:
        """Bytes that the series of one design take."""
        return sum(8 * segment.coefficients[0].size for segment in self.chain.segments)


@dataclass(frozen=True)
class SolvedDesigns:
    """Results of a batch of designs.

    Attributes:
        followed: groups of designs that were followed to the end; each solved design is in one group.
        closed: coordinates of the closed drawings, (D, size); NaN where a drawing cannot be closed.
        failures: the error of each design that was not solved, by number.
    """

    followed: tuple[Followed, ...]
    closed: Array
    failures: Mapping[int, PointcoordError]

    @property
    def solved(self) -> Indices:
        """The numbers of all solved designs, in increasing order."""
        return np.sort(
            np.concatenate([np.empty(0, dtype=np.intp), *(each.numbers for each in self.followed)])
        )

    @property
    def bytes_of_a_design(self) -> int:
        """Bytes that the series of one design take, in the group with the longest chain."""
        return max((each.bytes_of_a_design for each in self.followed), default=0)


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
        mechanism: the mechanism of all designs, with one batch dimension, (D,).
        functions: the laws of the inputs that drive the linkage, shared by all designs.
        start, stop: first and last instant of the motion, s; they may be equal.
        settings: tolerance of the chains, the finest that any design needs.
        tolerance: allowed distance of a pose to the exact assembly, without rounding, in units.
    Raises:
        InputOutOfRange: a law is not defined at an instant, whatever the design.
    """
    failures: dict[int, PointcoordError] = {}
    alive = np.arange(len(mechanism.drawn))
    closed = np.full(mechanism.drawn.shape, np.nan)
    if not len(alive):
        return SolvedDesigns((), closed, failures)

    def left(stopped: Mapping[int, PointcoordError]) -> Indices:
        """Places, among `alive`, of the designs that go on."""
        failures.update({int(alive[place]): error for place, error in stopped.items()})
        return np.array([place for place in range(len(alive)) if place not in stopped], dtype=np.intp)

    drawing, stopped = closed_drawings(mechanism, start, tolerance)
    places = left(stopped)
    alive, drawing, mechanism = alive[places], drawing.taken(places), mechanism.taken(places)
    closed[alive] = drawing.y
    if not len(alive):
        return SolvedDesigns((), closed, failures)
    inputs = {name: law.series(start, 0)[..., 0] for name, law in functions.items()}
    pose, stopped = assembled(mechanism, inputs, drawing, start, tolerance)
    places = left(stopped)
    alive, pose = alive[places], pose.taken(places)
    followed = []
    mapped, box, work = follow_by_inputs(pose.mechanism, functions, pose, start, stop, settings)
    if box is not None and len(mapped):
        followed.append(Followed(alive[mapped], Chain((box,), work)))
        rest = np.delete(np.arange(len(alive)), mapped)
        alive, pose = alive[rest], pose.taken(rest)
    for numbers, chain in build_chains(pose.mechanism, functions, pose, start, stop, settings):
        if chain.status.stopped is None:
            followed.append(Followed(alive[numbers], chain))
        else:
            failures |= dict.fromkeys(alive[numbers].tolist(), chain.status.stopped)
    return SolvedDesigns(tuple(followed), closed, dict(sorted(failures.items())))
