"""How what is fixed in the knuckle moves along a way: places, and directions.

Of three points p_0, p_1, p_2 of the knuckle with e1 = p_1 - p_0 and e2 = p_2 - p_0, a vector that is fixed in
it is a e1 + b e2 + c n, n = e1 x e2, with constant a, b, c; so its derivative is a e1' + b e2' + c n'. Of
the angular velocity w it is w x the vector, so that

    |n|^2 w = (e1' . e2) n - (e1' . n) e2 + (e2' . n) e1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pointcoord.effects.arithmetic import Dual, P, cross, dot, ratio, reciprocal, times
from pointcoord.effects.corner import Corner, View

# Of a velocity: rates of solved points are off by some 1e-14 of themselves, and by far more near a singular
# pose, so that a part as small as this may be none.
LEAST_PART = 1e-9


def contact_place(corner: Corner[Dual[Any]]) -> Any:
    """Where the contact point is."""
    return corner.seen.contact_place().value


def velocity_at(corner: Corner[Dual[Any]], place: Any) -> Any:
    """The derivative of the point of the knuckle that is at a place."""
    base = corner.seen.points[corner.seen.of.role("knuckle")[0]]
    return base.slope + turning_of(corner, place - base.value)


def turning_of(corner: Corner[Dual[Any]], vector: Any) -> Any:
    """The derivative of a vector that is fixed in the knuckle."""
    e1, e2, normal = _frame(corner)
    n = normal.value
    square = dot(n, n)
    a = ratio(dot(cross(vector, e2.value), n), square)
    b = ratio(dot(cross(e1.value, vector), n), square)
    c = ratio(dot(vector, n), square)
    return times(a, e1.slope) + times(b, e2.slope) + times(c, normal.slope)


def told_from_none(part: Any, *of: Any) -> Any:
    """A part of a velocity; no number where rounding does not tell it from none.

    Args:
        of: the velocity, and vectors as long as what it is made of.
    """
    if not isinstance(part, np.ndarray):
        return part
    whole = sum(np.linalg.norm(vector, axis=-1) for vector in of)
    return np.where(np.abs(part) > LEAST_PART * whole, part, np.nan)


def rising(corner: Corner[Dual[Any]]) -> Any:
    """The derivative of the travel of the wheel centre; no number where the wheel does not travel."""
    view = corner.chassis
    return told_from_none(corner.risen().slope, view.points[view.of.centre].slope)


def angular_velocity(corner: Corner[Dual[Any]]) -> Any:
    """The turn of the knuckle along the way, rad per unit of the input."""
    e1, e2, _ = _frame(corner)
    return turn_of_edges(e1.value, e2.value, e1.slope, e2.slope)


def turn_of_edges(e1: P, e2: P, v1: P, v2: P) -> P:
    """The angular velocity of two edges of a body, from their derivatives."""
    n = cross(e1, e2)
    along = times(dot(v1, e2), n)
    across = times(dot(v2, n), e1) - times(dot(v1, n), e2)
    return times(reciprocal(dot(n, n)), along + across)


def _frame(corner: Corner[Dual[Any]]) -> tuple[Dual[Any], Dual[Any], Dual[Any]]:
    view = corner.seen
    base, first, second = (view.points[name] for name in view.of.role("knuckle")[:3])
    e1, e2 = first - base, second - base
    return e1, e2, cross(e1, e2)


def at_rest(view: View[Dual[Any]]) -> View[Any]:
    """What is seen, without derivatives."""
    points = {name: place.value for name, place in view.points.items()}
    return View(view.of, points, view.component, view.up.value, view.outboard.value, view.radius.value)
