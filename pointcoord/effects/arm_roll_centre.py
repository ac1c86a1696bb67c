r"""The roll centre of a wheel by the lines of its arms.

They leave out that the knuckle turns about its steering axis k besides, where the wheel steers as it travels,
which makes up to 7 mm. Of the motions w + l k that move the ball joints alike, they take the one that is a
pure rotation,

    (w + l k) . v_P = 0,      l = -(w . v_P) / (k . v_P),

P the axis' lower point. Of two wishbones it is the turn about the line where the planes of both arms meet, of
a strut about that where the arm's plane meets the one through the strut's top at right angles to the strut.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, cross, dot, times
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.knuckle import angular_velocity, contact_place, velocity_at
from pointcoord.effects.roll_centre import middle_plane_height


def arm_roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Of the point in the middle plane above the contact point."""
    view, place = corner.seen, contact_place(corner)
    lower = view.points[view.of.role("steering_axis")[0]].value
    turn, axis = angular_velocity(corner), view.role("steering_axis").value
    moved, arm = velocity_at(corner, lower), place - lower
    # All of it times k . v_P, which changes no direction.
    along = moved + cross(turn, arm)
    velocity = times(dot(axis, moved), along) - times(dot(turn, moved), cross(axis, arm))
    # Where v_P is none, all of it is.
    return middle_plane_height(corner, velocity, times(dot(turn, turn) * dot(arm, arm), axis))


ARM_ROLL_CENTRE = CarNumbers.of(
    "arm_roll_centre",
    "height of the roll centre by the lines of the arms above the contact point, mm",
    Number(
        "arm_roll_centre_height",
        "roll centre height by the arms",
        "above the contact point",
        arm_roll_centre_height,
        ("wheel_axis", "steering_axis", "knuckle"),
        way=BY_TRAVEL,
    ),
    nowhere="the lower point of the steering axis stands still",
)
