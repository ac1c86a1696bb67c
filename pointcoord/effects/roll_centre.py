r"""The roll centre of a wheel, by the velocity of its contact point in the front view.

The contact point c is fixed in the knuckle here, and moves with v as the wheel travels. The line through c at
right angles to v meets the car's middle plane, through the user's origin, at

    (c . outboard) (v . outboard) / (v . up)

above c. Lotus' own rule, which is not published, gives the same to 0.08 mm. The lines of the arms give up to
7 mm else where the wheel steers as it travels: they leave out that the knuckle turns about its steering axis
k besides. Of the motions w + l k that move the ball joints alike, they take the one that is a pure rotation,

    (w + l k) . v_P = 0,      l = -(w . v_P) / (k . v_P),

P the axis' lower point. Of two wishbones it is the turn about the line where the planes of both arms meet, of
a strut about that where the arm's plane meets the one through strut_top at right angles to the strut.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, cross, dot, ratio, times
from pointcoord.effects.car_number import BY_TRAVEL, CarNumbers, Number
from pointcoord.effects.corner import Corner
from pointcoord.effects.knuckle import angular_velocity, component, contact_place, velocity_at


def roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Of the point in the middle plane above the contact point."""
    return _height(corner, velocity_at(corner, contact_place(corner)))


def arm_roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """The same by the lines of the arms."""
    view, place = corner.seen, contact_place(corner)
    lower = view.points[view.of.role("steering_axis")[0]].value
    turn, axis = angular_velocity(corner), view.role("steering_axis").value
    moved, arm = velocity_at(corner, lower), place - lower
    # All of it times k . v_P, which changes no direction.
    along = moved + cross(turn, arm)
    return _height(corner, times(dot(axis, moved), along) - times(dot(turn, moved), cross(axis, arm)))


def _height(corner: Corner[Dual[Any]], velocity: Any) -> Any:
    view = corner.seen
    far = component(view, corner.origin.value + contact_place(corner), "outboard")
    return far * ratio(component(view, velocity, "outboard"), component(view, velocity, "up"))


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
)
