"""Rates by finite differences.

A velocity is then what positions change by from instant to instant. With h the time between two instants:
forward (x_{k+1} - x_k) / h, backward (x_k - x_{k-1}) / h, central the mean of both, and for
accelerations also (x_{k+1} - 2 x_k + x_{k-1}) / h^2. At the ends, where the rule has no neighbour, it is
one-sided, or the neighbour's number is repeated, or a zero stands for it. Differences of numbers that
disagree themselves explain nothing: any car's rates are nearly differences of its positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, WouldBe

Array = NDArray[np.float64]
Rule = Callable[[Array, Array], Array]


def _steps(x: Array, t: Array) -> Array:
    return np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))


def _central(x: Array, t: Array, ends: Literal[1, 2] = 1) -> Array:
    return np.asarray(np.gradient(x, t, axis=0, edge_order=ends))


def _inner(x: Array, t: Array) -> Array:
    return _central(x, t)[1:-1]


def _padded(rule: Rule, before: int, after: int, mode: Literal["edge", "constant"] = "edge") -> Rule:
    def padded(x: Array, t: Array) -> Array:
        return np.pad(rule(x, t), [(before, after), *[(0, 0)] * (x.ndim - 1)], mode=mode)

    return padded


def _twice(rule: Rule) -> Rule:
    return lambda x, t: rule(rule(x, t), t)


ONCE: dict[str, Rule] = {
    "central differences": _central,
    "central differences, of second order at the ends too": lambda x, t: _central(x, t, 2),
    "central differences, repeated at the ends": _padded(_inner, 1, 1),
    "forward differences": _padded(_steps, 0, 1),
    "backward differences": _padded(_steps, 1, 0),
    "central differences, zero at the ends": _padded(_inner, 1, 1, "constant"),
    "forward differences, zero in the last row": _padded(_steps, 0, 1, "constant"),
    "backward differences, zero in the first row": _padded(_steps, 1, 0, "constant"),
}
RULES: list[tuple[str, Rule, int]] = [
    *((words, rule, 1) for words, rule in ONCE.items()),
    *((f"{words}, taken twice", _twice(rule), 2) for words, rule in ONCE.items()),
    (
        "second differences of positions",
        _padded(lambda x, t: _steps(_steps(x, t), 0.5 * (t[1:] + t[:-1])), 1, 1),
        2,
    ),
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
