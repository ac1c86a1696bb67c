"""Rates by finite differences of numbers that disagree themselves, where nothing else explains the rates.

Any car's rates are nearly differences of its positions: that they are near them explains nothing, and that
they are them exactly not why the positions are wrong.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from validate.diagnosis.evidence import Evidence
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.kinds.differences import Differences


class OfWrong(Differences):
    """The same rules."""

    name, last = "differences of wrong numbers", True
    of_wrong = True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Each rule, of all rates that disagree, beside whatever else is found."""
        for one in super().hypotheses(evidence):
            yield replace(one, aside=True)


KIND = OfWrong()
