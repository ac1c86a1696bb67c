"""Rates per input instead of per time: dx/dq = x' / q', d2x/dq2 = (x'' - dx/dq q'') / q'^2."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, Kind, WouldBe
from validate.formulations.input_rates import rates


class PerInput(Kind):
    """Where one input moves and never stops: with more, a rate has more than one part."""

    name, opens, of_time, reach = "per input", True, True, 0

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Of the one input that moves."""
        laws = {name: rates(law, evidence.times) for name, law in evidence.scene.inputs.items()}
        moving = {name: law for name, law in laws.items() if np.abs(law[:, 1:]).max(initial=0.0) > 0.0}
        if len(moving) != 1:
            return
        ((name, law),) = moving.items()
        speed, bend = law[:, 1, None], law[:, 2, None]
        if np.abs(speed).min() <= 1e-6 * np.abs(speed).max():
            return
        rows: dict[Row, WouldBe] = {}
        for row in evidence.wrong:
            if order(row) == 1:
                rows[row] = (evidence.held[row] / speed, evidence.rounded(row) / np.abs(speed))
            rate = self._rate(row, evidence)
            if order(row) == 2 and rate is not None:
                per = evidence.held[rate] / speed
                width = evidence.rounded(row) + evidence.rounded(rate) * np.abs(bend / speed)
                rows[row] = ((evidence.held[row] - per * bend) / speed**2, width / speed**2)
        if rows:
            yield Hypothesis(self.name, name, f"rates per {name}, not per time", rows)

    @staticmethod
    def _rate(row: Row, evidence: Evidence) -> Row | None:
        for quantity in QUANTITIES:
            other = (quantity, row[1])
            alike = kind_of(other) == kind_of(row) and length_or_angle(other) == length_or_angle(row)
            if alike and order(other) == 1 and other in evidence.held:
                return other
        return None


KIND = PerInput()
