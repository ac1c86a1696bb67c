"""How what is fixed in the knuckle moves along a way: places, and directions.

Of three points p_0, p_1, p_2 of the knuckle with e1 = p_1 - p_0 and e2 = p_2 - p_0, a vector that is fixed in
it is a e1 + b e2 + c e1 x e2 with constant a, b, c; so its derivative is a e1' + b e2' + c (e1 x e2)'.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.arithmetic import Dual, cross, dot, ratio, times
from pointcoord.effects.corner import Corner, View
from pointcoord.linkage.car_axes import Direction


def contact_place(corner: Corner[Dual[Any]]) -> Any:
    """Where the contact point is."""
    return corner.seen.contact_place().value


def velocity_at(corner: Corner[Dual[Any]], place: Any) -> Any:
    """The derivative of the point of the knuckle that is at a place."""
    base = corner.seen.points[corner.seen.of.role("knuckle")[0]]
    return base.slope + turning_of(corner, place - base.value)


def turning_of(corner: Corner[Dual[Any]], vector: Any) -> Any:
    """The derivative of a vector that is fixed in the knuckle."""
    view = corner.seen
    base, first, second = (view.points[name] for name in view.of.role("knuckle")[:3])
    e1, e2 = first - base, second - base
    normal = cross(e1, e2)
    n = normal.value
    square = dot(n, n)
    a = ratio(dot(cross(vector, e2.value), n), square)
    b = ratio(dot(cross(e1.value, vector), n), square)
    c = ratio(dot(vector, n), square)
    return times(a, e1.slope) + times(b, e2.slope) + times(c, normal.slope)


def component(view: View[Dual[Any]], vector: Any, direction: Direction) -> Any:
    """The component of a vector that has no derivative."""
    return view.along(Dual(vector, vector), direction).value
