"""Where the numbers of a motion are in a table: a row for each number, a column for each instant.

The numbers of a row lie side by side in memory. So series are summed right into their place, what is added to
all points is one sum for each derivative, and a block of columns stays in a cache until it is whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Effect
from pointcoord.effects.plan import Plan
from pointcoord.linkage.topology import Topology

Array = NDArray[np.float64]
State = tuple[int, str]
"""A time derivative, and the point that it is of."""


@dataclass(frozen=True)
class Table:
    """The rows of a table.

    Attributes:
        moving: states that are reported of points that move: three rows each from row 0, first
            those of points that are solved for, then those of points that are carried.
        still: the same of the chassis' points, in the last rows.
        spare: states of points that move that are only needed; they are in no table.
        spare_still: likewise of points of the chassis.
        places: by quantity and name the rows of every number, in the order of results.
        computed: the effects that compute their numbers from states.
        height: how many rows there are.
        reported: the derivatives of points that are reported.
    """

    moving: tuple[State, ...]
    still: tuple[State, ...]
    spare: tuple[State, ...]
    spare_still: tuple[State, ...]
    places: Mapping[str, Mapping[str, slice]]
    computed: tuple[Effect, ...]
    height: int
    reported: tuple[int, ...]

    @classmethod
    def of(cls, plan: Plan, topology: Topology, highest: Mapping[str, int]) -> Table:
        """The table of the numbers that a plan computes.

        Args:
            highest: time derivative of each point that is needed.
        """
        points = plan.reported(topology)
        reported = {e.derivative: e.quantities[0].name for e in plan.computed if e.reports_states}
        solved, carried, still = (
            tuple((d, point) for d in sorted(reported) for point in kind if point in points)
            for kind in (topology.moving, topology.carried, topology.chassis)
        )
        moving = (*solved, *carried)
        spare, spare_still = (
            tuple(
                (d, point)
                for d in range(plan.derivative + 1)
                for point in kind
                if highest.get(point, -1) >= d and not (d in reported and point in points)
            )
            for kind in ((*topology.moving, *topology.carried), topology.chassis)
        )
        height = 3 * len(moving)
        places: dict[str, dict[str, slice]] = {q.name: {} for e in plan.computed for q in e.quantities}
        computed = tuple(effect for effect in plan.computed if not effect.reports_states)
        for effect in computed:
            gives = effect.gives_numbers(topology)
            for quantity in effect.quantities:
                every = points if quantity.of == "point" else tuple(topology.bodies)
                rows, names = 1 if quantity.of == "car" else 3, gives[quantity.name]
                those = every if names is None else names
                # A number that two effects give is there once.
                for name in (name for name in those if name not in places[quantity.name]):
                    places[quantity.name][name] = slice(height, height + rows)
                    height += rows
        first = {state: 3 * i for i, state in enumerate(moving)}
        first |= {state: height + 3 * i for i, state in enumerate(still)}
        for d, named in reported.items():
            places[named] = {p: slice(first[d, p], first[d, p] + 3) for p in points}
        height += 3 * len(still)
        return cls(moving, still, spare, spare_still, places, computed, height, tuple(sorted(reported)))

    @property
    def first_still(self) -> int:
        """The row from which on the chassis' points are."""
        return self.height - 3 * len(self.still)

    @property
    def states(self) -> list[tuple[int, State]]:
        """The first row of every reported state, and which it is."""
        moving = [(3 * i, state) for i, state in enumerate(self.moving)]
        return moving + [(self.first_still + 3 * i, state) for i, state in enumerate(self.still)]

    def states_of(self, derivative: int) -> list[slice]:
        """The rows of a reported derivative of all points."""
        found: list[slice] = []
        for first in (first for first, (d, _) in self.states if d == derivative):
            begun = found.pop().start if found and found[-1].stop == first else first
            found.append(slice(begun, first + 3))
        return found

    def numbers(self, rows: Array) -> dict[str, dict[str, Array]]:
        """A table's numbers by quantity and name, of points and bodies (..., N, 3), of the car (..., N).

        Args:
            rows: the table, shape (..., height, N); the numbers are views of it.
        """
        return {
            quantity: {name: _seen(rows, place) for name, place in places.items()}
            for quantity, places in self.places.items()
        }

    def put(self, rows: Array, quantity: str, name: str, array: Array) -> None:
        """Write one number at all instants, as an effect gives it, into a table."""
        _seen(rows, self.places[quantity][name])[...] = array


def vectors(rows: Array, first: int) -> Array:
    """Three rows as vectors (..., N, 3), a view."""
    return rows[..., first : first + 3, :].swapaxes(-1, -2)


def triples(rows: Array, part: slice) -> Array:
    """Rows of points as an array (..., points, 3, N), a view."""
    chosen = rows[..., part, :]
    return chosen.reshape(*chosen.shape[:-2], chosen.shape[-2] // 3, 3, chosen.shape[-1])


def _seen(rows: Array, place: slice) -> Array:
    return rows[..., place.start, :] if place.stop == place.start + 1 else vectors(rows, place.start)
