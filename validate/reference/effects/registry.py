"""The effects that the reference knows, one line each."""

from __future__ import annotations

from validate.reference.effects.camber import CAMBER
from validate.reference.effects.caster import CASTER
from validate.reference.effects.effect import Effect
from validate.reference.effects.kingpin import KINGPIN
from validate.reference.effects.toe import TOE

EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        CAMBER,
        KINGPIN,
        TOE,
        CASTER,
    )
}
