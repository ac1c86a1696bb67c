"""Rates by finite differences: their velocity is what their positions change by from instant to instant.

With h the time between two instants: forward (x_{k+1} - x_k) / h, backward (x_k - x_{k-1}) / h, central the
mean of both, and for accelerations also (x_{k+1} - 2 x_k + x_{k-1}) / h^2. At the ends, where the rule has no
neighbour, it is one-sided, or the neighbour's number is repeated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, Kind, WouldBe

Array = NDArray[np.float64]
Rule = Callable[[Array, Array], Array]


def _forward(x: Array, t: Array) -> Array:
    steps = np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))
    return np.concatenate([steps, steps[-1:]])


def _backward(x: Array, t: Array) -> Array:
    steps = np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))
    return np.concatenate([steps[:1], steps])


def _central(x: Array, t: Array) -> Array:
    return np.asarray(np.gradient(x, t, axis=0))


def _central_second_order(x: Array, t: Array) -> Array:
    return np.asarray(np.gradient(x, t, axis=0, edge_order=2))


def _repeated(x: Array, t: Array) -> Array:
    inner = _central(x, t)[1:-1]
    return np.concatenate([inner[:1], inner, inner[-1:]])


def _second(x: Array, t: Array) -> Array:
    steps = np.diff(x, axis=0) / np.diff(t).reshape(-1, *[1] * (x.ndim - 1))
    between = 0.5 * (t[2:] - t[:-2]).reshape(-1, *[1] * (x.ndim - 1))
    inner = np.diff(steps, axis=0) / between
    return np.concatenate([inner[:1], inner, inner[-1:]])


RULES: Mapping[str, Rule] = {
    "central differences": _central,
    "central differences, of second order at the ends too": _central_second_order,
    "central differences, repeated at the ends": _repeated,
    "forward differences": _forward,
    "backward differences": _backward,
}


class Differences(Kind):
    """Of the numbers of one or two orders below, as given; of ours where they are not given."""

    name, of_time, reach = "differences", True, 2
    of_wrong = False
    """Of numbers that disagree themselves, or of others: those of a wrong car are as good as its rates."""

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Each rule, of all rates that disagree."""
        if len(evidence.times) < 4 or not (np.diff(evidence.times) > 0.0).all():
            return
        for words, rule in RULES.items():
            for below in (1, 2):
                rows: dict[Row, WouldBe] = {}
                for row in evidence.wrong:
                    source = self._source(row, below, evidence)
                    if source is not None:
                        rows[row] = self._twice(evidence, row, source, rule, below)
                if rows:
                    said = f"rates by {words}" + (", taken twice" if below == 2 else "")
                    yield Hypothesis(self.name, (words, below), said, rows)
        rows = {}
        for row in evidence.wrong:
            source = self._source(row, 2, evidence)
            if source is not None:
                rows[row] = self._once(evidence, row, source, _second, 2)
        if rows:
            yield Hypothesis(self.name, "second", "rates by second differences of positions", rows)

    def _source(self, row: Row, below: int, evidence: Evidence) -> Row | None:
        """The row that a row is so many time derivatives of."""
        for quantity in QUANTITIES:
            other = (quantity, row[1])
            alike = kind_of(other) == kind_of(row) and length_or_angle(other) == length_or_angle(row)
            if alike and order(other) == order(row) - below and other in evidence.given:
                return other if (other in evidence.wrong) == self.of_wrong else None
        return None

    def _twice(self, evidence: Evidence, row: Row, source: Row, rule: Rule, times: int) -> WouldBe:
        return self._once(
            evidence, row, source, rule if times == 1 else lambda x, t: rule(rule(x, t), t), times
        )

    @staticmethod
    def _once(evidence: Evidence, row: Row, source: Row, rule: Rule, times: int) -> WouldBe:
        numbers, instants = evidence.given[source], evidence.times
        value, step = rule(numbers, instants), float(np.diff(instants).min())
        # What is subtracted is rounded once in the numbers, and so are the instants.
        latest = float(np.abs(evidence.scene.instants).max())
        late = latest / step * float(np.abs(value).max(initial=0.0))
        rounding = 16.0 * EPS * (float(np.abs(numbers).max()) / step**times + late)
        return value, evidence.rounded(row) + rounding


KIND = Differences()
