"""Camber, projected: how far the wheel leans (the paper's eq. 17)."""

from absolute.effects.projected_angle import projected_angle

camber = projected_angle(
    name="camber",
    gives="angle of the wheel's spin axis against the car's right, seen from the front",
    sign="+ where the wheel leans out at its top",
    role="wheel_axis",
    rise=lambda corner: corner.down,
    run=lambda corner: corner.outboard,
)
