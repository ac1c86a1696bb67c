r"""The roll centre of a wheel, by the velocity of its contact point in the front view.

The contact point c is fixed in the knuckle here, and moves with v as the wheel travels. The line through c at
right angles to v meets the car's middle plane, through the user's origin, at

    (c . outboard) (v . outboard) / (v . up)

above c. Lotus' own rule, which is not published, gives the same to 0.08 mm.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.knuckle import component, contact_place, told_from_none, velocity_at


def roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Of the point in the middle plane above the contact point."""
    return middle_plane_height(corner, velocity_at(corner, contact_place(corner)))


def middle_plane_height(corner: Corner[Dual[Any]], velocity: Any, *of: Any) -> Any:
    """The same of any velocity of the contact point, or a vector along it; of: as `told_from_none`."""
    view = corner.seen
    far = component(view, corner.origin.value + contact_place(corner), "outboard")
    up = told_from_none(component(view, velocity, "up"), velocity, *of)
    return far * ratio(component(view, velocity, "outboard"), up)


ROLL_CENTRE = CarNumbers.of(
    "roll_centre",
    "height of the roll centre above the contact point, mm",
    Number(
        "roll_centre_height",
        "roll centre height",
        "above the contact point",
        roll_centre_height,
        ("wheel_axis", "knuckle"),
        way=BY_TRAVEL,
    ),
)
