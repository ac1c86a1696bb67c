"""Compares static angles printed in a file with those of the imported drawing.

A misread name, a wrong side or a reversed axis shows as a difference of angles.
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
        name: our name of the angle.
        words, line: its name in the file, and the line.
        printed: the value in the file.
        drawn: the value of the imported drawing.
        tolerance: from the printed digits of the angle and of the points.
    """

    name: str
    words: str
    line: int
    printed: float
    drawn: float
    tolerance: float

    @property
    def verdict(self) -> str:
        """`agrees` or `disagrees`."""
        return "agrees" if abs(self.printed - self.drawn) <= self.tolerance else "disagrees"


def check_angles(
    patterns: Mapping[str, str],
    printed: Mapping[str, tuple[Decimal, int]],
    places: Mapping[str, Place],
    topology: Topology,
    drawn: Mapping[str, float],
) -> Iterator[AngleCheck]:
    """The check of each angle that the file prints and the drawing has.

    The digits of the points limit the accuracy of an axis. Half a digit h in both coordinates of both ends
    moves them apart by 2 sqrt(2) h in the plane of an angle. An axis of length L within 45 deg of this plane
    has a projected length of at least L / sqrt(2). So the angle changes by at most 4 h / L.

    Args:
        patterns: patterns of the file's names, by our names.
        printed: printed angles with their lines, by the file's names, deg.
        places: positions of the points in the file.
        drawn: angles of the drawing, rad.
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
