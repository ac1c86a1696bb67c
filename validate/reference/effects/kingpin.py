"""Kingpin angle, eq. (16) of the paper: the lean of the steering axis a in the front view.

kingpin = atan2(-a . outboard, a . up)
"""

from __future__ import annotations

from validate.reference.effects.effect import Axes, Effect, angle
from validate.reference.vectors import Scalar, dot


def _kingpin(axes: Axes) -> Scalar:
    return angle(-dot(axes.steering, axes.outboard), dot(axes.steering, axes.up))


KINGPIN = Effect("kingpin", "rad", "the steering axis leans in at the top", _kingpin)
