"""Static angles that a file prints of its own drawing, held to those of the drawing as it was read.

Names that are mistaken, a side or an axis turned round show here as angles that are off.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from math import degrees

from pointcoord.linkage.topology import Topology
from validate.hardpoint_files.contents import Place, Printed


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
    printed: Mapping[str, Printed],
    drawn: Mapping[str, float],
    places: Mapping[str, Place],
    unit: Decimal,
    topology: Topology,
) -> tuple[AngleCheck, ...]:
    """Each angle that the file prints and the drawing has.

    Args:
        patterns: of the file's words, for our names. drawn: our angles, rad.
        places: as printed, in `unit` mm.
    """
    open_by_points = degrees(_left_open(places, unit, topology))
    return tuple(
        AngleCheck(
            name,
            words,
            value.line,
            float(value.value),
            degrees(drawn[name]),
            _half_a_digit(value.value) + open_by_points,
        )
        for name, pattern in patterns.items()
        for words, value in printed.items()
        if name in drawn and re.match(pattern, words)
    )


def _left_open(places: Mapping[str, Place], unit: Decimal, topology: Topology) -> float:
    """How far the printed digits of the points leave the direction of an axis of the wheel open, rad.

    Half a digit h in both coordinates of both ends moves them apart by 2 sqrt(2) h in the plane of an angle,
    where an axis within 45 deg of the plane is seen at least 1 / sqrt(2) of its length L long: 4 h / L.
    """
    largest = 0.0
    for ends in (topology.wheel_axis, topology.steering_axis):
        if ends and all(name in places for name in ends):
            one, other = (places[name] for name in ends)
            length = sum(float(a - b) ** 2 for a, b in zip(one, other, strict=True)) ** 0.5
            half = max(_half_a_digit(number) for number in (*one, *other))
            largest = max(largest, 4.0 * half / length if length else 0.0)
    return largest


def _half_a_digit(number: Decimal) -> float:
    return 0.5 * 10.0 ** int(number.as_tuple().exponent)
