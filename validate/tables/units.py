"""Converts units of files to ours: mm, s, rad, N and %, also divided by times, lengths and angles."""

from __future__ import annotations

import math
import re
from decimal import Decimal

# Decimal numbers, so that a metre is exactly 1000 mm and not 1000.0000000000001.
LENGTHS = {
    "mm": Decimal(1),
    "cm": Decimal(10),
    "m": Decimal(1000),
    "um": Decimal("0.001"),
    "in": Decimal("25.4"),
    "ft": Decimal("304.8"),
}
SPELT = {
    **dict.fromkeys(("inch", "inches"), "in"),
    **dict.fromkeys(("metre", "meter", "metres", "meters"), "m"),
    **dict.fromkeys(("millimetre", "millimeter", "millimetres", "millimeters"), "mm"),
    **dict.fromkeys(("centimetre", "centimeter", "centimetres", "centimeters"), "cm"),
    **dict.fromkeys(("foot", "feet"), "ft"),
}
"""Other spellings of units of length."""
ANGLES = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": math.pi / 180.0,
    "degree": math.pi / 180.0,
    "degrees": math.pi / 180.0,
    "\N{DEGREE SIGN}": math.pi / 180.0,
    "arcmin": math.pi / 10800.0,
}
TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0}
FORCES = {"N": 1.0, "kN": 1000.0, "lbf": 4.4482216152605}
KINDS = {
    "mm": {name: float(size) for name, size in LENGTHS.items()},
    "rad": ANGLES,
    "s": TIMES,
    "N": FORCES,
    "%": {"%": 1.0},
}
_PARTS = re.compile(r"([^/]+)(?:/([^/^*]+?)(?:\^|\*\*)?([1-9][0-9]?)?)?")


def length_called(word: str) -> str:
    """The unit of length that a word names; empty if it names none.

    >>> length_called("Metres"), length_called("deg")
    ('m', '')
    """
    name = SPELT.get(word.lower(), word.lower())
    return name if name in LENGTHS else ""


def factor_of(unit: str, ours: str) -> float | None:
    """A file's unit in multiples of our unit; None if it is not a unit of the same kind.

    >>> factor_of("m/s^2", "mm/s^2"), factor_of("deg", "mm")
    (1000.0, None)
    """
    theirs, own = _taken_apart(unit), _taken_apart(ours)
    if theirs is None or own is None or theirs[1:] != own[1:]:
        return None
    return theirs[0] / own[0]


def named(factor: float, ours: str) -> str:
    """The name of the unit that is `factor` times ours; empty if there is none.

    >>> named(1000.0, "mm/s"), named(0.3, "mm")
    ('m/s', '')
    """
    above, slash, below = ours.partition("/")
    under = KINDS.get(below, [below])
    units = (f"{unit}{slash}{per}" for per in under for unit in KINDS[above])
    return next((unit for unit in units if math.isclose(factor_of(unit, ours) or 0.0, factor)), "")


def degrees_of(unit: str) -> tuple[float, str]:
    """The factor that converts a number to degrees, and the converted unit; 1 if the unit has no rad.

    >>> degrees_of("rad/s")[1], degrees_of("mm/rad")[1]
    ('deg/s', 'mm/deg')
    """
    above, slash, below = unit.partition("/")
    if above == "rad":
        return math.degrees(1.0), f"deg{slash}{below}"
    return (math.radians(1.0), f"{above}/deg") if below == "rad" else (1.0, unit)


def is_unit(text: str) -> bool:
    """Whether a text is a unit of any kind."""
    return _taken_apart(text) is not None


def allowed_units(ours: str) -> str:
    """The units that can be converted to one of ours, in words."""
    base, slash, below = ours.partition("/")
    return ", ".join(f"{unit}{slash}{below}" for unit in KINDS[base])


def _taken_apart(unit: str) -> tuple[float, str, str, int] | None:
    """The size of a unit in ours, the kinds of its numerator and denominator, and the power of the latter."""
    text = unit.strip().replace(" ", "")
    text = text.replace("\N{SUPERSCRIPT TWO}", "^2").replace("\N{SUPERSCRIPT THREE}", "^3")
    found = _PARTS.fullmatch(text)
    if found is None:
        return None
    above, below, power = found.group(1), found.group(2), found.group(3)
    above, below = SPELT.get(above, above), SPELT.get(below, below)
    kind = next((kind for kind, units in KINDS.items() if above in units), None)
    under = next((kind for kind, units in KINDS.items() if below in units), "")
    times = 0 if below is None else int(power or 1)
    # Only times may have a power.
    if kind is None or (below is not None and not under) or (times > 1 and under != "s"):
        return None
    size = KINDS[kind][above] / (KINDS[under][below] ** times if below is not None else 1.0)
    return size, kind, under, times
