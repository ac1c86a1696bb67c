r"""Anti-features: the share of the load transfer in braking and driving carried by links, not by springs.

    100 share s (v . rearward) / (v . up) L / h,      s = -1 at the front axle and +1 at the rear one

with L the wheelbase and h the height of the centre of gravity above the ground at this pose. If the brake
acts at the wheel, v is the velocity of the contact point, fixed in the knuckle. If a shaft from the chassis
drives the wheel, v is that of the wheel centre. For the front car of Lotus' report the result differs by at
most 0.0072 percentage points. suspension-explorer draws a line through the side view's centre instead.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, multiple, ratio
from pointcoord.effects.corner import Corner, above_rounding, contact_place, velocity_at

PERCENT = 100.0


def anti_brake(corner: Corner[Dual[Any]]) -> Any:
    """The share in braking, by the velocity of the contact point, %."""
    return _carried(corner, "brake_share", velocity_at(corner, contact_place(corner)))


def anti_drive(corner: Corner[Dual[Any]]) -> Any:
    """The share in driving, by the velocity of the wheel centre, %."""
    view = corner.seen
    return _carried(corner, "drive_share", view.points[view.of.centre].slope)


def _carried(corner: Corner[Dual[Any]], share: str, velocity: Any) -> Any:
    car = {name: number.value for name, number in corner.car.items()}
    travel = corner.chassis.along(corner.moved(corner.chassis), "up").value
    height = car["centre_of_gravity_height"] - travel
    up = above_rounding(corner.seen.along(velocity, "up"), velocity)
    slope = ratio(corner.seen.along(velocity, "rearward"), up)
    part = multiple(PERCENT, car[share] * car["axle"])
    return part * slope * ratio(car["wheelbase"], height)
