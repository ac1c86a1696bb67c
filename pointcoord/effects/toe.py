"""Toe: how the wheel points in or out, seen from above."""

from __future__ import annotations

from pointcoord.effects.angle import Angle
from pointcoord.effects.car_number import CarNumbers

TOE = CarNumbers.of(
    "toe",
    "toe angle, rad",
    Angle(
        name="toe",
        words="toe",
        sign="where the front edge of the wheel lies nearer the car's middle than its rear edge",
        line="wheel_axis",
        sine="forward",
        cosine="outboard",
    ),
)
