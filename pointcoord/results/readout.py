"""Computes the table of numbers that a scene requests from the states of its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pointcoord.effects.effect import Poses
from pointcoord.effects.registry import Plan
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import ByInput, Way, moved_along
from pointcoord.numerics.arrays import Array
from pointcoord.results.table import Table, vectors

Slopes = Mapping[Way, tuple[Mapping[str, Array], Mapping[str, Array]]]
Laws = Mapping[str, Sequence[Array]]
"""Values and time derivatives of the inputs that move the chassis, each (N,), mm or rad."""
States = Sequence[Mapping[str, Array]]
"""For each time derivative, the states of points, (..., N, 3), mm, in the chassis' frame, from the
mechanism's origin."""

# Instants of a block: intermediate results stay in a second-level cache, and arrays are long enough for
# numpy.
BLOCK = 4096


@dataclass(frozen=True, eq=False)
class Readout:
    """Computes results from states, for a motion, many designs or a map.

    Attributes:
        mechanism: the mechanism, of one car or of many designs.
        plan: the effects to compute.
        chassis: the motion of the chassis, which is added to the states of the points.
        axes: the axes of the car, along which angles are measured.
    """

    mechanism: Mechanism
    plan: Plan
    chassis: ChassisMotion
    axes: CarAxes

    @cached_property
    def table(self) -> Table:
        return Table.of(self.plan, self.mechanism.topology)

    def room(self, count: int) -> Array:
        """An empty table for `count` instants, (..., height, N)."""
        return np.empty((*self.mechanism.drawn.shape[:-1], self.table.height, count))

    def laws(self, times: Array) -> Laws:
        """The laws of the inputs that move the chassis, at instants.

        Raises:
            InputOutOfRange: a value, a rate or an acceleration is too large to be added to a position.
        """
        chassis = self.chassis
        return {name: list(chassis.law(name, times, self.plan.derivative)) for name in chassis.functions}

    def states(self, rows: Array) -> list[dict[str, Array]]:
        """The states that are reported or needed, by time derivative, to be filled in.

        Reported states are views of the table, the others are in an array of their own. The states of chassis
        points, which are constant in the chassis' frame, are already filled in.
        """
        table, drawn = self.table, self.mechanism.drawn_places
        spare = np.empty((*rows.shape[:-2], 3 * len(table.spare), rows.shape[-1]))
        found: list[dict[str, Array]] = [{} for _ in range(self.plan.derivative + 1)]
        for (order, name), first in table.states.items():
            found[order][name] = vectors(rows, first)
        for i, (order, name) in enumerate(table.spare):
            found[order][name] = vectors(spare, 3 * i)
        for order, states in enumerate(found):
            for name in states.keys() & self.mechanism.topology.chassis:
                states[name][...] = drawn[name][..., None, :] if order == 0 else 0.0
        return found

    def complete(
        self, laws: Laws, states: States, rows: Array, y: Array | None = None, *, add: bool = True
    ) -> None:
        """Compute the numbers of the effects from states, then add origin and displacement to the states.

        Args:
            laws: laws of the inputs that move the chassis.
            states: states of the points. Reported states also have rows in the table and may be views of it.
            rows: a table or some columns of one, shape (..., height, N).
            y: the coordinates, (..., N, size), if an effect takes derivatives by an input.
            add: whether to add the origin and the displacement of the chassis.
        """
        in_chassis, slopes = states, {} if y is None else self.slopes(laws, y)
        if not self.chassis.centres.keys().isdisjoint(laws):
            # The states may be views of the table, and the states of the rotated car overwrite the table.
            in_chassis = [{name: state.copy() for name, state in of.items()} for of in states[:2]]
            states = self.chassis.turned_by(laws, states)
            for (derivative, point), first in self.table.states.items():
                vectors(rows, first)[...] = states[derivative][point]
        poses = Poses(self.mechanism, self.axes, states, in_chassis, slopes)
        for effect in self.table.computed:
            for quantity, arrays in effect.evaluate(poses).items():
                for name, array in arrays.items():
                    self.table.put(rows, quantity, name, array)
        if add:
            self.add(laws, rows)

    def add(self, laws: Laws, rows: Array) -> None:
        """Add the user's origin and the displacement of the chassis to the reported states in a table."""
        shifts, origin = self.chassis.shifts(laws), self.mechanism.origin[..., None, :]
        for derivative in self.table.reported:
            if shifts:
                self.table.add(rows, derivative, shifts[derivative] + (0.0 if derivative else origin))
            elif derivative == 0 and origin.any():
                self.table.add(rows, derivative, origin)

    def slopes(self, laws: Laws, y: Array) -> Slopes:
        """Derivatives of positions along each way, by way, after and before the rotations of the chassis."""
        ways = self.plan.ways(self.mechanism.topology)
        places, every = moved_along(self.mechanism, y, ways)
        return {
            way: (self.chassis.turned_by(alone(laws, way), [places, slopes])[1], slopes)
            for way, slopes in zip(ways, every, strict=True)
        }


def alone(laws: Laws, way: Way) -> dict[str, list[Array]]:
    """Laws in which the input of a way moves at unit rate and the other inputs are held."""
    driven = way.input if isinstance(way, ByInput) else ""
    return {name: [law[0], np.full_like(law[0], float(name == driven))] for name, law in laws.items()}
