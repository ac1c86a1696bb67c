"""The effects that are numbers of the car, built from `numbers.toml` and the modules with their formulas."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from pointcoord.effects import ackermann, anti_features, centres, damper, steering_axis, wheel
from pointcoord.effects.angle import WHEEL, Angle
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.effect import Quantity

Entry = Mapping[str, Any]

TABLES: Mapping[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
FILES = {
    module.__name__.rpartition(".")[2]: module
    for module in (ackermann, anti_features, centres, damper, steering_axis, wheel)
}
QUANTITIES = {WHEEL.name: WHEEL} | {
    name: Quantity(name, entry["words"], entry["unit"], "car") for name, entry in TABLES["quantities"].items()
}
WAYS: Mapping[str, Mapping[str, str]] = TABLES["ways"]
"""Way -> its words, its unit, and the quantities of an angle and of a length per unit of the way."""
READ_FIRST: tuple[str, ...] = tuple(TABLES["read_first"])
"""The numbers that a table shows by default, as far as a car has them."""
RANKED_FIRST: tuple[str, ...] = tuple(TABLES["ranked_first"])
"""The numbers whose hardpoints are ranked by default, as far as a car has them."""

OF_EFFECTS = ("gives", "nowhere", "of_axle", "gradients", "taken", "numbers")
OF_FORMULAS = ("formula", "screw", "file", "axis")


def _effects() -> Iterator[CarNumbers]:
    made: dict[str, Number] = {}
    for name, effect in TABLES["effects"].items():
        shared = {key: value for key, value in effect.items() if key not in OF_EFFECTS}
        entries = effect.get("numbers", {})
        for one, entry in entries.items():
            made[one] = _number(one, {**shared, **entry}, made)
        numbers = (made[one] for one in (*effect.get("taken", ()), *entries))
        nowhere, of_axle = effect.get("nowhere", ""), effect.get("of_axle", False)
        yield CarNumbers.of(name, effect["gives"], *numbers, nowhere=nowhere, of_axle=of_axle)


def _number(name: str, entry: Entry, made: Mapping[str, Number]) -> Number:
    keys: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in entry.items()
    }
    if "line" in keys:
        return Angle(name=name, **keys)
    names = keys.get("formula", (name,))
    if "screw" in keys:
        like = made[keys["screw"]]
        keys |= {"words": f"{like.words} of the screw axis", "sign": like.sign}
        keys |= {"definition": f"`{like.name}` with the screw axis in place of k"}
        names = (like.name,)
        if isinstance(like, Angle):
            names, keys = ("lean", like.sine, like.cosine), {**keys, "quantity": WHEEL.name, "power": 0}
    keys["quantity"] = QUANTITIES[keys.get("quantity", "dimension")]
    formula = _formula(FILES[keys["file"]], names, keys.get("axis", ""))
    return Number(name=name, formula=formula, **{k: v for k, v in keys.items() if k not in OF_FORMULAS})


def _formula(file: ModuleType, names: tuple[str, ...], axis: str) -> Callable[..., Any]:
    """A function of a module with its first arguments bound; with `axis`, applied to that axis of a wheel."""
    formula = getattr(file, names[0])
    if len(names) > 1:
        formula = partial(formula, *names[1:])
    return partial(steering_axis.of_axis, getattr(file, axis), formula) if axis else formula


CAR_NUMBERS = {effect.name: effect for effect in _effects()}
"""The effects by name, in the order of results."""
WITH_GRADIENTS = tuple(
    effect for effect in CAR_NUMBERS.values() if TABLES["effects"][effect.name].get("gradients")
)
"""The effects whose numbers' derivatives are effects too."""
