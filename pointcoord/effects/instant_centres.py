r"""The instant centres of a wheel in the front and in the side view, as it travels.

In the plane through the contact point c that a horizontal direction h and up span, the knuckle's points move
as a plane figure. With v the velocity of c and h', up' those of the directions, all fixed in the knuckle, the
point c + r_h h + r_u up moves with v + r_h h' + r_u up', where h' . up = -up' . h. So nothing moves in the
plane at

    r_h = (v . up) / (up' . h),      r_u = -(v . h) / (up' . h).

Where the knuckle does not turn in the plane, the centre is at infinity.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.knuckle import component, contact_place, turning_of, velocity_at
from pointcoord.linkage.car_axes import Direction

# Radii of the wheel. Doubles do not tell what is farther from what is at infinity: a turn that small is
# known to some 1e-16 of the turns that it is the difference of.
FARTHEST = 1e9


def swing_arm(side: Direction, corner: Corner[Dual[Any]]) -> Any:
    """From the contact point to the centre, against `side`."""
    up, _, turn = _seen_from(side, corner)
    return -ratio(up, turn)


def centre_height(side: Direction, corner: Corner[Dual[Any]]) -> Any:
    """Of the centre above the contact point."""
    _, along, turn = _seen_from(side, corner)
    return -ratio(along, turn)


def _seen_from(side: Direction, corner: Corner[Dual[Any]]) -> tuple[Any, Any, Any]:
    """v . up, v . h and up' . h; no number where that turns about a centre beyond all lengths."""
    view = corner.seen
    velocity = velocity_at(corner, contact_place(corner))
    up, along = component(view, velocity, "up"), component(view, velocity, side)
    turn = component(view, turning_of(corner, view.up.value), side)
    if isinstance(turn, np.ndarray):
        turn = np.where(np.abs(up) <= FARTHEST * view.radius.value * np.abs(turn), turn, np.nan)
    return up, along, turn


def _number(name: str, words: str, sign: str, formula: Any) -> Number:
    return Number(name, words, sign, formula, ("wheel_axis", "knuckle"), way=BY_TRAVEL)


INSTANT_CENTRES = CarNumbers.of(
    "instant_centres",
    "swing arms and heights of the instant centres in the front and in the side view, mm",
    _number(
        "front_view_swing_arm",
        "front-view swing arm",
        "where the centre is inboard of the contact point",
        partial(swing_arm, "outboard"),
    ),
    _number(
        "front_view_centre_height",
        "height of the front-view centre",
        "above the contact point",
        partial(centre_height, "outboard"),
    ),
    _number(
        "side_view_swing_arm",
        "side-view swing arm",
        "where the centre is behind the contact point",
        partial(swing_arm, "forward"),
    ),
    _number(
        "side_view_centre_height",
        "height of the side-view centre",
        "above the contact point",
        partial(centre_height, "rearward"),
    ),
    nowhere="the centre is at infinity",
)
