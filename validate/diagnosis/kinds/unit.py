"""Another unit: degrees for radians, metres or inches for millimetres, milliseconds for seconds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

from validate.diagnosis.evidence import Evidence, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, Kind


@dataclass(frozen=True)
class Unit:
    """Another unit.

    Attributes:
        words: for what it was taken.
        of: mm, rad or s, which it stands for.
        factor: a number in our unit times this is the number in that one; per second of a rate for s.
        orders: of time derivatives of which it is in use.
    """

    words: str
    of: str
    factor: float
    orders: tuple[int, ...] = (0, 1, 2)


UNITS = (
    Unit("degrees for radians", "rad", 180.0 / pi),
    Unit("degrees taken for radians and converted once more", "rad", pi / 180.0),
    Unit("minutes of arc for radians", "rad", 60.0 * 180.0 / pi),
    Unit("turns for radians", "rad", 0.5 / pi),
    Unit("turns per minute for rad/s", "rad", 30.0 / pi, (1,)),
    Unit("m for mm", "mm", 1e-3),
    Unit("cm for mm", "mm", 1e-1),
    Unit("inches for mm", "mm", 1.0 / 25.4),
    Unit("mm taken for m and converted once more", "mm", 1e3),
    Unit("mm taken for inches and converted once more", "mm", 25.4),
    Unit("multiples of 9.80665 m/s^2 for mm/s^2", "mm", 1.0 / 9806.65, (2,)),
    Unit("per millisecond for per second", "s", 1e-3, (1, 2)),
    Unit("per minute for per second", "s", 60.0, (1, 2)),
)


class OtherUnit(Kind):
    """A factor that is known beforehand."""

    name, opens, closes, reach = "unit", True, True, 0

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """Each unit, of all rows that may have it."""
        for unit in UNITS:
            rows = {}
            for row in evidence.wrong if evidence.wants(unit.words) else ():
                if order(row) in unit.orders and unit.of in ("s", length_or_angle(row)):
                    factor = unit.factor ** order(row) if unit.of == "s" else unit.factor
                    rows[row] = (factor * evidence.held[row], factor * evidence.rounded(row))
            if rows:
                yield Hypothesis(self.name, unit.words, unit.words, rows)


KIND = OtherUnit()
