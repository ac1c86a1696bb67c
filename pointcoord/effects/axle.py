r"""What the two wheels of an axle make together: its track, and its roll centre.

In the front view each wheel's line leads through its contact point c at right angles to the velocity v of c,
as a point of the knuckle, as that wheel travels (see `roll_centre`). With r = c_right - c_left both lines
meet at

    P = c_left + k / D (-v_u, v_h),      D = v_h w_u - v_u w_h,      k = r . w,

v of the left wheel and w of the right one along right (h) and up (u). Where the lines are parallel they meet
nowhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.knuckle import component, contact_place, velocity_at

# Of the sine of the angle of two lines: rates of solved points are off by some 1e-14 of themselves, so that
# what is as parallel as this may meet on either side.
PARALLEL = 1e-12


def track(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """(c_right - c_left) . right."""
    return component(right.seen, contact_place(right) - contact_place(left), "outboard")


def roll_centre_offset(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """Of P from the car's middle plane, through the user's origin, along right."""
    across, _ = _meeting(left, right)
    return component(right.seen, left.origin.value + contact_place(left), "outboard") + across


def roll_centre_height(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """Of P above the line through both contact points, along up."""
    across, up = _meeting(left, right)
    apart = contact_place(right) - contact_place(left)
    slope = ratio(component(right.seen, apart, "up"), component(right.seen, apart, "outboard"))
    return up - slope * across


def _meeting(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> tuple[Any, Any]:
    """From the left contact point to P, along right and up."""
    view, places = right.seen, (contact_place(left), contact_place(right))
    (v_h, v_u), (w_h, w_u), (r_h, r_u) = (
        (component(view, vector, "outboard"), component(view, vector, "up"))
        for vector in (velocity_at(left, places[0]), velocity_at(right, places[1]), places[1] - places[0])
    )
    across = v_h * w_u - v_u * w_h
    if isinstance(across, np.ndarray):
        least = PARALLEL * np.hypot(v_h, v_u) * np.hypot(w_h, w_u)
        across = np.where(np.abs(across) > least, across, np.nan)
    share = ratio(r_h * w_h + r_u * w_u, across)
    return -(share * v_u), share * v_h


def _number(name: str, words: str, sign: str, formula: Any) -> Number:
    return Number(name, words, sign, formula, ("wheel_axis", "knuckle"), way=BY_TRAVEL)


AXLE = CarNumbers.of(
    "axle",
    "track and roll centre of the axle, mm",
    _number("track", "track", "", track),
    _number(
        "axle_roll_centre_height",
        "height of the axle's roll centre",
        "above the line through both contact points",
        roll_centre_height,
    ),
    _number(
        "axle_roll_centre_offset",
        "offset of the axle's roll centre",
        "right of the car's middle plane",
        roll_centre_offset,
    ),
    nowhere="the lines of the two wheels are parallel",
    of_axle=True,
)
