"""The effects that there are: a line for each."""

from __future__ import annotations

from collections.abc import Mapping

from pointcoord.effects.acceleration import ACCELERATION
from pointcoord.effects.caster import CASTER
from pointcoord.effects.effect import Effect, Quantity
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES
from pointcoord.effects.position import POSITION
from pointcoord.effects.toe import TOE
from pointcoord.effects.velocity import VELOCITY
from pointcoord.effects.wheel_angles import WHEEL_ANGLES

ALWAYS: tuple[Effect, ...] = (POSITION,)
"""What every motion reports."""

EFFECTS: Mapping[str, Effect] = {
    effect.name: effect
    for effect in (
        VELOCITY,
        ACCELERATION,
        KNUCKLE_RATES,
        WHEEL_ANGLES,
        TOE,
        CASTER,
    )
}
"""What a scene may list, by name."""

QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity for effect in (*ALWAYS, *EFFECTS.values()) for quantity in effect.quantities
}
"""The kinds of numbers that a motion can report, in their order."""
