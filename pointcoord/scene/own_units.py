"""A scene that is written in other units or axes than the project's: turned into mm and directions once.

What comes of it is a plain scene in mm; every result is in mm. Angles and times have one unit.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from typing import Any

from pointcoord.mechanism.faults import TableFault
from pointcoord.scene.input_part import with_values
from pointcoord.scene.scene_part import own_list, own_number
from pointcoord.wording import shown

UNITS = {"mm": 1.0, "m": 1000.0, "in": 25.4}
"""The units of length that a scene may be written in, in mm."""

AXES = {
    "rearward-right-up": {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)},
    "iso": {"up": (0.0, 0.0, 1.0), "right": (0.0, -1.0, 0.0)},
    "sae": {"up": (0.0, 0.0, -1.0), "right": (0.0, 1.0, 0.0)},
}
"""Axes by name: ours; x forward, y left, z up (ISO 8855); x forward, y right, z down (SAE J670)."""

OF_THE_MECHANISM = ("wheel_radius", "rack_per_turn")
OF_A_LAW = ("amplitude", "offset", "values")
# By what power of the unit of length each goes.
OF_THE_CAR = {"wheelbase": 1, "centre_of_gravity_height": 1, "spring_free_length": 1, "spring_rate": -1}


def in_directions(mechanism: dict[str, Any]) -> dict[str, Any]:
    """A mechanism's content with `up` and `right` in place of `axes`.

    Raises:
        TableFault: no axes have that name, or they stand beside a direction.
    """
    if "axes" not in mechanism:
        return mechanism
    axes, given = mechanism.pop("axes"), [name for name in ("up", "right") if name in mechanism]
    if given:
        raise TableFault(("axes",), f"stands beside {given[0]}", "axes by their name, or up and right")
    if not isinstance(axes, str) or axes not in AXES:
        raise TableFault(("axes",), f"is {shown(axes)}", ", ".join(AXES))
    return mechanism | AXES[axes]


def in_mm(content: dict[str, Any], lengths: Collection[str]) -> dict[str, Any]:
    """A scene's content with every length in mm, in place of `units`.

    What is no number stays as it is, to be told as in any scene.

    Args:
        lengths: names of the inputs that are lengths.
    Raises:
        TableFault: no unit has that name.
    """
    if "units" not in content:
        return content
    units = content.pop("units")
    if not isinstance(units, str) or units not in UNITS:
        raise TableFault(("units",), f"is {shown(units)}", ", ".join(UNITS))
    factor = UNITS[units]
    if "tolerance" in content:
        content["tolerance"] = _times(factor, content["tolerance"])
    mechanism = content.get("mechanism")
    if isinstance(mechanism, Mapping):
        lengthy = {name: _times(factor, mechanism[name]) for name in OF_THE_MECHANISM if name in mechanism}
        points, car, loads = (mechanism.get(name) for name in ("points", "car", "loads"))
        if isinstance(points, Mapping):
            lengthy["points"] = _times(factor, points)
        if isinstance(car, Mapping):
            lengthy["car"] = {n: _times(factor ** OF_THE_CAR.get(n, 0), v) for n, v in car.items()}
        if isinstance(loads, Mapping):
            lengthy["loads"] = _moments(factor, loads)
        content["mechanism"] = {**mechanism, **lengthy}
    inputs = content.get("inputs")
    if isinstance(inputs, Mapping):
        content["inputs"] = {
            name: with_values(law, partial(_times, factor), OF_A_LAW) if name in lengths else law
            for name, law in inputs.items()
        }
    return content


def _moments(factor: float, loads: Mapping[str, Any]) -> dict[str, Any]:
    """Loads with their moments, not their forces, so many times as large."""
    found = dict(loads)
    for name, part in loads.items():
        if isinstance(part, Mapping):
            found[name] = _moments(factor, part)
        elif name == "moment":
            found[name] = _times(factor, part)
    return found


def _times(factor: float, value: Any) -> Any:
    """Numbers, lists and tables of them so many times as large."""
    if isinstance(value, Mapping):
        return {name: _times(factor, each) for name, each in value.items()}
    value = own_list(own_number(value))
    if isinstance(value, tuple):
        return [_times(factor, each) for each in value]
    return factor * value if isinstance(value, int | float) and not isinstance(value, bool) else value
