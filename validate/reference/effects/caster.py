"""Caster: the lean of the steering axis a in the side view.

caster = atan2(a . rearward, a . up),  rearward = -forward
"""

from __future__ import annotations

from validate.reference.effects.effect import Axes, Effect, angle
from validate.reference.vectors import Scalar, dot


def _caster(axes: Axes) -> Scalar:
    return angle(-dot(axes.steering, axes.forward), dot(axes.steering, axes.up))


CASTER = Effect("caster", "rad", "the steering axis leans rearward at the top", _caster)
