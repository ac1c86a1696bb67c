"""Converts a scene in other units or axes to mm and directions.

The result is a plain scene in mm; all results are in mm. Angles and times have one unit only.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from pointcoord.mechanism.faults import TableFault
from pointcoord.scene.input_part import with_values
from pointcoord.scene.scene_part import own_list, own_number
from pointcoord.wording import shown

MM = "mm"
UNITS = {MM: 1.0, "m": 1000.0, "in": 25.4}
"""The units of length that a scene may be written in, in mm."""

AXES = {
    "rearward-right-up": {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)},
    "iso": {"up": (0.0, 0.0, 1.0), "right": (0.0, -1.0, 0.0)},
    "sae": {"up": (0.0, 0.0, -1.0), "right": (0.0, 1.0, 0.0)},
}
"""Named axes: the default; x forward, y left, z up (ISO 8855); x forward, y right, z down (SAE J670)."""

OF_A_LAW = ("amplitude", "offset", "values")
# Exponent of the unit of length in the numbers under a key.
POWERS = {
    "tolerance": 1,
    "points": 1,
    "wheel_radius": 1,
    "rack_per_turn": 1,
    "wheelbase": 1,
    "centre_of_gravity_height": 1,
    "spring_free_length": 1,
    "spring_rate": -1,
    "moment": 1,
}


def in_directions(mechanism: dict[str, Any]) -> dict[str, Any]:
    """A mechanism's content with `up` and `right` in place of `axes`.

    Raises:
        TableFault: no axes have that name, or `up` or `right` is given as well.
    """
    if "axes" not in mechanism:
        return mechanism
    axes, given = mechanism.pop("axes"), [name for name in ("up", "right") if name in mechanism]
    if given:
        problem = f"is given together with {given[0]}"
        raise TableFault(("axes",), problem, "axes by their name, or up and right")
    if not isinstance(axes, str) or axes not in AXES:
        raise TableFault(("axes",), f"is {shown(axes)}", ", ".join(AXES))
    return mechanism | AXES[axes]


def mm_of(units: object) -> float:
    """A unit of length in mm.

    Raises:
        TableFault: no unit has that name.
    """
    if not isinstance(units, str) or units not in UNITS:
        raise TableFault(("units",), f"is {shown(units)}", ", ".join(UNITS))
    return UNITS[units]


def law_scaled(law: Any, factor: float) -> Any:
    """The law of an input that is a length, as plain data, with its lengths times a factor."""
    return law if factor == 1.0 else with_values(law, partial(scaled, factor=factor, power=1), OF_A_LAW)


def scaled(value: Any, factor: float, power: int = 0) -> Any:
    """Numbers, lists and tables of them, times factor**power; in a table a key may give the power.

    Values that are not numbers stay as they are; the scene's checks report them.
    """
    if isinstance(value, Mapping):
        return {name: scaled(each, factor, power or POWERS.get(name, 0)) for name, each in value.items()}
    if not power:
        return value
    value = own_list(own_number(value))
    if isinstance(value, tuple):
        return [scaled(each, factor, power) for each in value]
    return factor**power * value if isinstance(value, int | float) and not isinstance(value, bool) else value
