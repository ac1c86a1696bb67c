r"""A scene whose linkage is solved, in whichever way: read at instants, and proven.

Of the points that are solved for, each way knows the states. What rides on a body is put together of these,

    p = p_0 + a e1 + b e2 + c e1 x e2,
    p'' = p_0'' + a e1'' + b e2'' + c (e1'' x e2 + 2 e1' x e2' + e1 x e2'').
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import comb
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.solved_coordinates import Summed
from pointcoord.errors import WrongArgument
from pointcoord.mechanism.freedoms import locked
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import BLOCK, Readout
from pointcoord.results.samples import Samples
from pointcoord.results.table import State
from pointcoord.solve.status import Status
from pointcoord.time_functions import TimeFunction

if TYPE_CHECKING:
    from pointcoord.bounds.proof import Proof

Array = NDArray[np.float64]
Places = Mapping[State, Array]

# Of instants in any order, how many are computed before they are put where they belong: 9 MB of them.
ORDERED = 2**13


@dataclass(frozen=True, eq=False)
class SolvedScene(ABC):
    """What a motion is read from.

    Attributes:
        functions: the laws of the inputs that drive the linkage.
        status: whether it covers all that was asked for, and if not, what stopped the solver.
        solving: what solving took.
        start, stop: from when on and up to when it is known, s; infinite where it is not at all.
        orders: of every series that it is summed from.
        notes: where it was not solved as the scene asks.
    """

    readout: Readout
    functions: Mapping[str, TimeFunction]
    status: Status
    solving: Work
    start: float
    stop: float
    orders: tuple[int, ...]
    notes: tuple[str, ...] = field(default=(), kw_only=True)

    dense: ClassVar[bool] = True
    """Whether it is known between the scene's instants too."""

    @abstractmethod
    def solved(self, instants: Array, derivatives: int) -> Sequence[Array]:
        """The coordinates that are solved for, maybe with others after them, and their derivatives.

        Args:
            instants: shape (N,), s; they do not decrease.
        Returns:
            By derivative, each (..., coordinates, N), units per s^d.
        """

    @abstractmethod
    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """y and its derivatives up to one, or as many as were solved for, each (..., N, size), units per s^d.

        Args:
            instants: shape (N,), s, in any order.
        """

    def summed(self, instants: Array) -> Sequence[Summed]:
        """How `coordinates` sums each derivative; empty if they were solved for at the instants."""
        return ()

    def pieces(self, instants: Array) -> NDArray[np.intp]:
        """Number of the series that each instant is summed from, (N,); of those that were solved for any."""
        return np.zeros(len(instants), dtype=np.intp)

    def unsolved(self, instants: Array) -> Array:
        """How far each pose was left because no more was asked, proven, in units, (N,)."""
        return np.zeros(len(instants))

    @property
    def work(self) -> Work:
        """What solving took, and what reading takes of each instant."""
        table, chassis = self.readout.table, self.readout.mechanism.topology.chassis
        moving = [name for _, name in (*table.states, *table.spare) if name not in chassis]
        derivatives = self.readout.plan.derivative + 1
        return self.solving + Work(derivatives_evaluated=derivatives, coordinates_evaluated=3 * len(moving))

    def fill_moving(self, instants: Array, places: Places) -> None:
        """Put the states of all points that move into their places, each (..., 3, N), mm per s^d."""
        mechanism = self.readout.mechanism
        layout, carried = mechanism.layout, mechanism.topology.carried
        unit, y = mechanism.unit[..., None, None], self.solved(instants, self.readout.plan.derivative)
        for (order, name), place in places.items():
            if name in carried:
                base, *others = (
                    [each[..., layout.span(point), :] for each in y[: order + 1]] for point in carried[name]
                )
                e1, e2 = ([p - q for p, q in zip(other, base, strict=True)] for other in others)
                a, b, c = (mechanism.carrier_weights[name][..., i, None, None] for i in range(3))
                normal = sum(comb(order, i) * _cross(e1[i], e2[order - i]) for i in range(order + 1))
                np.multiply(unit, a * e1[order] + b * e2[order] + c * normal + base[order], out=place)
            elif name in mechanism.topology.moving:
                np.multiply(unit, y[order][..., layout.span(name), :], out=place)

    def states(self, instants: Array, rows: Array | None = None) -> list[dict[str, Array]]:
        """By time derivative, the states of the points that the plan asks for (see `readout.States`).

        Args:
            instants: shape (N,), s; they do not decrease.
            rows: a table of results or some columns of one, shape (..., height, N). The states that are
                reported are put into their places, and those that are returned may be views of them.
        Raises:
            WrongArgument: an instant that is not covered, or not a number.
        """
        outside = ~((instants >= self.start) & (instants <= self.stop))
        if outside.any():
            instant = float(instants[outside][0])
            allowed = f"{self.start:.10g} to {self.stop:.10g} s"
            raise WrongArgument(f"t = {instant:.10g} s", "is outside the motion", allowed, instant)
        if rows is None:
            rows = self.readout.room(len(instants))
        places = self.readout.places(rows)
        self.fill_moving(instants, places)
        return self.readout.by_derivative(places)

    def samples(self, times: Array, out: Array | None = None) -> Samples:
        """What the scene asks for at instants of shape (N,), in any order.

        Args:
            out: where the numbers go, shape (rows, N); a new array if not given.
        Raises:
            WrongArgument: an instant that was not solved for, or not a number.
            MechanismError: a row that was left out, as it followed from others at the drawing, is violated.
        """
        readout = self.readout
        rows = readout.room(len(times)) if out is None else out
        if (times[1:] >= times[:-1]).all():
            self.fill(times, rows)
        else:
            order, room = np.argsort(times, kind="stable"), readout.room(min(ORDERED, len(times)))
            for low in range(0, len(times), ORDERED):
                places = order[low : low + ORDERED]
                block = room[..., : len(places)]
                self.fill(times[places], block)
                rows[..., places] = block
        samples = readout.named(times, rows)
        if readout.mechanism.topology.left_out:
            off = self.proof(samples).pose_bound / readout.mechanism.unit
            for error in locked(readout.mechanism, self.coordinates(samples.times, 0)[0], off).values():
                raise error
        return samples

    def fill(self, times: Array, rows: Array) -> None:
        """Fill a table at instants that do not decrease."""
        for low in range(0, len(times), BLOCK):
            here, block = times[low : low + BLOCK], rows[..., low : low + BLOCK]
            y = self.coordinates(here, 0)[0] if self.readout.plan.along_ways else None
            self.readout.complete(self.readout.laws(here), self.states(here, block), block, y)

    def proof(self, samples: Samples, *, rates: bool = False, certain: bool = False) -> Proof:
        """What is proven at each of the samples' times.

        Args:
            rates: every number by itself.
            certain: as if the laws' values were exact as they are computed.
        """
        # What proves is imported where it is asked for, as most motions are read only.
        from pointcoord.bounds.proof import Reported, prove

        readout = self.readout
        reported = Reported(
            numbers=samples.numbers,
            effects=readout.plan.computed,
            axes=readout.axes,
            chassis=readout.chassis,
            laws=self.functions,
            solved=self,
        )
        return prove(readout.mechanism, samples.times, reported, rates=rates, certain=certain)


def _cross(a: Array, b: Array) -> Array:
    """a x b, all (..., 3, N)."""
    crossed = np.empty_like(a)
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        crossed[..., i, :] = a[..., j, :] * b[..., k, :] - a[..., k, :] * b[..., j, :]
    return crossed
