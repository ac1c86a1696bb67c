"""Caster: how the steering axis leans, seen from the side."""

from __future__ import annotations

from pointcoord.effects.angle import Angle
from pointcoord.effects.car_number import CarNumbers

LEAN_REARWARD = Angle(
    name="caster",
    words="caster",
    sign="where the steering axis leans rearward at the top",
    line="steering_axis",
    sine="rearward",
    cosine="up",
)
CASTER = CarNumbers.of("caster", "caster angle, rad", LEAN_REARWARD)
