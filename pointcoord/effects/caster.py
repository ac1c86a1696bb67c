"""Caster: how the steering axis leans, seen from the side."""

from __future__ import annotations

from pointcoord.effects.angle import Angle, WheelAngles

CASTER = WheelAngles.of(
    "caster",
    "caster angle, rad",
    Angle(
        name="caster",
        words="caster",
        sign="where the steering axis leans rearward at the top",
        line="steering_axis",
        sine="rearward",
        cosine="up",
    ),
)
