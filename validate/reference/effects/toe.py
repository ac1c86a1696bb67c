"""Toe (ISO 8855, 7.1.6): how far the wheel's spin axis w points forward in the plan view.

toe = atan2(w . forward, w . outboard)
"""

from __future__ import annotations

from validate.reference.effects.effect import Axes, Effect, angle
from validate.reference.vectors import Scalar, dot


def _toe(axes: Axes) -> Scalar:
    return angle(dot(axes.wheel, axes.forward), dot(axes.wheel, axes.outboard))


TOE = Effect("toe", "rad", "the front edge of the wheel is nearer the car's middle", _toe)
