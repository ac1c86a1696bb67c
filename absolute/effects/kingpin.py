"""Kingpin inclination, projected: how far the steering axis leans (the paper's eq. 16)."""

from absolute.effects.projected_angle import projected_angle

kingpin = projected_angle(
    name="kingpin",
    gives="angle of the steering axis against the car's up, seen from the front",
    sign="+ where the axis leans in at its top",
    role="steering_axis",
    rise=lambda corner: corner.inboard,
    run=lambda corner: corner.up,
)
