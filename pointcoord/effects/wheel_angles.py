"""How the wheel leans and points, and how its steering axis leans: angles of a line, for either side.

For the left wheel in the paper's axes kingpin angle and camber are its eqs. (16) and (17); `outboard` makes
the right wheel its mirror image.
"""

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
POINTING = Angle(
    name="toe",
    words="toe",
    sign="where the front edge of the wheel lies nearer the car's middle than its rear edge",
    line="wheel_axis",
    sine="forward",
    cosine="outboard",
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
)
LEAN_REARWARD = Angle(
    name="caster",
    words="caster",
    sign="where the steering axis leans rearward at the top",
    line="steering_axis",
    sine="rearward",
    cosine="up",
)
CAMBER = CarNumbers.of("camber", "camber angle, rad", LEAN)
WHEEL_ANGLES = CarNumbers.of("wheel_angles", "camber and kingpin angle, rad", LEAN, KINGPIN)
TOE = CarNumbers.of("toe", "toe angle, rad", POINTING)
STEER_ANGLE = CarNumbers.of("steer_angle", "steer angle, rad", STEER)
CASTER = CarNumbers.of("caster", "caster angle, rad", LEAN_REARWARD)
