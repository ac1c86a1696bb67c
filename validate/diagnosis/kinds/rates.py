"""Rates by finite differences, or by an input instead of by time.

A velocity is then what positions change by from instant to instant. With h the time between two instants:
forward (x_{k+1} - x_k) / h, backward (x_k - x_{k-1}) / h, central the mean of both, and for
accelerations also (x_{k+1} - 2 x_k + x_{k-1}) / h^2. At the ends, where the rule has no neighbour, it is
one-sided, or the neighbour's number is repeated, or a zero stands for it. Differences of numbers that
disagree themselves explain nothing: any car's rates are nearly differences of its positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, WouldBe
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]
Rule = Callable[[Array, Array], Array]


def _steps(x: Array, t: Array) -> Array:
    return np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))


def _inner(x: Array, t: Array) -> Array:
    return np.asarray(np.gradient(x, t, axis=0)[1:-1])


def _second(x: Array, t: Array) -> Array:
    return _steps(_steps(x, t), 0.5 * (t[1:] + t[:-1]))


def _padded(rule: Rule, before: int, after: int, zero: bool, x: Array, t: Array) -> Array:
    ends = [(before, after), *[(0, 0)] * (x.ndim - 1)]
    return np.pad(rule(x, t), ends) if zero else np.pad(rule(x, t), ends, mode="edge")


def _twice(rule: Rule, x: Array, t: Array) -> Array:
    return rule(rule(x, t), t)


ONCE: dict[str, Rule] = {
    "central differences": lambda x, t: np.asarray(np.gradient(x, t, axis=0)),
    "central differences, of second order at the ends too": lambda x, t: np.asarray(
        np.gradient(x, t, axis=0, edge_order=2)
    ),
    "central differences, repeated at the ends": partial(_padded, _inner, 1, 1, False),
    "central differences, zero at the ends": partial(_padded, _inner, 1, 1, True),
    "forward differences": partial(_padded, _steps, 0, 1, False),
    "forward differences, zero in the last row": partial(_padded, _steps, 0, 1, True),
    "backward differences": partial(_padded, _steps, 1, 0, False),
    "backward differences, zero in the first row": partial(_padded, _steps, 1, 0, True),
}
RULES: list[tuple[str, Rule, int]] = [
    *((words, rule, 1) for words, rule in ONCE.items()),
    *((f"{words}, taken twice", partial(_twice, rule), 2) for words, rule in ONCE.items()),
    ("second differences of positions", partial(_padded, _second, 1, 1, False), 2),
    ("second differences of positions, zero at the ends", partial(_padded, _second, 1, 1, True), 2),
]
"""In words, and which derivative each makes."""


def _integral(row: Row, below: int, evidence: Evidence) -> Row | None:
    """The row that a row is so many time derivatives of."""
    for quantity in QUANTITIES:
        other = (quantity, row[1])
        alike = kind_of(other) == kind_of(row) and length_or_angle(other) == length_or_angle(row)
        if alike and order(other) == order(row) - below and other in evidence.given:
            return other
    return None


def differences(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each rule, of all rates that disagree, by the given numbers of one or two orders below that agree."""
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
            # What is subtracted is rounded once in the numbers, and so are the instants.
            late = latest / step * float(np.abs(value).max(initial=0.0))
            rounding = 16.0 * EPS * (float(np.abs(numbers).max()) / step**below + late)
            rows[row] = value, evidence.rounded(row) + rounding
        if rows:
            yield Hypothesis(words, f"rates by {words}", rows)


def per_input(evidence: Evidence) -> Iterator[Hypothesis]:
    """With s the rate of an input that never rests: v / s for v, and (a - v s' / s) / s^2 for a."""
    units = evidence.scene.mechanism.topology.input_units
    for name, law in evidence.scene.inputs.items():
        _, rate, change = rates(law, evidence.times).T
        if not rate.all() or (rate == 1.0).all():
            continue
        rows: dict[Row, WouldBe] = {}
        for row in evidence.wrong:
            below, by = _integral(row, 1, evidence), rate.reshape(-1, *[1] * (evidence.held[row].ndim - 1))
            if order(row) == 1:
                value = evidence.held[row] / by
            elif order(row) == 2 and below is not None:
                value = (
                    evidence.held[row] - evidence.held[below] * (change / rate).reshape(by.shape)
                ) / by**2
            else:
                continue
            rows[row] = value, evidence.rounded(row) / np.abs(by) ** order(row)
        words = f"rates per {units[name]} of {name}, not per second"
        yield Hypothesis(name, words, rows, cost=1.1)
