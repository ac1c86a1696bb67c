r"""Where the steering axis meets the road, and how far it passes from the wheel centre.

With k along the axis, A a point of it, c the contact point and W the wheel centre, the axis is at the height
of a place p at

    A + k (p_up - A_up) / k_up.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Generic

from pointcoord.effects.arithmetic import S, cross, dot, ratio, root, times
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.corner import Corner, View

ROLES = ("steering_axis", "wheel_axis")


@dataclass(frozen=True, eq=False)
class Axis(Generic[S]):
    """An axis that a wheel is steered about.

    Attributes:
        view: of the wheel.
        direction: k, of any length.
        beside: from the wheel centre to A.
    """

    view: View[S]
    direction: S
    beside: S

    def at(self, height: S) -> S:
        """From the wheel centre to the axis at a height above A."""
        return self.beside + times(ratio(height, self.view.along(self.direction, "up")), self.direction)

    @property
    def at_ground(self) -> S:
        """From the axis to the contact point at its height."""
        contact = self.view.contact()
        return contact - self.at(self.view.along(contact - self.beside, "up"))

    @property
    def at_wheel(self) -> S:
        """From the wheel centre to the axis at its height."""
        return self.at(-self.view.along(self.beside, "up"))


def steering_axis(corner: Corner[S]) -> Axis[S]:
    """The one that the mechanism's role names."""
    view = corner.seen
    start, _ = view.of.role("steering_axis")
    return Axis(view, view.role("steering_axis"), view.line(view.of.centre, start))


def kingpin_offset(axis: Axis[S]) -> S:
    """From the axis to the contact point at ground, along the car's outboard."""
    return axis.view.along(axis.at_ground, "outboard")


def castor_offset(axis: Axis[S]) -> S:
    """The same along the car's rearward."""
    return axis.view.along(axis.at_ground, "rearward")


def scrub_radius(axis: Axis[S]) -> S:
    """The distance of both in the road (ISO 8855, 7.2.10)."""
    gap = axis.at_ground
    return root(dot(gap, gap))


def mechanical_trail(axis: Axis[S]) -> S:
    """From the contact point to the axis at ground, along the tyre's own x (ISO 8855, 7.2.3).

    That is level, at right angles to the spin axis, and forward where that points outboard.
    """
    view = axis.view
    level = cross(view.spin, view.up)
    rearward = times(view.along(cross(view.outboard, view.up), "rearward"), level)
    return ratio(dot(axis.at_ground, rearward), root(dot(rearward, rearward)))


def kingpin_offset_at_wheel(axis: Axis[S]) -> S:
    """From the axis to the wheel centre at its height, along the car's outboard."""
    return -axis.view.along(axis.at_wheel, "outboard")


def hub_trail(axis: Axis[S]) -> S:
    """From the wheel centre to the axis at its height, along the car's rearward (Lotus)."""
    return axis.view.along(axis.at_wheel, "rearward")


LENGTHS: tuple[tuple[str, str, str, Callable[[Axis[S]], S]], ...] = (
    ("kingpin_offset", "kingpin offset at ground", "where the axis is inboard", kingpin_offset),
    ("scrub_radius", "scrub radius", "", scrub_radius),
    ("mechanical_trail", "mechanical trail", "where the axis is ahead", mechanical_trail),
    ("castor_offset", "castor offset at ground", "where the axis is ahead", castor_offset),
    (
        "kingpin_offset_at_wheel",
        "kingpin offset at the wheel centre",
        "where the axis is inboard",
        kingpin_offset_at_wheel,
    ),
    ("hub_trail", "hub trail", "where the axis is behind", hub_trail),
)
"""Name, words, sign and formula of each length of an axis."""


def _of_role(formula: Callable[[Axis[S]], S], corner: Corner[S]) -> S:
    return formula(steering_axis(corner))


STEERING_AXIS = CarNumbers.of(
    "steering_axis",
    "scrub radius, kingpin offsets, trails, mm",
    *(
        Number(
            name,
            words,
            sign,
            partial(_of_role, formula),
            ROLES,
            formula not in (hub_trail, kingpin_offset_at_wheel),
        )
        for name, words, sign, formula in LENGTHS
    ),
)
