"""The other sign and another unit, of angles by another definition: toe by arcsin, in degrees, + out."""

from __future__ import annotations

from collections.abc import Iterator

from validate.diagnosis.evidence import Evidence, kind_of
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.diagnosis.kinds.unit import KIND as UNIT


class SignAndUnit(Kind):
    """Both, after a definition only: in our own numbers they are a pair of faults by themselves."""

    name, closes, follows = "sign and unit", True, ("definition",)

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Each unit of angles, with the sign."""
        for one in UNIT.hypotheses(evidence):
            rows = {row: (-value, width) for row, (value, width) in one.rows.items() if kind_of(row) == "car"}
            if rows:
                words = f"the other sign, and {one.words}"
                yield Hypothesis(self.name, one.key, words, rows, cost=one.cost + 1.0)


KIND = SignAndUnit()
