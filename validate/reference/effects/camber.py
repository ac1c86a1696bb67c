"""Camber, eq. (17) of the paper: the lean of the wheel's spin axis w in the front view.

camber = atan2(-w . up, w . outboard)
"""

from __future__ import annotations

from validate.reference.effects.effect import Axes, Effect, angle
from validate.reference.vectors import Scalar, dot


def _camber(axes: Axes) -> Scalar:
    return angle(-dot(axes.wheel, axes.up), dot(axes.wheel, axes.outboard))


CAMBER = Effect("camber", "rad", "the wheel leans out at the top", _camber)
