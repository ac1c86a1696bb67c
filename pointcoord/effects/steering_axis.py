r"""The steering axis: where it meets the road, how far it passes from the wheel centre, and the screw axis.

With k along the axis, A a point of it, c the contact point and W the wheel centre, the axis at the height of
a place p is at

    A + k (p_up - A_up) / k_up.

*The screw axis* is the knuckle's screw axis as the rack moves and all else is held: the axis about which the
wheel is steered. A mechanism without a steering axis, such as a five-link, has one too ("virtual kingpin").
With w the rotation of the knuckle and v the displacement of W per mm of rack, its direction is w, upward, and

    W + w x v / |w|^2

is a point of it. w . v / |w|^2 is the knuckle's advance along it per radian. Lengths and angles are defined
as for the steering axis (suspension-explorer; Altair holds the spring's travel).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Literal

import numpy as np

from pointcoord.effects.arithmetic import (
    Dual,
    S,
    angle,
    cross,
    dot,
    ratio,
    reciprocal,
    root,
    sign_of,
    times,
)
from pointcoord.effects.corner import Corner, View, angular_velocity, at_rest
from pointcoord.linkage.directions import Direction

# Rotation of the knuckle for a rack travel of one wheel radius, rad: a smaller one may be rounding.
LEAST = 1e-9


@dataclass(frozen=True, eq=False)
class Axis(Generic[S]):
    """An axis about which a wheel is steered.

    Attributes:
        view: view of the wheel.
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
        """From the axis at the contact point's height to the contact point."""
        contact = self.view.contact()
        return contact - self.at(self.view.along(contact - self.beside, "up"))

    @property
    def at_wheel(self) -> S:
        """From the wheel centre to the axis at the wheel centre's height."""
        return self.at(-self.view.along(self.beside, "up"))


def steering_axis(corner: Corner[S]) -> Axis[S]:
    """The axis of the role `steering_axis`."""
    view = corner.seen
    start, _ = view.of.role("steering_axis")
    return Axis(view, view.role("steering_axis"), view.line(view.of.centre, start))


def offset(height: Literal["contact", "centre"], direction: Direction, axis: Axis[S]) -> S:
    """At the contact point's height, from the axis to the contact point; at the wheel centre's height, from
    the wheel centre to the axis; each along a direction of the car."""
    return axis.view.along(axis.at_ground if height == "contact" else axis.at_wheel, direction)


def scrub_radius(axis: Axis[S]) -> S:
    """The distance between axis and contact point in the road (ISO 8855, 7.2.10)."""
    gap = axis.at_ground
    return root(dot(gap, gap))


def mechanical_trail(axis: Axis[S]) -> S:
    """From the contact point to the axis at the ground, along the tyre's own x (ISO 8855, 7.2.3).

    The tyre's x is level, normal to the spin axis, and forward where the spin axis points outboard.
    """
    view = axis.view
    level = cross(view.spin, view.up)
    rearward = times(view.along(cross(view.outboard, view.up), "rearward"), level)
    return ratio(dot(axis.at_ground, rearward), root(dot(rearward, rearward)))


def screw_axis(corner: Corner[Dual[Any]]) -> Axis[Any]:
    """The screw axis of the knuckle, with W + w x v / |w|^2 as its point."""
    view, (turn, moved) = at_rest(corner.seen), _twist(corner)
    beside = times(reciprocal(dot(turn, turn)), cross(turn, moved))
    return Axis(view, times(sign_of(view.along(turn, "up")), turn), beside)


def pitch(corner: Corner[Dual[Any]]) -> Any:
    """The advance along the screw axis per radian, w . v / |w|^2."""
    turn, moved = _twist(corner)
    return ratio(dot(turn, moved), dot(turn, turn))


def _twist(corner: Corner[Dual[Any]]) -> tuple[Any, Any]:
    """Rotation and displacement; NaN where the knuckle does not rotate, or about a level axis only."""
    turn, moved = angular_velocity(corner), corner.seen.points[corner.seen.of.centre].slope
    if isinstance(turn, np.ndarray):
        rise = corner.seen.along(turn, "up")
        turn = np.where((np.abs(rise) * corner.seen.radius.value > LEAST)[..., None], turn, np.nan)
    return turn, moved


def lean(sine: Direction, cosine: Direction, axis: Axis[S]) -> S:
    """The angle of an axis, with its sine and cosine along two directions of the car."""
    return angle(axis.view.along(axis.direction, sine), axis.view.along(axis.direction, cosine))


def of_axis(axis: Callable[[Corner[S]], Axis[S]], formula: Callable[[Axis[S]], S], corner: Corner[S]) -> S:
    """A formula applied to an axis of a wheel."""
    return formula(axis(corner))
