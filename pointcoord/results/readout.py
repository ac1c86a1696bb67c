"""From the states of points to what a scene asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Poses
from pointcoord.effects.plan import Plan
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import input_slopes, point_slopes
from pointcoord.results.samples import Channel, Samples
from pointcoord.results.table import Table, triples, vectors

Array = NDArray[np.float64]
Slopes = Mapping[str, tuple[Mapping[str, Array], Mapping[str, Array]]]
States = Sequence[Mapping[str, Array]]
"""For each time derivative, the points' states of shape (..., N, 3), mm, in the chassis' frame, from the
mechanism's origin."""

# Instants at a time: what is made on the way stays in a second-level cache, and is long enough for numpy.
BLOCK = 4096


@dataclass(frozen=True)
class Readout:
    """How states become results.

    Attributes:
        plan: the effects to compute.
        chassis: what it does, which is added to the points' states.
        axes: the car's, along which angles are measured.
    """

    mechanism: Mechanism
    plan: Plan
    chassis: ChassisMotion
    axes: CarAxes

    @property
    def derivatives(self) -> dict[str, int]:
        """Highest time derivative that is evaluated of each point that is reported or needed."""
        return self.plan.derivatives(self.mechanism.topology)

    @property
    def reported_derivative(self) -> int:
        """Highest time derivative that is reported of points; 0 where none is."""
        return max(self.table.reported, default=0)

    @cached_property
    def table(self) -> Table:
        """Where the numbers of a motion are, side by side."""
        return Table.of(self.plan, self.mechanism.topology, self.derivatives)

    def samples(self, times: Array, states: States) -> Samples:
        """Compute the effects of the plan from states, and name the numbers."""
        batch = np.broadcast_shapes(*(state.shape[:-2] for each in states for state in each.values()))
        rows = np.empty((*batch, self.table.height, len(times)))
        for low in range(0, len(times), BLOCK):
            block = rows[..., low : low + BLOCK]
            here = [{name: each[..., low : low + BLOCK, :] for name, each in s.items()} for s in states]
            for first, (derivative, point) in self.table.states:
                vectors(block, first)[...] = here[derivative][point]
            self.complete(times[low : low + BLOCK], here, block)
        return self.named(times, rows)

    def named(self, times: Array, rows: Array) -> Samples:
        """The numbers of a whole table, by name."""
        found = self.table.numbers(rows)
        numbers = {
            name: Channel(quantity, found.get(name, {}), self._left_out(name), self._unreported(name))
            for name, quantity in QUANTITIES.items()
        }
        return Samples(times.copy(), numbers)

    def complete(
        self, times: Array, states: States, rows: Array, coordinates: Callable[[], Array] | None = None
    ) -> None:
        """Compute the numbers that are made of states, and add to those what reporting adds.

        Args:
            coordinates: y, (N, size), for derivatives by an input; asked for where an effect takes one.
            rows: a table or some columns of one, shape (..., height, N), with the states in their places.
        """
        in_chassis = states[0]
        slopes = {} if coordinates is None else self.slopes(times, coordinates)
        if self.chassis.turns:
            # The states may be views of the table, which those of the turned car are written into.
            in_chassis = {name: place.copy() for name, place in states[0].items()}
            states = self.chassis.turned(times, states)
            for first, (derivative, point) in self.table.states:
                vectors(rows, first)[...] = states[derivative][point]
        added = self.added(times)
        self.compute(states, in_chassis, added, rows, slopes)
        for derivative in self.table.reported:
            more = added[derivative]
            if more is not None:
                for part in self.table.states_of(derivative):
                    places = triples(rows, part)
                    places += more.swapaxes(-1, -2)[..., None, :, :]

    def _unreported(self, quantity: str) -> tuple[str, ...]:
        """The points whose states of a quantity the scene leaves out."""
        computed = any(
            q.name == quantity for e in self.plan.computed if e.reports_states for q in e.quantities
        )
        return self.plan.unreported if computed else ()

    def compute(
        self,
        states: States,
        in_chassis: Mapping[str, Array],
        added: Sequence[Array | None],
        rows: Array,
        slopes: Slopes,
    ) -> None:
        """Compute the numbers that are made of states.

        Args:
            in_chassis: positions before the turns of the chassis.
            slopes: as `slopes` gives them.
            added: what reporting adds to these.
            rows: as of `complete`.
        """
        if self.table.computed:
            poses = Poses(self.mechanism, self.axes, states, in_chassis, added, slopes)
            for effect in self.table.computed:
                for quantity, arrays in effect.evaluate(poses).items():
                    for name, array in arrays.items():
                        self.table.put(rows, quantity, name, array)

    def slopes(self, times: Array, coordinates: Callable[[], Array]) -> Slopes:
        """By way, the derivatives of positions by its input, after the turns of the chassis and before."""
        if not self.plan.ways:
            return {}
        if not len(times):
            nowhere = dict.fromkeys(self.mechanism.topology.points, np.zeros((0, 3)))
            return dict.fromkeys(self.plan.ways, (nowhere, nowhere))
        y, found = coordinates(), {}
        laws = {name: self.chassis.law(name, times, 0)[0] for name in self.chassis.turning}
        held = {name: [law, np.zeros_like(law)] for name, law in laws.items()}
        places = {name: place * self.mechanism.unit for name, place in self.mechanism.places(y).items()}
        for way in self.plan.ways:
            (name, *_) = (*self.mechanism.topology.driven_along(way), "")
            slopes = point_slopes(self.mechanism, y, input_slopes(self.mechanism, y, name))
            found[way] = self.chassis.turned_by(held, [places, slopes])[1], slopes
        return found

    def added(self, times: Array) -> tuple[Array | None, ...]:
        """By time derivative, what reporting adds to every point; None where that is zero."""
        shifts = self.chassis.states(times, self.reported_derivative)
        rest: list[Array | None] = [*shifts[1:]] or [None] * self.plan.derivative
        return self._offset(shifts), *rest

    def _left_out(self, quantity: str) -> dict[str, tuple[str, ...] | None]:
        """The effects that would give more of a quantity, and what each gives of it."""
        others = (EFFECTS[name] for name in self.plan.left_out)
        return {
            other.name: other.gives_numbers[quantity] for other in others if quantity in other.gives_numbers
        }

    def _offset(self, shifts: Sequence[Array]) -> Array | None:
        origin = self.mechanism.origin[..., None, :]
        if not shifts:
            return origin if origin.any() else None
        return np.asarray(origin + shifts[0])
