r"""Camber and toe as arcsines of a component of the spin axis, as some programs have them.

With n of length 1 they are -asin(n . up) and asin(n . forward), where others project n into a plane first.
Adams/Car's turning tables have this camber, up to 0.18 degrees from the projected one at steering lock;
OptimumK has this toe, 0.999229 degrees where the projected one is 1 and camber is 2.25.
"""

from __future__ import annotations

from pointcoord.effects.angle import WHEEL
from pointcoord.effects.arithmetic import S, angle, root
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.corner import Corner


def camber_by_arcsine(corner: Corner[S]) -> S:
    """-asin(n . up)."""
    up, forward, outboard = _components(corner)
    return -angle(up, root(forward * forward + outboard * outboard))


def toe_by_arcsine(corner: Corner[S]) -> S:
    """asin(n . forward)."""
    up, forward, outboard = _components(corner)
    return angle(forward, root(up * up + outboard * outboard))


def _components(corner: Corner[S]) -> tuple[S, S, S]:
    view = corner.seen
    return view.along(view.spin, "up"), view.along(view.spin, "forward"), view.along(view.spin, "outboard")


ANGLES_BY_ARCSINE = CarNumbers.of(
    "angles_by_arcsine",
    "camber and toe as arcsines, rad",
    Number(
        "camber_by_arcsine",
        "camber by arcsine",
        "where the wheel leans out at the top",
        camber_by_arcsine,
        needs_radius=False,
        quantity=WHEEL,
        power=0,
    ),
    Number(
        "toe_by_arcsine",
        "toe by arcsine",
        "where the front edge of the wheel lies nearer the car's middle than its rear edge",
        toe_by_arcsine,
        needs_radius=False,
        quantity=WHEEL,
        power=0,
    ),
)
