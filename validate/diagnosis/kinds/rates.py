"""Faults of rates: finite differences, or rates with respect to an input instead of time.

With h the time between two instants, differences are forward (x_{k+1} - x_k) / h, backward (x_k - x_{k-1}) /
h, central (the mean of both), and for accelerations also (x_{k+1} - 2 x_k + x_{k-1}) / h^2. At the ends,
where a neighbour is missing, the rule is one-sided, or the neighbour's number is repeated, or zero is used.
Differences of numbers that disagree explain nothing: the rates of any car are nearly differences of its
positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, WouldBe
from validate.diagnosis.hypothesis import Hypothesis
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]
Rule = Callable[[Array, Array], Array]


def _steps(x: Array, t: Array) -> Array:
    return np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))


def _central(x: Array, t: Array, order: Literal[1, 2] = 1) -> Array:
    return np.asarray(np.gradient(x, t, axis=0, edge_order=order))


def _inner(x: Array, t: Array) -> Array:
    return _central(x, t)[1:-1]


def _second(x: Array, t: Array) -> Array:
    return _steps(_steps(x, t), 0.5 * (t[1:] + t[:-1]))


def _padded(rule: Rule, ends: tuple[int, int], mode: Literal["edge", "constant"]) -> Rule:
    """The rule with further rows before and after: the neighbour's numbers, or zeros."""
    return lambda x, t: np.pad(rule(x, t), [ends, *[(0, 0)] * (x.ndim - 1)], mode=mode)


def _twice(rule: Rule) -> Rule:
    return lambda x, t: rule(rule(x, t), t)


ONCE: dict[str, Rule] = {
    "central differences": _central,
    "central differences, of second order at the ends too": partial(_central, order=2),
    "central differences, repeated at the ends": _padded(_inner, (1, 1), "edge"),
    "central differences, zero at the ends": _padded(_inner, (1, 1), "constant"),
    "forward differences": _padded(_steps, (0, 1), "edge"),
    "forward differences, zero in the last row": _padded(_steps, (0, 1), "constant"),
    "backward differences": _padded(_steps, (1, 0), "edge"),
    "backward differences, zero in the first row": _padded(_steps, (1, 0), "constant"),
}
RULES: list[tuple[str, Rule, int]] = [
    *((words, rule, 1) for words, rule in ONCE.items()),
    *((f"{words}, taken twice", _twice(rule), 2) for words, rule in ONCE.items()),
    ("second differences of positions", _padded(_second, (1, 1), "edge"), 2),
    ("second differences of positions, zero at the ends", _padded(_second, (1, 1), "constant"), 2),
]
"""The rules: in words, the function, and the order of the derivative."""


def _integral(row: Row, below: int, evidence: Evidence) -> Row | None:
    """The row of which a row is the time derivative of order `below`; None if it is not given."""
    for quantity in QUANTITIES:
        other = Row(quantity, row.name)
        alike = other.of == row.of and other.unit == row.unit
        if alike and other.order == row.order - below and other in evidence.given:
            return other
    return None


def differences(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rule, for all rates that disagree, applied to given numbers of lower order that agree."""
    times = evidence.times
    if len(times) < 4 or not (np.diff(times) > 0.0).all():
        return
    step, latest = float(np.diff(times).min()), float(np.abs(evidence.scene.instants).max())
    for words, rule, below in RULES:
        rows: dict[Row, WouldBe] = {}
        for row in evidence.wrong:
            source = _integral(row, below, evidence)
            if source is None or source in evidence.wrong:
                continue
            numbers = evidence.given[source]
            value = rule(numbers, times)
            # The numbers and the instants are each rounded before they are subtracted.
            late = latest / step * float(np.abs(value).max(initial=0.0))
            rounding = 16.0 * EPS * (float(np.abs(numbers).max()) / step**below + late)
            rows[row] = value, evidence.rounded(row) + rounding
        yield Hypothesis(f"rates by {words}", rows)


def per_input(evidence: Evidence) -> Iterator[Hypothesis]:
    """Derivatives by an input with rate s, never zero: v / s for v, and (a - v s' / s) / s^2 for a."""
    units = evidence.scene.mechanism.topology.input_units
    rated = [row for row in evidence.wrong if row.order > 0]
    for name, law in evidence.scene.inputs.items() if rated else ():
        _, rate, change = rates(law, evidence.times).T
        if not rate.all() or (rate == 1.0).all():
            continue
        rows: dict[Row, WouldBe] = {}
        for row in rated:
            ones = [1] * (evidence.held[row].ndim - 1)
            by, bend = rate.reshape(-1, *ones), (change / rate).reshape(-1, *ones)
            below = _integral(row, 1, evidence)
            if row.order == 1:
                value = evidence.held[row] / by
            elif row.order == 2 and below is not None:
                value = (evidence.held[row] - evidence.held[below] * bend) / by**2
            else:
                continue
            rows[row] = value, evidence.rounded(row) / np.abs(by) ** row.order
        words = f"rates per {units[name]} of {name}, not per second"
        yield Hypothesis(words, rows, cost=1.1)
