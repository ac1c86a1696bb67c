"""How the wheel leans and points by arcsines, and how it moves from where it is drawn.

With n the spin axis, of length 1, some programs have the arcsines -asin(n . up) and asin(n . forward) for
camber and toe, where others project n into a plane first. Adams/Car's turning tables have this camber, up to
0.18 degrees from the projected one at steering lock; OptimumK has this toe, 0.999229 degrees where the
projected one is 1 and camber is 2.25. The projected ones are angles of a line (see `angle`): for the left
wheel in the paper's axes kingpin angle and camber are its eqs. (16) and (17).

Travel is counted in the chassis' frame, of the wheel centre and of the contact point by their own names: at
equal travel they leave some thousandths of a degree between the angles (Lotus drives the contact point).
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
    """(W - drawn W) . up of the wheel centre W."""
    return corner.risen()


def contact_travel(corner: Corner[S]) -> S:
    """The same of the contact point of a disc that hangs along the chassis' up."""
    return corner.chassis.along(corner.moved_in_chassis(), "up")


def half_track_change(corner: Corner[S]) -> S:
    """(c - drawn c) . outboard of the contact point c."""
    return corner.seen.along(corner.moved(), "outboard")


def recession(corner: Corner[S]) -> S:
    """(c - drawn c) . rearward."""
    return corner.seen.along(corner.moved(), "rearward")
