"""Numbers of the whole car, such as its wheelbase, that some effects need and the linkage does not have."""

import json
import sys
from collections.abc import Mapping
from typing import Any

from absolute.errors import DescriptionError

# The names, and what messages show as an example of each.
EXAMPLES: Mapping[str, str | float] = {
    "axle": "front",
    "wheelbase": 2700.0,
    "centre_of_gravity_height": 550.0,
    "brake_share": 0.6,
    "drive_share": 0.5,
    "spring_rate": 30.0,
    "spring_free_length": 350.0,
}
LONGEST = sys.float_info.max
# Which way the axle is from the middle of the car, rearward.
AXLES = {"front": -1.0, "rear": 1.0}


def car_of(given: Any) -> dict[str, float]:
    """Numbers of the car, of plain data.

    Args:
        given: None, or a mapping with any of axle, "front" or "rear"; wheelbase, mm; centre_of_gravity_height
            above the ground as drawn, mm; brake_share and drive_share, the parts of the braking and of the
            driving force that act at this axle, 0 to 1; spring_rate, N/mm, and spring_free_length, mm, of a
            spring between the ends of the damper.
    Returns:
        The same, but for the axle, which is -1 for the front one and 1 for the rear one.
    Raises:
        DescriptionError: an unknown name, or a value of another type or out of range.
    """
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise DescriptionError(f"car is {given!r}; a table of {list(EXAMPLES)} is needed", "car", given)
    return {name: _checked(name, value) for name, value in given.items()}


def needed(car: Mapping[str, float], *names: str) -> list[float]:
    """Some of a car's numbers.

    Raises:
        DescriptionError: it lacks one; the message names all that it lacks.
    """
    lacking = [name for name in names if name not in car]
    if lacking:
        lines = ", ".join(f"{name} = {json.dumps(EXAMPLES[name])}" for name in lacking)
        raise DescriptionError(
            f"needs {' and '.join(lacking)}, and none is given: write in [car], for example, {lines}, or ask "
            "for other effects",
            lacking[0],
        )
    return [car[name] for name in names]


def _checked(name: str, value: Any) -> float:
    if name not in EXAMPLES:
        raise DescriptionError(f"car has {name!r}; it must be one of {list(EXAMPLES)}", str(name), value)
    if name == "axle":
        if not isinstance(value, str) or value not in AXLES:
            raise DescriptionError(f"axle is {value!r}; it must be one of {list(AXLES)}", name, value)
        return AXLES[value]
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if name.endswith("share"):
        fine, allowed = number and 0.0 <= value <= 1.0, "a number from 0 to 1 is needed"
    else:
        what, unit = ("rate", "N/mm") if name == "spring_rate" else ("length", "mm")
        fine, allowed = number and 0.0 < value <= LONGEST, f"a {what} above 0 is needed, in {unit}"
    if not fine:
        raise DescriptionError(f"{name} is {value!r}; {allowed}", name, value)
    return float(value)
