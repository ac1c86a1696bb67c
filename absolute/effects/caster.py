"""Caster, projected: how far the steering axis leans rearward."""

from absolute.effects.projected_angle import projected_angle

caster = projected_angle(
    name="caster",
    gives="angle of the steering axis against the car's up, seen from the side",
    sign="+ where the axis leans rearward at its top",
    role="steering_axis",
    rise=lambda corner: corner.rearward,
    run=lambda corner: corner.up,
)
