"""Toe, projected: how far the wheel points in."""

from absolute.effects.projected_angle import projected_angle

toe = projected_angle(
    name="toe",
    gives="angle of the wheel's spin axis against the car's right, seen from above",
    sign="+ where the wheel's front edge is nearer the car's middle: toe in",
    role="wheel_axis",
    rise=lambda corner: corner.forward,
    run=lambda corner: corner.outboard,
)
