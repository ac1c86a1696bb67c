r"""Where the steering axis meets the road, and how far it passes from the wheel centre.

With k from the axis' lower point A to its upper one, c the contact point and W the wheel centre, the axis is
at the height of a place p at

    A + k (p_up - A_up) / k_up.
"""

from __future__ import annotations

from pointcoord.effects.arithmetic import S, cross, dot, ratio, root, times
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.corner import Corner

ROLES = ("steering_axis", "wheel_axis")


def _axis_at(corner: Corner[S], height: S) -> S:
    """From the wheel centre to the axis at a height above its lower point."""
    view = corner.seen
    axis = view.role("steering_axis")
    return _lower(corner) + times(ratio(height, view.along(axis, "up")), axis)


def _lower(corner: Corner[S]) -> S:
    """From the wheel centre to the axis' lower point."""
    wheel = corner.seen.of
    return corner.seen.line(wheel.centre, wheel.role("steering_axis")[0])


def _at_ground(corner: Corner[S]) -> S:
    """From the axis to the contact point at its height."""
    contact = corner.seen.contact()
    return contact - _axis_at(corner, corner.seen.along(contact - _lower(corner), "up"))


def _at_wheel(corner: Corner[S]) -> S:
    """From the wheel centre to the axis at its height."""
    return _axis_at(corner, -corner.seen.along(_lower(corner), "up"))


def kingpin_offset(corner: Corner[S]) -> S:
    """From the axis to the contact point at ground, along the car's outboard."""
    return corner.seen.along(_at_ground(corner), "outboard")


def castor_offset(corner: Corner[S]) -> S:
    """The same along the car's rearward."""
    return corner.seen.along(_at_ground(corner), "rearward")


def scrub_radius(corner: Corner[S]) -> S:
    """The distance of both in the road (ISO 8855, 7.2.10)."""
    gap = _at_ground(corner)
    return root(dot(gap, gap))


def mechanical_trail(corner: Corner[S]) -> S:
    """From the contact point to the axis at ground, along the tyre's own x (ISO 8855, 7.2.3).

    That is level, at right angles to the spin axis, and forward where that points outboard.
    """
    view = corner.seen
    level = cross(view.spin, view.up)
    rearward = times(view.along(cross(view.outboard, view.up), "rearward"), level)
    return ratio(dot(_at_ground(corner), rearward), root(dot(rearward, rearward)))


def kingpin_offset_at_wheel(corner: Corner[S]) -> S:
    """From the axis to the wheel centre at its height, along the car's outboard."""
    return -corner.seen.along(_at_wheel(corner), "outboard")


def hub_trail(corner: Corner[S]) -> S:
    """From the wheel centre to the axis at its height, along the car's rearward (Lotus)."""
    return corner.seen.along(_at_wheel(corner), "rearward")


STEERING_AXIS = CarNumbers.of(
    "steering_axis",
    "scrub radius, kingpin offsets, trails, mm",
    Number("kingpin_offset", "kingpin offset at ground", "where the axis is inboard", kingpin_offset, ROLES),
    Number("scrub_radius", "scrub radius", "", scrub_radius, ROLES),
    Number("mechanical_trail", "mechanical trail", "where the axis is ahead", mechanical_trail, ROLES),
    Number("castor_offset", "castor offset at ground", "where the axis is ahead", castor_offset, ROLES),
    Number(
        "kingpin_offset_at_wheel",
        "kingpin offset at the wheel centre",
        "where the axis is inboard",
        kingpin_offset_at_wheel,
        ROLES,
        needs_radius=False,
    ),
    Number("hub_trail", "hub trail", "where the axis is behind", hub_trail, ROLES, needs_radius=False),
)
