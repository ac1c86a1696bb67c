"""The table of the page of effects, from what the effects say of themselves.

python -m tests.support.table_of_effects        the table, Markdown
"""

from collections.abc import Iterator

from pointcoord.effects.car_number import CarNumbers
from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS

HEAD = ("effect", "number", "definition", "positive", "unit", "source")


def rows() -> list[tuple[str, ...]]:
    """Number, definition, sign, unit and source of each number, after the effects that give it.

    Gradients are left out: each is the derivative of a number that is in the table.
    """
    found: dict[tuple[str, ...], list[str]] = {}
    for effect in EFFECTS.values():
        if not effect.base:
            for said in _said(effect):
                found.setdefault(said, []).append(f"`{effect.name}`")
    return [(", ".join(effects), f"`{name}`", *rest) for (name, *rest), effects in found.items()]


def _said(effect: Effect) -> Iterator[tuple[str, ...]]:
    if isinstance(effect, CarNumbers):
        for number in effect.numbers:
            definition = f"{number.words}: {number.definition}"
            yield number.name, definition, number.sign, number.quantity.unit, number.source
        return
    for one in effect.quantities:
        definition = f"{one.words} of every {one.of}"
        if one.definition:
            definition = f"{one.words}: {one.definition}"
        yield one.name, definition, one.sign, one.unit, ""


def table() -> str:
    """As the page has it."""
    lines = (HEAD, ["---"] * len(HEAD), *rows())
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


if __name__ == "__main__":
    print(table())
