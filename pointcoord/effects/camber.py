"""Camber by the paper's definition, eq. (17) in its axes: how the wheel leans, seen from the front."""

from __future__ import annotations

from pointcoord.effects.angle import Angle
from pointcoord.effects.car_number import CarNumbers

LEAN = Angle(
    name="camber",
    words="camber",
    sign="where the wheel leans out at the top",
    line="wheel_axis",
    sine="down",
    cosine="outboard",
    steepest=45.0,
    steepest_by_default=10.0,
)
CAMBER = CarNumbers.of("camber", "camber angle, rad", LEAN)
