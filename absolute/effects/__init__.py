"""The effects that the model can tell, by name."""

from collections.abc import Mapping, Sequence

from absolute.effects.camber import camber
from absolute.effects.caster import caster
from absolute.effects.effect import Effect
from absolute.effects.kingpin import kingpin
from absolute.effects.toe import toe
from absolute.errors import InputError
from absolute.mapping import ReadOnly

EFFECTS: Mapping[str, Effect] = ReadOnly(
    {
        effect.name: effect
        for effect in (
            camber,
            kingpin,
            toe,
            caster,
        )
    }
)


def effects_of(names: Sequence[str]) -> tuple[Effect, ...]:
    """The effects of some names.

    Raises:
        InputError: there is no such effect; it names those there are.
    """
    for name in names:
        if name not in EFFECTS:
            raise InputError(
                f"there is no effect {name!r}; it must be one of {list(EFFECTS)}", name, None, name
            )
    return tuple(EFFECTS[name] for name in names)
