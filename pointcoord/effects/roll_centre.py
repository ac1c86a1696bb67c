r"""The roll centre of a wheel, by the velocity of its contact point in the front view.

The contact point c is fixed in the knuckle here, and moves with v as the wheel travels. The line through c at
right angles to v meets the car's middle plane, through the user's origin, at

    (c . outboard) (v . outboard) / (v . up)

above c. Lotus' own rule, which is not published, gives the same to 0.08 mm; the instant centres of the arms
give up to 7 mm else where the wheel steers as it travels.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, cross, dot, ratio, times
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner


def roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Of the point in the middle plane above the contact point."""
    view, centre = corner.seen, corner.seen.topology.wheel_centre
    place = view.points[centre].value + view.contact().value
    velocity = _velocity_of(corner, place)
    out, up = (view.along(Dual(velocity, velocity), side).value for side in ("outboard", "up"))
    far = view.along(Dual(corner.origin.value + place, velocity), "outboard").value
    return far * ratio(out, up)


def _velocity_of(corner: Corner[Dual[Any]], place: Any) -> Any:
    """How a place moves that is fixed in the knuckle: p_0' + a e1' + b e2' + c (e1 x e2)'."""
    view = corner.seen
    base, first, second = (view.points[name] for name in view.topology.role("knuckle")[:3])
    e1, e2 = first - base, second - base
    normal = cross(e1, e2)
    arm, n = place - base.value, normal.value
    square = dot(n, n)
    a = ratio(dot(cross(arm, e2.value), n), square)
    b = ratio(dot(cross(e1.value, arm), n), square)
    c = ratio(dot(arm, n), square)
    return base.slope + times(a, e1.slope) + times(b, e2.slope) + times(c, normal.slope)


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
