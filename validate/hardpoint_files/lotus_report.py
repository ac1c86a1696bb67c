"""Reads a text report of Lotus Suspension Analysis: a block of points for each axle, then static values.

A point is a line `X Y Z POINT ( number ) = name`. The tables of results that follow are not read.
"""

from __future__ import annotations

import re
from decimal import Decimal

from validate.hardpoint_files.contents import Contents, Point, number_of, place_of
from validate.tables.errors import FileError

_AXLE = re.compile(r"^\s*(FRONT|REAR)\s+SUSPENSION\b")
_TYPE = re.compile(r"^\s*TYPE\s+\d+\s+(.*\S)")
_UNIT = re.compile(r"^\s*\((\w+)\)\s+\(\1\)\s+\(\1\)\s*$")
_POINT = re.compile(r"^(.*?)\bPOINT\s*\(\s*\d+\s*\)\s*=?\s*(.*\S)")
_ANGLE = re.compile(r"^\s*(.*ANGLE.*?)\s*\(deg\)\s*:\s*(\S+)\s*$")


def read(text: str, source: str) -> Contents:
    """The points and static angles of a report.

    Raises:
        FileError: the line of a point is wrong, or there are no points.
    """
    points: list[Point] = []
    called: dict[str, str] = {}
    angles: dict[str, dict[str, tuple[Decimal, int]]] = {}
    part = unit = ""
    for line, words in enumerate(text.splitlines(), 1):
        if found := _AXLE.match(words):
            part = found[1].lower()
        elif found := _TYPE.match(words):
            called.setdefault(part, found[1])
        elif found := _UNIT.match(words):
            unit = unit or found[1]
        elif found := _POINT.match(words):
            place = place_of(found[1].split(), source, line, found[2])
            points.append(Point(found[2], place, f"{found[2]}, line {line}", part=part))
        elif found := _ANGLE.match(words):
            value = number_of(found[2], source, line, found[1])
            angles.setdefault(part, {}).setdefault(found[1], (value, line))
    if not points:
        like = "lines such as -110.00 257.00 69.00 POINT ( 1 ) = Lower wishbone front pivot"
        raise FileError(source, 0, "has no points", like)
    return Contents(points, unit=unit, called=called, angles=angles)
