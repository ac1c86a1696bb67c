"""The layout of the table of a motion's numbers: one row for each number, one column for each instant.

The numbers of a row are contiguous in memory. So series are summed directly into their rows, one sum for each
derivative adds the chassis' displacement to all points, and a block of columns stays in a cache until it is
complete.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import QUANTITIES, Plan
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array, Flags
from pointcoord.results.samples import Channel, Samples

State = tuple[int, str]
"""A time derivative, and the name of the point."""


@dataclass(frozen=True)
class Table:
    """The rows of a table.

    Attributes:
        plan: the effects whose numbers are in the table.
        topology: topology of the mechanism.
        states: first of the three rows of every reported state. The rows of moving points begin at row 0,
            those of chassis points at `first_still`; each group is in the order of derivatives.
        spare: states that effects need but that are not reported; they have no rows.
        places: rows of every number, by quantity and name, in the order of results.
        computed: effects that compute their numbers from states.
        first_still: first row of the chassis points.
        height: number of rows.
        reported: the derivatives of points that are reported.
    """

    plan: Plan
    topology: Topology
    states: Mapping[State, int]
    spare: tuple[State, ...]
    places: Mapping[str, Mapping[str, slice]]
    computed: tuple[Effect, ...]
    first_still: int
    height: int
    reported: tuple[int, ...]

    @classmethod
    def of(cls, plan: Plan, topology: Topology) -> Table:
        """The table of the numbers that a plan computes."""
        points, highest = plan.reported(topology), plan.derivatives(topology)
        named = {e.derivative: e.quantities[0].name for e in plan.computed if e.reports_states}
        reported = tuple(sorted(named))
        kinds = (*topology.moving, *topology.carried), topology.chassis
        moving, still = ([(d, p) for d in reported for p in kind if p in points] for kind in kinds)
        states = {state: 3 * i for i, state in enumerate(moving)}
        height = 3 * len(states)
        places: dict[str, dict[str, slice]] = {q.name: {} for e in plan.computed for q in e.quantities}
        computed = tuple(effect for effect in plan.computed if not effect.reports_states)
        for effect in computed:
            gives = effect.gives_numbers(topology)
            for quantity in effect.quantities:
                every = points if quantity.of == "point" else tuple(topology.bodies)
                rows, names = 1 if quantity.of == "car" else 3, gives[quantity.name]
                those = every if names is None else names
                # A number that two effects give has one row only.
                for name in (name for name in those if name not in places[quantity.name]):
                    places[quantity.name][name] = slice(height, height + rows)
                    height += rows
        first_still = height
        states |= {state: height + 3 * i for i, state in enumerate(still)}
        height += 3 * len(still)
        for d, quantity_name in named.items():
            places[quantity_name] = {p: slice(states[d, p], states[d, p] + 3) for p in points}
        needed = ((d, point) for d in range(plan.derivative + 1) for kind in kinds for point in kind)
        spare = tuple((d, p) for d, p in needed if highest.get(p, -1) >= d and (d, p) not in states)
        return cls(plan, topology, states, spare, places, computed, first_still, height, reported)

    def add(self, rows: Array, derivative: int, more: Array) -> None:
        """Add a vector at each instant, (..., N, 3), to a reported derivative of all points in a table."""
        place = self.reported.index(derivative)
        moving = 3 * sum(first < self.first_still for first in self.states.values())
        for low, high in ((0, moving), (self.first_still, self.height)):
            step = (high - low) // len(self.reported)
            part = rows[..., low + place * step : low + (place + 1) * step, :]
            points = part.reshape(*part.shape[:-2], step // 3, 3, part.shape[-1])
            points += more.swapaxes(-1, -2)[..., None, :, :]

    def named(self, times: Array, rows: Array) -> Samples:
        """The numbers of a table by name.

        Args:
            rows: the table, shape (..., height, N); the numbers are views of the table.
        """
        numbers = {}
        for name, quantity in QUANTITIES.items():
            found = {part: _seen(rows, place) for part, place in self.places.get(name, {}).items()}
            numbers[name] = Channel(quantity, found, self.plan, self.topology)
        return Samples(times.copy(), numbers)

    def missing(self, rows: Array) -> Iterator[tuple[str, str, Flags]]:
        """The numbers that do not exist at some instants, though the mechanism has them.

        Args:
            rows: the table, shape (..., height, N).
        Returns:
            Of each, the number in words, why it may not exist, and where it does not, (..., N).
        """
        # A sum finds every number that is not finite. If the sum itself overflows, the search is in vain.
        with np.errstate(over="ignore", invalid="ignore"):
            if np.isfinite(rows.sum()):
                return
        for effect in self.plan.computed:
            why = f": {effect.no_number}" if effect.no_number else ""
            gives = effect.gives_numbers(self.topology)
            for quantity in effect.quantities:
                own = gives[quantity.name]
                for name, place in self.places[quantity.name].items():
                    if own is None or name in own:
                        where = np.asarray(~np.isfinite(rows[..., place, :]).all(axis=-2))
                        if where.any():
                            yield f"{quantity.words} of {name}", why, where

    def put(self, rows: Array, quantity: str, name: str, array: Array) -> None:
        """Write the values of one number at all instants, as an effect returns them, into a table."""
        _seen(rows, self.places[quantity][name])[...] = array


def vectors(rows: Array, first: int) -> Array:
    """Three rows as vectors (..., N, 3), a view."""
    return rows[..., first : first + 3, :].swapaxes(-1, -2)


def _seen(rows: Array, place: slice) -> Array:
    return rows[..., place.start, :] if place.stop == place.start + 1 else vectors(rows, place.start)
