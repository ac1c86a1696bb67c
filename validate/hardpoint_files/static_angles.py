"""Static angles that a file prints of its own drawing, held to those of the drawing as it was read.

Names that are mistaken, a side or an axis turned round show here as angles that are off.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from math import degrees, dist

from pointcoord.linkage.topology import Topology
from validate.hardpoint_files.contents import Place


@dataclass(frozen=True)
class AngleCheck:
    """One angle, deg.

    Attributes:
        name: ours. words, line: the file's. printed: by the file. drawn: of the drawing that was read.
        tolerance: what the printed digits of the angle and of the points leave open.
    """

    name: str
    words: str
    line: int
    printed: float
    drawn: float
    tolerance: float

    @property
    def verdict(self) -> str:
        """agrees or disagrees."""
        return "agrees" if abs(self.printed - self.drawn) <= self.tolerance else "disagrees"


def check_angles(
    patterns: Mapping[str, str],
    printed: Mapping[str, tuple[Decimal, int]],
    places: Mapping[str, Place],
    topology: Topology,
    drawn: Mapping[str, float],
) -> Iterator[AngleCheck]:
    """Each angle that the file prints and the drawing has.

    The digits of points leave the direction of an axis of the wheel open: half a digit h in both coordinates
    of both ends moves them apart by 2 sqrt(2) h in the plane of an angle, where an axis within 45 deg of the
    plane is seen at least 1 / sqrt(2) of its length L long: by 4 h / L.

    Args:
        patterns: of the file's words, for our names. places: as the file has them. drawn: our angles, rad.
    """
    axes = [
        ends for ends in map(topology.role, ("wheel_axis", "steering_axis")) if ends and {*ends} <= {*places}
    ]
    left_open = 0.0
    for one, other in ([places[name] for name in ends] for ends in axes):
        half = max(map(_half_a_digit, (*one, *other)))
        left_open = max(left_open, 4.0 * half / length if (length := dist(one, other)) else 0.0)
    for name, pattern in patterns.items():
        for words, (value, line) in printed.items():
            if name in drawn and re.match(pattern, words):
                off = _half_a_digit(value) + degrees(left_open)
                yield AngleCheck(name, words, line, float(value), degrees(drawn[name]), off)


def _half_a_digit(number: Decimal) -> float:
    return 0.5 * 10.0 ** int(number.as_tuple().exponent)
