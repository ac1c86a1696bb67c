r"""Instant centres of a wheel as it travels, and roll centres of a wheel and of an axle.

The contact point c is fixed in the knuckle here, and moves with the velocity v as the wheel travels.

*Roll centre.* The line through c normal to v meets the car's middle plane, through the user's origin, at

    (c . outboard) (v . outboard) / (v . up)

above c. Lotus' own rule, which is not published, gives the same to 0.08 mm.

*Roll centre by the lines of the arms.* The arms' lines ignore that the knuckle also turns about its steering
axis k if the wheel steers as it travels, which changes the height by up to 7 mm. Of all motions w + l k that
move the ball joints alike, the arms' lines correspond to the one that is a pure rotation,

    (w + l k) . v_P = 0,      l = -(w . v_P) / (k . v_P),

with P the axis' lower point. For two wishbones it is the rotation about the line where the planes of both
arms meet; for a strut, about the line where the arm's plane meets the plane through the strut's top normal to
the strut.

*Instant centres.* In the plane through c spanned by a horizontal direction h and up, the knuckle's points
move as a plane figure. With h' and up' the derivatives of these directions as vectors fixed in the knuckle,
the point c + r_h h + r_u up moves with v + r_h h' + r_u up', where h' . up = -up' . h. So the point at rest
in the plane is at

    r_h = (v . up) / (up' . h),      r_u = -(v . h) / (up' . h).

Where the knuckle does not turn in the plane, the centre is at infinity.

*Roll centre of an axle.* In the front view each wheel has a line through its c normal to its v. With
r = c_right - c_left both lines meet at

    P = c_left + k / D (-v_u, v_h),      D = v_h w_u - v_u w_h,      k = r . w,

with v of the left wheel and w of the right one along right (h) and up (u). Parallel lines do not meet.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import Dual, cross, dot, ratio, times
from pointcoord.effects.corner import (
    Corner,
    above_rounding,
    angular_velocity,
    contact_place,
    turning_of,
    velocity_at,
)
from pointcoord.linkage.directions import Direction

# In radii of the wheel. Doubles cannot tell a farther centre from one at infinity: so small an angular
# velocity is a difference of larger ones, each known to some 1e-16.
FARTHEST = 1e9

# Sine of the angle between two lines. Rates of solved points have relative errors of some 1e-14, so lines as
# nearly parallel as this may meet on either side.
PARALLEL = 1e-12


def roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Height of the roll centre above the contact point, in the middle plane."""
    return middle_plane_height(corner, velocity_at(corner, contact_place(corner)))


def middle_plane_height(corner: Corner[Dual[Any]], velocity: Any, *of: Any) -> Any:
    """Roll centre height for a velocity of the contact point, of any length; of: as in `above_rounding`."""
    view = corner.seen
    far = view.along(corner.origin.value + contact_place(corner), "outboard")
    up = above_rounding(view.along(velocity, "up"), velocity, *of)
    return far * ratio(view.along(velocity, "outboard"), up)


def arm_roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Height above the contact point of the roll centre by the lines of the arms, in the middle plane."""
    view, place = corner.seen, contact_place(corner)
    lower = view.points[view.of.role("steering_axis")[0]].value
    turn, axis = angular_velocity(corner), view.role("steering_axis").value
    moved, arm = velocity_at(corner, lower), place - lower
    # The velocity is multiplied by k . v_P, which leaves its direction.
    along = moved + cross(turn, arm)
    velocity = times(dot(axis, moved), along) - times(dot(turn, moved), cross(axis, arm))
    # Where v_P is zero, so is this velocity.
    return middle_plane_height(corner, velocity, times(dot(turn, turn) * dot(arm, arm), axis))


def swing_arm(side: Direction, corner: Corner[Dual[Any]]) -> Any:
    """Distance from the contact point to the instant centre, against the direction `side`."""
    up, _, turn = _seen_from(side, corner)
    return -ratio(up, turn)


def centre_height(side: Direction, corner: Corner[Dual[Any]]) -> Any:
    """Height of the instant centre above the contact point."""
    _, along, turn = _seen_from(side, corner)
    return -ratio(along, turn)


def _seen_from(side: Direction, corner: Corner[Dual[Any]]) -> tuple[Any, Any, Any]:
    """v . up, v . h and up' . h; the last is NaN where the centre is too far away."""
    view = corner.seen
    velocity = velocity_at(corner, contact_place(corner))
    up, along = view.along(velocity, "up"), view.along(velocity, side)
    turn = view.along(turning_of(corner, view.up.value), side)
    if isinstance(turn, np.ndarray):
        turn = np.where(np.abs(up) <= FARTHEST * view.radius.value * np.abs(turn), turn, np.nan)
    return up, along, turn


def track(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """(c_right - c_left) . right."""
    return right.seen.along(contact_place(right) - contact_place(left), "outboard")


def axle_roll_centre_offset(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """Distance of P from the car's middle plane, through the user's origin, along right."""
    across, _ = _meeting(left, right)
    return right.seen.along(left.origin.value + contact_place(left), "outboard") + across


def axle_roll_centre_height(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """Height of P above the line through both contact points, along up."""
    across, up = _meeting(left, right)
    apart = contact_place(right) - contact_place(left)
    slope = ratio(right.seen.along(apart, "up"), right.seen.along(apart, "outboard"))
    return up - slope * across


def _meeting(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> tuple[Any, Any]:
    """Vector from the left contact point to P, along right and up."""
    view, places = right.seen, (contact_place(left), contact_place(right))
    (v_h, v_u), (w_h, w_u), (r_h, r_u) = (
        (view.along(vector, "outboard"), view.along(vector, "up"))
        for vector in (velocity_at(left, places[0]), velocity_at(right, places[1]), places[1] - places[0])
    )
    across = v_h * w_u - v_u * w_h
    if isinstance(across, np.ndarray):
        least = PARALLEL * np.hypot(v_h, v_u) * np.hypot(w_h, w_u)
        across = np.where(np.abs(across) > least, across, np.nan)
    share = ratio(r_h * w_h + r_u * w_u, across)
    return -(share * v_u), share * v_h
