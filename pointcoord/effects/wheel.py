"""Wheel angles by arcsines, and the wheel's displacement from its drawn place.

With n the unit vector of the spin axis, some programs define camber as -asin(n . up) and toe as
asin(n . forward), where others project n into a plane first. Adams/Car's turning tables use this camber,
which differs by up to 0.18 degrees from the projected one at steering lock. OptimumK uses this toe: 0.999229
degrees where the projected toe is 1 and camber is 2.25. The projected angles are angles of a line (see
`angle`); for the left wheel in the paper's axes kingpin angle and camber are its eqs. (16) and (17).

Travel is measured in the chassis' frame, at the wheel centre and at the contact point under separate names:
at equal travel they differ by some thousandths of a degree in the angles (Lotus drives the contact point).
"""

from __future__ import annotations

from pointcoord.effects.arithmetic import S, angle, root
from pointcoord.effects.corner import Corner, View


def camber_by_arcsine(corner: Corner[S]) -> S:
    """-asin(n . up)."""
    up, forward, outboard = _components(corner.seen)
    return -angle(up, root(forward * forward + outboard * outboard))


def toe_by_arcsine(corner: Corner[S]) -> S:
    """asin(n . forward)."""
    return _forward_arcsine(corner.seen)


def toe_change_by_arcsine(corner: Corner[S]) -> S:
    """asin(n . forward) - asin(drawn n . forward)."""
    return _forward_arcsine(corner.seen) - _forward_arcsine(corner.drawn)


def _forward_arcsine(view: View[S]) -> S:
    up, forward, outboard = _components(view)
    return angle(forward, root(up * up + outboard * outboard))


def _components(view: View[S]) -> tuple[S, S, S]:
    return view.along(view.spin, "up"), view.along(view.spin, "forward"), view.along(view.spin, "outboard")


def travel(corner: Corner[S]) -> S:
    """Displacement of the wheel centre W, (W - drawn W) . up."""
    return corner.risen()


def contact_travel(corner: Corner[S]) -> S:
    """Displacement of the contact point along up, of a disc along the chassis' up."""
    return corner.chassis.along(corner.moved_in_chassis(), "up")


def half_track_change(corner: Corner[S]) -> S:
    """Outboard displacement of the contact point c, (c - drawn c) . outboard."""
    return corner.seen.along(corner.moved(), "outboard")


def recession(corner: Corner[S]) -> S:
    """Rearward displacement of the contact point c, (c - drawn c) . rearward."""
    return corner.seen.along(corner.moved(), "rearward")
