"""Camber and kingpin angle by the paper's definitions, for either side and any orientation of the car.

For the left wheel in the paper's axes these are eqs. (17) and (16); `outboard` makes the right wheel its
mirror image.
"""

from __future__ import annotations

from pointcoord.effects.angle import Angle
from pointcoord.effects.camber import LEAN
from pointcoord.effects.car_number import CarNumbers

KINGPIN = Angle(
    name="kingpin",
    words="kingpin angle",
    sign="where the steering axis leans in at the top",
    line="steering_axis",
    sine="inboard",
    cosine="up",
    steepest=45.0,
    steepest_by_default=45.0,
)
WHEEL_ANGLES = CarNumbers.of("wheel_angles", "camber and kingpin angle, rad", LEAN, KINGPIN)
