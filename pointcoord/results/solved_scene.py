r"""A scene whose linkage is solved by any method: the interface for reading and proving numbers at instants.

Every method gives the states of the solved points. The states of a point carried by a body follow from them,

    p = p_0 + a e1 + b e2 + c e1 x e2,
    p'' = p_0'' + a e1'' + b e2'' + c (e1'' x e2 + 2 e1' x e2' + e1 x e2'').
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import comb, factorial
from typing import ClassVar

import numpy as np

from pointcoord.bounds.summed import Summed
from pointcoord.errors import WrongArgument
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import BLOCK, Readout
from pointcoord.solve.status import Status
from pointcoord.time_functions import TimeFunction


@dataclass(frozen=True, eq=False)
class SolvedScene(ABC):
    """The solution from which a motion is read.

    Attributes:
        readout: computes results from states.
        functions: the laws of the inputs that drive the linkage.
        status: whether the whole scene is solved, and if not, what stopped the solver.
        solving: work of solving.
        start, stop: first and last instant that is solved, s; inf and -inf if there is none.
        orders: order of every series of the solution.
        notes: where the scene was not solved as requested.
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
    """Whether the solution is also known between the scene's instants."""

    @abstractmethod
    def solved(self, instants: Array, derivatives: int) -> Sequence[Array]:
        """The unknown coordinates, possibly followed by others, and their derivatives.

        Args:
            instants: shape (N,), s, in any order.
            derivatives: highest derivative; fewer are returned if fewer were solved for.
        Returns:
            One array for each derivative, (..., coordinates, N), units per s^d.
        """

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """y and its derivatives, each (..., N, size), units per s^d; the arguments are those of `solved`.

        The instants are contiguous in memory.
        """
        mechanism, unknown = self.readout.mechanism, self.solved(instants, derivatives)
        if mechanism.drawn.ndim > 1:
            # All designs have the same laws.
            mechanism = mechanism.taken(np.arange(len(mechanism.drawn))[:, None])
        laws = {name: law.series(instants, len(unknown) - 1) for name, law in self.functions.items()}
        known, count = mechanism.known_series(laws), mechanism.map.unknowns
        return [
            np.concatenate(
                [state[..., :count, :], factorial(d) * known[..., d, :].swapaxes(-1, -2)], axis=-2
            ).swapaxes(-1, -2)
            for d, state in enumerate(unknown)
        ]

    def summed(self, instants: Array) -> Sequence[Summed]:
        """Magnitudes of the terms that `coordinates` sums for each derivative; empty if nothing is summed."""
        return ()

    def unsolved(self, instants: Array) -> Array:
        """Proven distance of each pose to its assembly at which the solver stopped, in units, (N,)."""
        return np.zeros(len(instants))

    @property
    def work(self) -> Work:
        """Work of solving, and work of reading for each instant."""
        table, chassis = self.readout.table, self.readout.mechanism.topology.chassis
        moving = [name for _, name in (*table.states, *table.spare) if name not in chassis]
        derivatives = self.readout.plan.derivative + 1
        return self.solving + Work(derivatives_evaluated=derivatives, coordinates_evaluated=3 * len(moving))

    def states(self, instants: Array, rows: Array) -> list[dict[str, Array]]:
        """The states of the points that the plan needs, by time derivative (see `readout.States`).

        Args:
            instants: shape (N,), s.
            rows: a table of results or some columns of one, shape (..., height, N). Reported states are
                written into it, and the returned states may be views of it.
        """
        mechanism, found = self.readout.mechanism, self.readout.states(rows)
        layout, carried = mechanism.layout, mechanism.topology.carried
        unit, y = mechanism.unit[..., None, None], self.solved(instants, self.readout.plan.derivative)
        for order, name in ((order, name) for order, of in enumerate(found) for name in of):
            place = found[order][name].swapaxes(-1, -2)
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
        return found

    def fill(self, times: Array, rows: Array) -> None:
        """Fill a table at instants that do not decrease."""
        self.fill_plainly(times, rows)

    def fill_plainly(self, times: Array, rows: Array, *, add: bool = True) -> None:
        """Fill a table by evaluating the formulas at every instant.

        Args:
            add: whether to add the origin and the displacement of the chassis.
        Raises:
            WrongArgument: an instant outside the motion, or not a number.
        """
        for low in range(0, len(times), BLOCK):
            here, block = times[low : low + BLOCK], rows[..., low : low + BLOCK]
            outside = ~((here >= self.start) & (here <= self.stop))
            if outside.any():
                instant = float(here[outside][0])
                allowed = f"{self.start:.10g} to {self.stop:.10g} s"
                raise WrongArgument(f"t = {instant:.10g} s", "is outside the motion", allowed, instant)
            y = self.coordinates(here, 0)[0] if self.readout.plan.along_ways else None
            self.readout.complete(self.readout.laws(here), self.states(here, block), block, y, add=add)


def _cross(a: Array, b: Array) -> Array:
    """a x b, all (..., 3, N)."""
    crossed = np.empty_like(a)
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        crossed[..., i, :] = a[..., j, :] * b[..., k, :] - a[..., k, :] * b[..., j, :]
    return crossed
