"""How the wheel leans and points, and how its steering axis leans: angles of a line, for either side.

For the left wheel in the paper's axes kingpin angle and camber are its eqs. (16) and (17); `outboard` makes
the right wheel its mirror image.

With n the spin axis, of length 1, some programs have the arcsines -asin(n . up) and asin(n . forward) for
camber and toe, where others project n into a plane first. Adams/Car's turning tables have this camber, up to
0.18 degrees from the projected one at steering lock; OptimumK has this toe, 0.999229 degrees where the
projected one is 1 and camber is 2.25.
"""

from __future__ import annotations

from typing import Any

from pointcoord.effects.angle import WHEEL, Angle
from pointcoord.effects.arithmetic import S, angle, root
from pointcoord.effects.car_number import CarNumbers, Number
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


def _arcsine(of: str, sign: str, definition: str, formula: Any, source: str) -> Number:
    return Number(
        f"{of}_by_arcsine",
        f"{of} by arcsine".replace("_", " "),
        sign,
        definition,
        formula,
        needs_radius=False,
        quantity=WHEEL,
        power=0,
        source=source,
    )


LEAN = Angle(
    name="camber",
    words="camber",
    sign="where the wheel leans out at the top",
    line="wheel_axis",
    sine="down",
    cosine="outboard",
    steepest=45.0,
    steepest_by_default=10.0,
    source="paper, eq. 17; Lotus",
)
POINTING = Angle(
    name="toe",
    words="toe",
    sign="where the front edge of the wheel lies nearer the car's middle than its rear edge",
    line="wheel_axis",
    sine="forward",
    cosine="outboard",
    source="ISO 8855, 7.1.6; Lotus",
)
STEER = Angle(
    name="steer_angle",
    words="steer angle",
    sign="where the wheel is turned to the left",
    line="wheel_axis",
    sine="to_the_left",
    cosine="outboard",
)
KINGPIN = Angle(
    name="kingpin",
    words="kingpin angle",
    sign="where the steering axis leans in at the top",
    line="steering_axis",
    sine="inboard",
    cosine="up",
    steepest=45.0,
    steepest_by_default=45.0,
    source="paper, eq. 16; Lotus",
)
LEAN_REARWARD = Angle(
    name="caster",
    words="caster",
    sign="where the steering axis leans rearward at the top",
    line="steering_axis",
    sine="rearward",
    cosine="up",
    source="all",
)
CAMBER = CarNumbers.of("camber", "camber angle, rad", LEAN)
WHEEL_ANGLES = CarNumbers.of("wheel_angles", "camber and kingpin angle, rad", LEAN, KINGPIN)
TOE = CarNumbers.of("toe", "toe angle, rad", POINTING)
STEER_ANGLE = CarNumbers.of("steer_angle", "steer angle, rad", STEER)
CASTER = CarNumbers.of("caster", "caster angle, rad", LEAN_REARWARD)
ANGLES_BY_ARCSINE = CarNumbers.of(
    "angles_by_arcsine",
    "camber and toe as arcsines, rad",
    _arcsine("camber", LEAN.sign, "-asin(n . up)", camber_by_arcsine, "Adams/Car's turning tables"),
    _arcsine("toe", POINTING.sign, "asin(n . forward)", toe_by_arcsine, "OptimumK"),
)
TOE_CHANGE_BY_ARCSINE = CarNumbers.of(
    "toe_change_by_arcsine",
    "what toe is more than as drawn, as arcsines, rad",
    _arcsine(
        "toe_change",
        "where the front edge of the wheel has gone towards the car's middle",
        "`toe_by_arcsine` less that of the drawn n",
        toe_change_by_arcsine,
        "OptimumK's steer angle, which is counted outward",
    ),
)
