r"""The effects that are numbers of the car, built from `numbers.toml` and the modules with their formulas.

*Gradients* are exact derivatives of every number of the car by wheel travel, rack travel, roll or time. With
points P, their derivatives P_q by one input q or by time, and a number N(P),

    by_rack:    N_P P_s                               s the input that steers, mm
    by_travel:  (N_P P_b) / (T_P P_b)                 b the other input, T the wheel centre's travel, mm
    by_roll:    N_P P_r                               r the input that turns the chassis lengthwise, rad
    by_time:    N_P P'                                with all inputs and the chassis moving

The formula of N gives N's derivative too, if its points are duals (see `arithmetic`).

*Conventions* say which of pointcoord's numbers other programs and standards mean by a name. A convention
changes no number: it says which number a name stands for, and whether its sign is reversed. In scenes and
comparisons every name has one meaning, so that two people who write "camber" mean the same.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, Literal

from pointcoord.effects import ackermann, anti_features, centres, damper, steering_axis, wheel
from pointcoord.effects.arithmetic import Dual, ratio
from pointcoord.effects.car_number import BY_TRAVEL, WHEEL, Angle, CarNumbers, Number
from pointcoord.effects.corner import Corner, rising
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
BY_TIME = "by_time"

ConventionName = Literal["iso", "paper", "lotus", "optimumk", "adams"]
CONVENTIONS: Mapping[ConventionName, Mapping[str, str]] = TABLES["conventions"]
"""Convention -> name -> pointcoord's number of that meaning, with a minus in front if reversed."""

OF_EFFECTS = ("gives", "nowhere", "of_axle", "apart", "gradients", "taken", "numbers")
OF_FORMULAS = ("formula", "screw", "file", "axis")


def _effects() -> Iterator[CarNumbers]:
    made: dict[str, Number] = {}
    for name, effect in TABLES["effects"].items():
        shared = {key: value for key, value in effect.items() if key not in OF_EFFECTS}
        entries = effect.get("numbers", {})
        for one, entry in entries.items():
            made[one] = _number(one, {**shared, **entry}, made)
        numbers = (made[one] for one in (*effect.get("taken", ()), *entries))
        own = {key: effect[key] for key in ("nowhere", "of_axle", "apart") if key in effect}
        yield CarNumbers.of(name, effect["gives"], *numbers, **own)


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
        names = TABLES["effects"]["steering_axis"]["numbers"].get(like.name, {}).get("formula", (like.name,))
        if isinstance(like, Angle):
            names, keys = ("lean", like.sine, like.cosine), {**keys, "quantity": WHEEL.name, "power": 0}
    keys["quantity"] = QUANTITIES[keys.get("quantity", "dimension")]
    # A function of the module with its first arguments bound, and applied to an axis of the wheel, if any.
    file = FILES[keys["file"]]
    formula = partial(getattr(file, names[0]), *names[1:])
    if axis := keys.get("axis"):
        formula = partial(steering_axis.of_axis, getattr(file, axis), formula)
    return Number(name=name, formula=formula, **{k: v for k, v in keys.items() if k not in OF_FORMULAS})


CAR_NUMBERS = {effect.name: effect for effect in _effects()}
"""The effects by name, in the order of results."""
WITH_GRADIENTS = tuple(
    effect for effect in CAR_NUMBERS.values() if TABLES["effects"][effect.name].get("gradients")
)
"""The effects whose numbers' derivatives are effects too."""


def gradients(base: CarNumbers, way: str) -> CarNumbers:
    """The effect that gives the derivatives of an effect's numbers along a way."""
    timed, entry = way == BY_TIME, WAYS[way]
    as_it_goes = "" if timed else f" {entry['words']}"
    gives = f"change per {entry['per']}{as_it_goes} of: {base.gives}"
    numbers = [_gradient(number, way) for number in base.numbers]
    return CarNumbers.of(f"{base.name}_{way}", gives, *numbers, base=base.name, derivative=int(timed))


def _gradient(number: Number, way: str) -> Number:
    timed, travels, entry = way == BY_TIME, way == BY_TRAVEL, WAYS[way]
    per = f"{entry['per']}{'' if timed else f' {way}'.replace('_', ' ')}"
    return Number(
        name=f"{number.name}_{way}",
        words=f"{number.words} per {per}",
        sign=f"where {number.words} grows {entry['words']}",
        definition=f"the derivative of `{number.name}` {entry['words']}",
        formula=partial(_by_travel if travels else _slope, number),
        roles=tuple(dict.fromkeys((*number.roles, *(("wheel_axis",) if travels else ())))),
        needs_radius=number.needs_radius,
        quantity=QUANTITIES[entry[number.quantity.unit]],
        way="" if timed else way,
        power=(number.quantity.unit == "mm") - travels,
    )


def _slope(number: Number, corner: Corner[Dual[Any]]) -> Any:
    return number.formula(corner).slope


def _by_travel(number: Number, corner: Corner[Dual[Any]]) -> Any:
    return ratio(number.formula(corner).slope, rising(corner))


def meant_by(name: str, convention: ConventionName) -> tuple[str, int]:
    """The number that a name stands for, and its sign; the name may be a part's or a gradient's.

    >>> meant_by("left.toe_by_travel", "optimumk")
    ('left.toe_by_arcsine_by_travel', -1)
    """
    part, dot, own = name.rpartition(".")
    way = next((f"_{way}" for way in WAYS if own.endswith(f"_{way}")), "")
    plain = own.removesuffix(way)
    meant = CONVENTIONS[convention].get(plain, plain)
    return f"{part}{dot}{meant.removeprefix('-')}{way}", -1 if meant.startswith("-") else 1
