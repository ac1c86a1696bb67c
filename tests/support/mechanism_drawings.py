"""Mechanisms of every kind with a drawing: shipped files, and small ones that are known by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any

from mechanism_files import full_input, plain_scene
from reference_cars import CARS

from validate.reference import Design

Points = Mapping[str, Sequence[Any]]


def described(
    points: Points,
    bodies: Mapping[str, Sequence[str]],
    inputs: Mapping[str, Mapping[str, Any]],
    rods: Mapping[str, Sequence[str]] | None = None,
    slides: Mapping[str, Mapping[str, Any]] | None = None,
    **others: Any,
) -> dict[str, Any]:
    """A description of its own, what may be left out filled in."""
    default = {"body": "chassis", "turns": True}
    return {
        "name": "by hand",
        "points": points,
        "bodies": {name: list(names) for name, names in bodies.items()},
        "inputs": {name: full_input(spec) for name, spec in inputs.items()},
        "rods": rods or {},
        "slides": {name: {**default, **spec} for name, spec in (slides or {}).items()},
        "roles": {},
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "side": "left",
        "wheel_radius": None,
        **others,
    }


def joined(parts: Mapping[str, dict[str, Any]], **inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Descriptions on one chassis as parts of one, names behind their part's; further inputs of the whole."""
    whole: dict[str, Any] = {"bodies": {"chassis": []}}

    for part, plain in parts.items():
        name = {known: f"{part}.{known}" for key in ("points", "bodies", "slides") for known in plain[key]}
        name["chassis"] = "chassis"

        def renamed(value: Any, name: dict[str, str] = name) -> Any:
            if isinstance(value, Mapping):
                return {key: renamed(one) for key, one in value.items()}
            if isinstance(value, list | tuple):
                return [renamed(one) for one in value]
            return name.get(value, value) if isinstance(value, str) else value

        for key in ("points", "rods", "slides", "inputs", "roles", "loads"):
            tables = plain.get(key, {}).items()
            whole[key] = whole.get(key, {}) | {f"{part}.{n}".rstrip("."): renamed(one) for n, one in tables}
        for body, points in plain["bodies"].items():
            whole["bodies"][name[body]] = whole["bodies"].get(name[body], []) + renamed(points)
        whole = {**plain, **whole}
    sides = {part: plain["side"] for part, plain in parts.items()}
    return {**whole, "sides": sides, "inputs": {**whole["inputs"], **inputs}}


# A crank of 3 about z drives a slider 5 above its plane by a rod of 13: x = 3 cos + sqrt(144 - 9 sin^2).
SLIDER_CRANK = described(
    {"o": (0, 0, 0), "above": (0, 0, 1), "a": (3, 0, 0), "b": (15, 0, 5), "rail": (0, 0, 5)},
    {"chassis": ["o", "above", "rail"], "crank": ["o", "above", "a"]},
    {"turn": {"angle": "crank", "from": "drawing"}},
    rods={"rod": ["a", "b"]},
    slides={"rail": {"points": ["b"], "through": "rail", "along": "rearward"}},
)
# A crank of 2 about z, a rocker of 6 about a line along y through (10, 0, 0), and a rod between their ends.
FOUR_BAR = described(
    {
        "o": (0, 0, 0),
        "above": (0, 0, 1),
        "a": (2, 0, 0),
        "p": (10, 0, 0),
        "beside": (10, 1, 0),
        "b": (10, 3, 6),
    },
    {"chassis": ["o", "above", "p", "beside"], "crank": ["o", "above", "a"], "rocker": ["p", "beside", "b"]},
    {"turn": {"angle": "crank", "from": "drawing"}},
    rods={"rod": ["a", "b"]},
)
# Two arms of 4 and 3 one on the other, each about z; the second is turned against the first.
DOUBLE_ARM = described(
    {"o": (0, 0, 0), "o2": (0, 0, 1), "e": (4, 0, 0), "e2": (4, 0, 2), "tip": (7, 0, 0)},
    {"chassis": ["o", "o2"], "upper": ["o", "o2", "e", "e2"], "fore": ["e", "e2", "tip"]},
    {
        "shoulder": {"angle": "upper", "from": "drawing"},
        "elbow": {"angle": "fore", "from": "drawing", "on": "upper"},
    },
)
# A block on a rail along (3, 4, 0) that may not turn.
BLOCK = described(
    {"rail": (0, 0, 0), "end": (30, 40, 0), "front": (3, 4, 0), "rear": (6, 8, 0), "side": (1, 2, 3)},
    {"chassis": ["rail", "end"], "block": ["front", "rear", "side"]},
    {"push": {"travel": "rail"}},
    slides={"rail": {"points": ["front", "rear"], "through": "rail", "along": "end", "turns": False}},
)
DRAWINGS: dict[str, Callable[[], Design]] = {
    **{name: cache(partial(getattr, car, "design")) for name, car in CARS.items()},
    "five links": cache(lambda: Design.from_plain(plain_scene("five-link"))),
    "semi-trailing arm": cache(lambda: Design.from_plain(plain_scene("semi-trailing-arm"))),
    "slider crank": cache(lambda: Design.from_plain(SLIDER_CRANK)),
    "four-bar": cache(lambda: Design.from_plain(FOUR_BAR)),
    "double arm": cache(lambda: Design.from_plain(DOUBLE_ARM)),
    "block": cache(lambda: Design.from_plain(BLOCK)),
}
