"""Shipped mechanism files with a drawing, as the plain descriptions that the reference takes."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pointcoord
from validate.reference import Design, Instant, closed_drawing, count_assemblies, instants_of
from validate.reference.effects.registry import ANGLES
from validate.reference.route import CLEAR

MECHANISMS = Path(pointcoord.__file__).parent / "mechanisms"
DRIVEN = ("arm_angle", "rack", "heave")
UP, RIGHT = (0, 0, 1), (0, 1, 0)
Points = Mapping[str, Sequence[Any]]


@cache
def _tables(name: str) -> dict[str, Any]:
    return tomllib.loads((MECHANISMS / f"{name}.toml").read_text(encoding="utf-8"))


def plain_mechanism(
    name: str,
    points: Points,
    driven: Sequence[str] = DRIVEN,
    up: Sequence[Any] = UP,
    right: Sequence[Any] = RIGHT,
    side: str = "left",
    closure: str = "drawn",
    wheel_radius: object = None,
    car: Mapping[str, object] | None = None,
) -> dict[str, Any]:
    """A shipped file and a drawing, mm, flattened."""
    tables = _tables(name)
    closing = {} if closure == "drawn" else tables["closures"][closure]
    merged = {k: {**tables.get(k, {}), **closing.get(k, {})} for k in ("rods", "slides", "inputs", "roles")}
    stand_ins = tables.get("stand_ins", {})
    chassis = tables["bodies"]["chassis"]
    drawn = {**{p: points[q] for p, q in stand_ins.items() if p in chassis and q in points}, **points}

    def there(who: Any) -> Any:
        return who if isinstance(who, str) else [p if p in drawn else stand_ins[p] for p in who]

    return {
        "name": name,
        "bodies": {body: [p for p in ps if p in drawn] for body, ps in tables["bodies"].items()},
        "rods": merged["rods"],
        "slides": {
            slide: {
                "points": spec.get("points", [spec.get("point")]),
                "body": spec.get("body", "chassis"),
                "through": spec["through"],
                "along": spec["along"],
                "turns": spec.get("turns", True),
            }
            for slide, spec in merged["slides"].items()
        },
        "inputs": {one: full_input(merged["inputs"][one]) for one in driven},
        "roles": {role: there(who) for role, who in merged["roles"].items()},
        "points": drawn,
        "up": up,
        "right": right,
        "side": side,
        "wheel_radius": wheel_radius,
        "car": car or {},
    }


def full_input(spec: Mapping[str, Any]) -> dict[str, Any]:
    """An input's table with what may be left out."""
    full = dict(spec)
    if isinstance(full.get("travel"), str):
        full["travel"] = [full["travel"]]
    if "height" in full:
        full.setdefault("along", "up")
    if full.get("from") == "drawing":
        full.setdefault("on", "chassis")
    return full


def design_of(points: Points, suspension: str = "macpherson", **settings: Any) -> Design:
    """The reference's own of a shipped suspension that arm angle, rack and heave drive."""
    return Design.from_plain(plain_mechanism(suspension, points, **settings))


def solve_car(
    points: Points,
    inputs: Mapping[str, Any],
    digits: int = 60,
    clearness: float = CLEAR,
    effects: Sequence[str] = ANGLES,
    **settings: Any,
) -> Instant:
    """The reference at one instant of it."""
    return next(instants_of(design_of(points, **settings), [inputs], digits, clearness, effects))


def close_car(points: Points, digits: int = 60, clearness: float = CLEAR, **settings: Any) -> Any:
    """Its closed drawing."""
    return closed_drawing(design_of(points, **settings), digits, clearness)


def count_car(
    points: Points, inputs: Mapping[str, Any], starts: int = 1000, seed: int = 0, **settings: Any
) -> Any:
    """What a search finds of its assemblies."""
    return count_assemblies(design_of(points, **settings), inputs, starts, seed)
