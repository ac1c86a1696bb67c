"""Steer angle: how a wheel is turned to the left or to the right, seen from above."""

from __future__ import annotations

from pointcoord.effects.angle import Angle
from pointcoord.effects.car_number import CarNumbers

STEER = Angle(
    name="steer_angle",
    words="steer angle",
    sign="where the wheel is turned to the left",
    line="wheel_axis",
    sine="to_the_left",
    cosine="outboard",
)
STEER_ANGLE = CarNumbers.of("steer_angle", "steer angle, rad", STEER)
