r"""About which points a wheel moves as it travels: instant centres; roll centres of a wheel and an axle.

The contact point c is fixed in the knuckle here, and moves with the velocity v as the wheel travels.

*Roll centre.* The line through c at right angles to v meets the car's middle plane, through the user's
origin, at

    (c . outboard) (v . outboard) / (v . up)

above c. Lotus' own rule, which is not published, gives the same to 0.08 mm.

*By the lines of the arms.* They leave out that the knuckle turns about its steering axis k besides, where
the wheel steers as it travels, which makes up to 7 mm. Of the motions w + l k that move the ball joints
alike, they take the one that is a pure rotation,

    (w + l k) . v_P = 0,      l = -(w . v_P) / (k . v_P),

P the axis' lower point. Of two wishbones it is the turn about the line where the planes of both arms meet, of
a strut about that where the arm's plane meets the one through the strut's top at right angles to the strut.

*Instant centres.* In the plane through c that a horizontal direction h and up span, the knuckle's points move
as a plane figure. With h' and up' the derivatives of the directions, all fixed in the knuckle, the point
c + r_h h + r_u up moves with v + r_h h' + r_u up', where h' . up = -up' . h. So nothing moves in the plane at

    r_h = (v . up) / (up' . h),      r_u = -(v . h) / (up' . h).

Where the knuckle does not turn in the plane, the centre is at infinity.

*Of an axle.* In the front view each wheel's line leads through its c at right angles to its v. With
r = c_right - c_left both lines meet at

    P = c_left + k / D (-v_u, v_h),      D = v_h w_u - v_u w_h,      k = r . w,

v of the left wheel and w of the right one along right (h) and up (u). Where the lines are parallel they meet
nowhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import Dual, cross, dot, ratio, times
from pointcoord.effects.corner import (
    Corner,
    angular_velocity,
    contact_place,
    told_from_none,
    turning_of,
    velocity_at,
)
from pointcoord.linkage.car_axes import Direction

# Radii of the wheel. Doubles do not tell what is farther from what is at infinity: a turn that small is
# known to some 1e-16 of the turns that it is the difference of.
FARTHEST = 1e9

# Of the sine of the angle of two lines: rates of solved points are off by some 1e-14 of themselves, so that
# what is as parallel as this may meet on either side.
PARALLEL = 1e-12


def roll_centre_height(corner: Corner[Dual[Any]]) -> Any:
    """Of the point in the middle plane above the contact point."""
    return middle_plane_height(corner, velocity_at(corner, contact_place(corner)))


def middle_plane_height(corner: Corner[Dual[Any]], velocity: Any, *of: Any) -> Any:
    """The same of any velocity of the contact point, or a vector along it; of: as `told_from_none`."""
    view = corner.seen
    far = view.along(corner.origin.value + contact_place(corner), "outboard")
    up = told_from_none(view.along(velocity, "up"), velocity, *of)
    return far * ratio(view.along(velocity, "outboard"), up)


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
    up, along = view.along(velocity, "up"), view.along(velocity, side)
    turn = view.along(turning_of(corner, view.up.value), side)
    if isinstance(turn, np.ndarray):
        turn = np.where(np.abs(up) <= FARTHEST * view.radius.value * np.abs(turn), turn, np.nan)
    return up, along, turn


def track(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """(c_right - c_left) . right."""
    return right.seen.along(contact_place(right) - contact_place(left), "outboard")


def axle_roll_centre_offset(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """Of P from the car's middle plane, through the user's origin, along right."""
    across, _ = _meeting(left, right)
    return right.seen.along(left.origin.value + contact_place(left), "outboard") + across


def axle_roll_centre_height(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> Any:
    """Of P above the line through both contact points, along up."""
    across, up = _meeting(left, right)
    apart = contact_place(right) - contact_place(left)
    slope = ratio(right.seen.along(apart, "up"), right.seen.along(apart, "outboard"))
    return up - slope * across


def _meeting(left: Corner[Dual[Any]], right: Corner[Dual[Any]]) -> tuple[Any, Any]:
    """From the left contact point to P, along right and up."""
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
