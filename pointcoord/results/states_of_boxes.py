r"""States of the points of many designs, from boxes of series in their inputs.

With s = (input - centre) / half width the powers of a box are functions of time that all designs share,

    phi = s1^i s2^j,    d(s^i)/dt = i s^(i-1) s',    d2(s^i)/dt2 = i (i - 1) s^(i-2) s'^2 + i s^(i-1) s'',

so one matrix product for each coordinate and derivative sums all designs, where they belong in their tables.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.results.carried_states import CARRIED, carry, summed_and_carried
from pointcoord.results.readout import Readout
from pointcoord.results.states import standing
from pointcoord.results.table import State, vectors
from pointcoord.solve.designs_by_inputs import Box, Boxes
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Jet = tuple[Array, ...]
"""A function of time and its first derivatives, as many as are wanted."""


@dataclass(frozen=True)
class _Piece:
    """Instants that follow each other in one box.

    Attributes:
        powers: of each group of the box, and by derivative, shape (terms, instants).
    """

    box: Box
    part: slice
    powers: tuple[Jet, ...]


@dataclass(frozen=True)
class StatesOfBoxes:
    """States summed from boxes that designs share, (designs, N, 3).

    Attributes:
        functions: the laws of the inputs.
    """

    readout: Readout
    functions: Mapping[str, TimeFunction]
    boxes: Boxes

    def states(self, instants: Array, rows: Array) -> list[dict[str, Array]]:
        """By time derivative, the states of the points that the plan asks for.

        Args:
            instants: shape (N,). rows: a table of results, shape (designs, height, N); the states that are
                reported are put into their places, and those that are returned may be views of them.
        """
        table, mechanism = self.readout.table, self.readout.mechanism
        batch, count = len(rows), len(instants)
        still = standing(mechanism, table.still).reshape(batch, -1, 1)
        found = {state: rows[:, first : first + 3, :] for first, state in table.states}
        solved, carried = summed_and_carried(self.readout)
        spare = [state for state in (*solved, *carried) if state not in found]
        room = np.empty((batch, 3 * len(spare), count))
        found |= {state: room[:, 3 * i : 3 * i + 3, :] for i, state in enumerate(spare)}
        pieces = self._pieces(instants, max((order for order, _ in solved), default=0))
        for low in range(0, batch, CARRIED):
            part = slice(low, low + CARRIED)
            here = {state: place[part] for state, place in found.items()}
            rows[part, table.first_still :, :] = still[part]
            for piece in pieces:
                self._sum(piece, part, {state: here[state] for state in solved})
            carry(mechanism, part, carried, here)
        states: list[dict[str, Array]] = [{} for _ in range(self.readout.plan.derivative + 1)]
        for (order, name), place in found.items():
            states[order][name] = vectors(place, 0)
        spare_still = standing(mechanism, table.spare_still)
        for i, (order, name) in enumerate(table.spare_still):
            states[order][name] = np.broadcast_to(spare_still[:, i, None, :], (batch, count, 3))
        return states

    def _pieces(self, instants: Array, derivatives: int) -> list[_Piece]:
        series = [self.functions[name].series(instants, derivatives) for name in self.boxes.names]
        numbers = self.boxes.numbers_of(np.stack([each[..., 0] for each in series], axis=-1))
        edges = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), len(instants)]
        found = []
        for low, high in pairwise(edges):
            part, box = slice(low, high), self.boxes.boxes[int(numbers[low])]
            jets = []
            for each, centre, half in zip(series, box.centre, box.half, strict=True):
                own = each[part]
                rest = ((1.0, 2.0)[k - 1] * own[:, k] / half for k in range(1, derivatives + 1))
                jets.append(_powers(((own[:, 0] - centre) / half, *rest), box.degree))
            powers = []
            for group in box.groups:
                chosen = [
                    tuple(part[places] for part in jet)
                    for jet, places in zip(jets, group.powers.T, strict=True)
                ]
                powers.append(chosen[0] if len(chosen) == 1 else _product(chosen[0], chosen[1]))
            found.append(_Piece(box, part, tuple(powers)))
        return found

    def _sum(self, piece: _Piece, part: slice, wanted: Mapping[State, Array]) -> None:
        """Sum some designs at the instants of a piece, each into (designs, 3, N), mm."""
        layout, unit = self.readout.mechanism.layout, self.readout.mechanism.unit[part, None]
        owner = {
            coordinate: (number, place)
            for number, group in enumerate(piece.box.groups)
            for place, coordinate in enumerate(group.coordinates.tolist())
        }
        series: dict[int, Array] = {}
        for (order, name), place in wanted.items():
            for axis, coordinate in enumerate(layout.vector(name)):
                number, own = owner[coordinate]
                if coordinate not in series:
                    series[coordinate] = piece.box.groups[number].series[own, :, part].T * unit
                np.matmul(series[coordinate], piece.powers[number][order], out=place[:, axis, piece.part])


def _powers(s: Jet, degree: int) -> Jet:
    """s^0, s^1, ... and their derivatives, each (degree + 1, N)."""
    powers = np.ones((degree + 1, len(s[0])))
    for power in range(1, degree + 1):
        np.multiply(powers[power - 1], s[0], out=powers[power])
    found = [powers]
    k = np.arange(1.0, degree + 1)[:, None]
    if len(s) > 1:
        slope = np.zeros_like(powers)
        slope[1:] = k * powers[:-1]
        found.append(slope * s[1])
    if len(s) > 2:
        bend = np.zeros_like(powers)
        bend[1:] = k * slope[:-1]
        found.append(bend * s[1] ** 2 + slope * s[2])
    return tuple(found)


def _product(one: Jet, other: Jet) -> Jet:
    """The product of two functions, with its derivatives."""
    found = [one[0] * other[0]]
    if len(one) > 1:
        found.append(one[1] * other[0] + one[0] * other[1])
    if len(one) > 2:
        found.append(one[2] * other[0] + 2.0 * one[1] * other[1] + one[0] * other[2])
    return tuple(found)
