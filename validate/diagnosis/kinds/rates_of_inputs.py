"""Rates of inputs that are taken otherwise than they are given, where places are right.

The rates of the inputs x make all others: v = J x' and a = J x'' + x' H x'. The car's map gives J and H at
every pose, with proven bounds; x' and x'' are supposed with the other sign and as 0, of one input and of all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pointcoord import KinematicMap, kinematic_map
from pointcoord.effects.registry import QUANTITIES
from validate.diagnosis.evidence import Evidence, Row, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.formulations.asked_numbers import per_second
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]

_OF_POINTS = {per_second(quantity): of.words for quantity, of in QUANTITIES.items() if of.of == "point"}
RATES: Mapping[tuple[int, ...], str] = {(1,): _OF_POINTS[1], (2,): _OF_POINTS[2], (1, 2): "rates"}
TAKEN: Mapping[float, str] = {-1.0: "with the other sign", 0.0: "as 0"}
FEW = 16  # instants that each is tried at first
# What may be left of the difference there, of numbers that are explained to rounding.
PROMISING = 0.1


class RatesOfInputs(Kind):
    """Of each input and of all, each rate and both."""

    name, solves, first, in_place, of_time = "rates of inputs", True, True, True, True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """None where a place is wrong, or no rate of a point or body is."""
        moving = [row for row in evidence.wrong if order(row) > 0 and kind_of(row) != "car"]
        if not moving or any(order(row) == 0 for row in evidence.wrong):
            return
        laws = {name: rates(law, evidence.times) for name, law in evidence.scene.inputs.items()}
        names = [name for name, law in laws.items() if law[:, 1:].any()]
        scene = evidence.scene.model_copy(update={"points": None})
        driving = [name for name in laws if name not in scene.mechanism.topology.chassis_inputs]
        map = kinematic_map(
            scene, {name: (float(laws[name][:, 0].min()), float(laws[name][:, 0].max())) for name in driving}
        )
        some = np.unique(np.linspace(0, len(evidence.times) - 1, FEW).astype(np.intp))
        few = evidence.at(some.tolist())
        apart = _apart(few, moving, {row: few.held[row] for row in moving})
        groups = [*((name,) for name in names), *([tuple(names)] if len(names) > 1 else [])]
        for group, orders, factor in product(groups, RATES, TAKEN):
            other = {name: law.copy() for name, law in laws.items()}
            for name, d in product(group, orders):
                other[name][:, d] *= factor
            tried = _numbers(map, {name: law[some] for name, law in other.items()}, moving, bounds=False)
            if len(tried) < len(moving):
                continue
            left = _apart(few, moving, {row: value for row, (value, _) in tried.items()})
            if any(not left[quantity] <= PROMISING * apart[quantity] for quantity in apart):
                continue
            numbers = _numbers(map, other, [*evidence.held], bounds=True)
            rows = {
                row: (value, 2.0 * (evidence.rounded(row, value) + bound))
                for row, (value, bound) in numbers.items()
            }
            which = "all inputs" if len(group) > 1 else f"the input {group[0]}"
            words = f"the {RATES[orders]} of {which} taken {TAKEN[factor]}"
            # The most that is wrong at once is the most far-fetched.
            cost = 1.0 + 0.1 * len(group) * len(orders)
            yield Hypothesis(self.name, (group, orders, factor), words, rows, cost=cost, whole=True)


def _apart(evidence: Evidence, rows: list[Row], numbers: Mapping[Row, Array]) -> dict[str, float]:
    """The largest difference of given numbers from others, by quantity."""
    found: dict[str, float] = {}
    for row in rows:
        gap = float(np.abs(evidence.given[row] - numbers[row]).max())
        found[row[0]] = np.inf if np.isnan(gap) else max(found.get(row[0], 0.0), gap)
    return found


def _numbers(
    map: KinematicMap, laws: Mapping[str, Array], rows: list[Row], *, bounds: bool
) -> dict[Row, tuple[Array, Array]]:
    """Numbers of rows by inputs and their rates, (N, 3) each, and how far off they are."""
    places, first, second = (
        {name: law[:, d] for name, law in laws.items() if _taken(map, name)} for d in range(3)
    )
    poses = map(places, first, second, bounds)
    found: dict[Row, tuple[Array, Array]] = {}
    for row in rows:
        quantity, of = row
        channel = poses.numbers.get(quantity)
        if channel is not None and channel.computed and of in channel:
            value = np.array(channel[of])
            off = poses.bounds[quantity][of] if bounds else np.zeros_like(value)
            found[row] = (value, np.nan_to_num(off, posinf=0.0))
    return found


def _taken(map: KinematicMap, name: str) -> bool:
    """Whether the map takes an input: one that drives it and is not held, or one that moves the chassis."""
    return name in map.inputs or name not in map.ranges


KIND = RatesOfInputs()
