"""Turns the states of points into a table of the numbers that a scene asks for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Poses
from pointcoord.effects.plan import Plan
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import ByInput, Way, moved_along
from pointcoord.results.table import Table, vectors

Array = NDArray[np.float64]
Slopes = Mapping[Way, tuple[Mapping[str, Array], Mapping[str, Array]]]
Laws = Mapping[str, Sequence[Array]]
"""Of inputs that move the chassis the values and their time derivatives, each (N,), mm or rad."""
States = Sequence[Mapping[str, Array]]
"""For each time derivative, the points' states of shape (..., N, 3), mm, in the chassis' frame, from the
mechanism's origin."""

# Instants at a time: what is made on the way stays in a second-level cache, and is long enough for numpy.
BLOCK = 4096
# Instants of one series from which on looking for cells pays (see `cells`).
ENOUGH = 1024


@dataclass(frozen=True, eq=False)
class Readout:
    """How states become results: of a motion, of many designs, or of a map.

    Attributes:
        plan: the effects to compute.
        chassis: what it does, which is added to the points' states.
        axes: the car's, along which angles are measured.
    """

    mechanism: Mechanism
    plan: Plan
    chassis: ChassisMotion
    axes: CarAxes

    @cached_property
    def table(self) -> Table:
        return Table.of(self.plan, self.mechanism.topology)

    def room(self, count: int) -> Array:
        """Room for a table at so many instants, (..., height, N)."""
        return np.empty((*self.mechanism.drawn.shape[:-1], self.table.height, count))

    def laws(self, times: Array) -> Laws:
        """What moves the chassis at instants.

        Raises:
            InputOutOfRange: a value, a rate or an acceleration that is too large to be added to anything.
        """
        chassis, reported = self.chassis, max(self.table.reported, default=0)
        return {
            name: list(
                chassis.law(name, times, self.plan.derivative if name in chassis.centres else reported)
            )
            for name in chassis.functions
        }

    def states(self, rows: Array) -> list[dict[str, Array]]:
        """By time derivative, the states that are reported or needed, to be filled: views of a table.

        Those that are only needed are beside it. Those of the chassis' points, which stand in its frame, are
        filled in.
        """
        table, drawn = self.table, self.mechanism.drawn_places
        beside = np.empty((*rows.shape[:-2], 3 * len(table.spare), rows.shape[-1]))
        found: list[dict[str, Array]] = [{} for _ in range(self.plan.derivative + 1)]
        for (order, name), first in table.states.items():
            found[order][name] = vectors(rows, first)
        for i, (order, name) in enumerate(table.spare):
            found[order][name] = vectors(beside, 3 * i)
        for order, states in enumerate(found):
            for name in states.keys() & self.mechanism.topology.chassis:
                states[name][...] = drawn[name][..., None, :] if order == 0 else 0.0
        return found

    def complete(
        self, laws: Laws, states: States, rows: Array, y: Array | None = None, *, add: bool = True
    ) -> None:
        """Compute the numbers that are made of states, and add to those what reporting adds.

        Args:
            states: those that are reported have their places in the table too, and may be views of it.
            rows: a table or some columns of one, shape (..., height, N).
            y: the coordinates, (..., N, size), where an effect takes derivatives by an input.
            add: whether to add it.
        """
        in_chassis, slopes = states, {} if y is None else self.slopes(laws, y)
        if not self.chassis.centres.keys().isdisjoint(laws):
            # The states may be views of the table, which those of the turned car are written into.
            in_chassis = [{name: state.copy() for name, state in of.items()} for of in states[:2]]
            states = self.chassis.turned_by(laws, states)
            for (derivative, point), first in self.table.states.items():
                vectors(rows, first)[...] = states[derivative][point]
        added = self.added(laws)
        if self.table.computed:
            poses = Poses(self.mechanism, self.axes, states, in_chassis, added, slopes)
            for effect in self.table.computed:
                for quantity, arrays in effect.evaluate(poses).items():
                    for name, array in arrays.items():
                        self.table.put(rows, quantity, name, array)
        for derivative in self.table.reported if add else ():
            more = added[derivative]
            if more is not None:
                self.table.add(rows, derivative, more)

    def slopes(self, laws: Laws, y: Array) -> Slopes:
        """By way, the derivatives of positions along it, after the turns of the chassis and before."""
        ways = self.plan.ways(self.mechanism.topology)
        places, every = moved_along(self.mechanism, y, ways)
        return {
            way: (self.chassis.turned_by(alone(laws, way), [places, slopes])[1], slopes)
            for way, slopes in zip(ways, every, strict=True)
        }

    def added(self, laws: Laws) -> list[Array | None]:
        """By time derivative, what reporting adds to every point; None where that is zero."""
        found: list[Array | None] = [*self.chassis.shifts(laws)] or [None] * (self.plan.derivative + 1)
        origin = self.mechanism.origin[..., None, :]
        if found[0] is not None:
            found[0] = origin + found[0]
        elif origin.any():
            found[0] = origin
        return found


def alone(laws: Laws, way: Way) -> dict[str, list[Array]]:
    """Laws by which one input goes at unit rate and the others are held."""
    driven = way.input if isinstance(way, ByInput) else ""
    return {name: [law[0], np.full_like(law[0], float(name == driven))] for name, law in laws.items()}
