"""Wheel angles by arcsines, and the wheel's displacement from its drawn place.

With n the unit vector of the spin axis, some programs define camber as -asin(n . up) and toe as
asin(n . forward), where others project n into a plane first. Adams/Car's turning tables use this camber,
which differs by up to 0.18 degrees from the projected one at steering lock. OptimumK uses this toe: 0.999229
degrees where the projected toe is 1 and camber is 2.25. The projected angles are angles of a line (see
`Angle`); for the left wheel in the paper's axes kingpin angle and camber are its eqs. (16) and (17).

Travel is measured in the chassis' frame, at the wheel centre and at the contact point under separate names:
at equal travel they differ by some thousandths of a degree in the angles (Lotus drives the contact point).
"""

from __future__ import annotations

from typing import Literal

from pointcoord.effects.arithmetic import S, angle, root
from pointcoord.effects.corner import Corner, View
from pointcoord.linkage.directions import Direction

ArcsineOf = Literal["down", "forward"]


def arcsine(direction: ArcsineOf, corner: Corner[S]) -> S:
    """asin(n . direction)."""
    return _arcsine(direction, corner.seen)


def toe_change_by_arcsine(corner: Corner[S]) -> S:
    """asin(n . forward) - asin(drawn n . forward)."""
    return _arcsine("forward", corner.seen) - _arcsine("forward", corner.drawn)


def _arcsine(direction: ArcsineOf, view: View[S]) -> S:
    """asin of a component of the unit vector, from the three components of the spin axis of any length."""
    across: Direction = "forward" if direction == "down" else "up"
    one, other = view.along(view.spin, across), view.along(view.spin, "outboard")
    return angle(view.along(view.spin, direction), root(one * one + other * other))


def travel(corner: Corner[S]) -> S:
    """Displacement of the wheel centre W, (W - drawn W) . up."""
    return corner.risen()


def contact_travel(corner: Corner[S]) -> S:
    """Displacement of the contact point along up, of a disc along the chassis' up."""
    return corner.chassis.along(corner.moved(corner.chassis), "up")


def displacement(direction: Direction, corner: Corner[S]) -> S:
    """Displacement of the contact point c, (c - drawn c) . direction."""
    return corner.seen.along(corner.moved(corner.seen), direction)
