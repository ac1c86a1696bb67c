"""The effects that the reference knows: angles of the wheel's spin axis and of the steering axis."""

from __future__ import annotations

from validate.reference.effects.effect import STEERING, WHEEL, Axes, Effect, angle
from validate.reference.vectors import Scalar, dot


def _camber(axes: Axes) -> Scalar:
    """atan2(-w . up, w . outboard), eq. (17) of the paper: the lean of the spin axis w in the front view."""
    return angle(-dot(axes.wheel, axes.up), dot(axes.wheel, axes.outboard))


def _kingpin(axes: Axes) -> Scalar:
    """atan2(-a . outboard, a . up), eq. (16): the lean of the steering axis a in the front view."""
    return angle(-dot(axes.steering, axes.outboard), dot(axes.steering, axes.up))


def _toe(axes: Axes) -> Scalar:
    """atan2(w . forward, w . outboard): how far w points forward in the plan view (ISO 8855, 7.1.6)."""
    return angle(dot(axes.wheel, axes.forward), dot(axes.wheel, axes.outboard))


def _caster(axes: Axes) -> Scalar:
    """atan2(a . rearward, a . up), rearward = -forward: the lean of a in the side view."""
    return angle(-dot(axes.steering, axes.forward), dot(axes.steering, axes.up))


EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        Effect("camber", "rad", "the wheel leans out at the top", WHEEL, _camber),
        Effect("kingpin", "rad", "the steering axis leans in at the top", STEERING, _kingpin),
        Effect("toe", "rad", "the front edge of the wheel is nearer the car's middle", WHEEL, _toe),
        Effect("caster", "rad", "the steering axis leans rearward at the top", STEERING, _caster),
    )
}


def effects_of(axes: Axes) -> dict[str, Effect]:
    """Those whose axis the mechanism says."""
    return {name: effect for name, effect in EFFECTS.items() if effect.axis in axes.lines}
