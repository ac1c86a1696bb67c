"""Numbers in another's place: two points or angles, or two quantities such as velocity and acceleration."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

from pointcoord.effects.registry import QUANTITIES
from validate.diagnosis.evidence import Evidence
from validate.diagnosis.hypothesis import Hypothesis, Kind


class Swapped(Kind):
    """Both ways, or one of them only."""

    name, reach = "swapped", 0

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Names first, in all quantities together; then quantities."""
        names = tuple(dict.fromkeys(row[1] for row in evidence.wrong))
        others = tuple(dict.fromkeys(row[1] for row in evidence.held))
        for name in names:
            for other in others:
                if name == other or (other in names and other < name):
                    continue
                rows = {
                    (quantity, one): (evidence.held[quantity, two], evidence.allowed[quantity, two])
                    for quantity, one in evidence.wrong
                    for two in ((other,) if one == name else (name,) if one == other else ())
                    if (quantity, two) in evidence.held
                }
                if rows:
                    yield Hypothesis(
                        self.name, (name, other), f"{name} is swapped with {other}", rows, cost=1.5
                    )
        for one, two in permutations(evidence.wrong_quantities, 2):
            if QUANTITIES[one].of == QUANTITIES[two].of and one < two:
                rows = {
                    row: (evidence.held[other, row[1]], evidence.allowed[other, row[1]])
                    for row in evidence.wrong
                    for other in ((two,) if row[0] == one else (one,) if row[0] == two else ())
                    if (other, row[1]) in evidence.held
                }
                words = f"{QUANTITIES[one].words} is swapped with {QUANTITIES[two].words}"
                yield Hypothesis(self.name, (one, two), words, rows, cost=1.1)


KIND = Swapped()
