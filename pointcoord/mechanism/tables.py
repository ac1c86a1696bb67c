"""The tables of a mechanism file, checked one by one and made into a structure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import TableFault, no_such
from pointcoord.mechanism.structure import CHASSIS, Ends, Input, Role, Slide, Structure
from pointcoord.wording import shown

CLOSING = ("bodies", "rods", "slides", "inputs", "roles", "stand_ins")
"""Tables with entries by name, which a closure may put others in place of."""
TABLES = (*CLOSING, "closures", "parts")
PAIR_ROLES = ("wheel_axis", "steering_axis", "front_and_rear", "damper")
ROLES = ("knuckle", *PAIR_ROLES, "inboard")
SLIDE_KEYS = ("point", "points", "body", "through", "along", "turns")

Kind = tuple[str, Mapping[str, str], Mapping[str, str]]

# By the key that tells the kind: its keys with what they hold, and those that may be left out.
KINDS: Mapping[str, Kind] = {
    "travel": ("travel", {"travel": "slides"}, {}),
    "height": ("height", {"height": "point", "along": "direction"}, {"along": "up"}),
    "contact": ("contact", {"contact": "pair"}, {}),
    "distance": ("distance", {"distance": "pair"}, {}),
    "moves": ("moves", {"moves": "chassis", "along": "direction"}, {}),
    "turns": ("turns", {"turns": "chassis", "about": "point", "along": "direction"}, {}),
}
ARM: Kind = ("arm", {"angle": "body", "of": "point", "about": "point", "from": "direction"}, {})
TURN: Kind = ("turn", {"angle": "body", "from": "drawing", "on": "body"}, {"on": CHASSIS})
WANTED = {
    "point": "the name of a point",
    "body": "the name of a body",
    "slides": "the name of a slide, or a list of such names",
    "direction": f"one of {', '.join(DIRECTIONS)}",
    "drawing": '"drawing"',
    "chassis": f'"{CHASSIS}"',
    "pair": "two different points, such as [P, Q]",
}


def structure_of(tables: Mapping[str, Any], name: str) -> Structure:
    """The tables as they stand, each entry checked by itself; parts and closures are not looked at."""
    return Structure(
        name=name,
        bodies={body: _body(body, points) for body, points in _entries(tables, "bodies")},
        rods={rod: _pair(ends, ("rods", rod)) for rod, ends in _entries(tables, "rods")},
        slides={slide: _slide(slide, table) for slide, table in _entries(tables, "slides")},
        inputs={one: _input(one, table) for one, table in _entries(tables, "inputs")},
        roles={role: _role(role, who) for role, who in _entries(tables, "roles")},
        stand_ins={
            point: _name(other, ("stand_ins", point), "the name of the point that stands in for it")
            for point, other in _entries(tables, "stand_ins")
        },
    )


def table_at(tables: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """A table by name; empty if it is left out."""
    table = tables.get(name)
    if table is None:
        return {}
    if not isinstance(table, Mapping):
        raise TableFault((name,), f"should be a table, not {shown(table)}")
    return table


def _entries(tables: Mapping[str, Any], name: str) -> list[tuple[str, Any]]:
    return list(table_at(tables, name).items())


def _name(value: object, place: tuple[str, ...], wanted: str) -> str:
    if not isinstance(value, str) or not value:
        raise TableFault(place, f"is {shown(value)}", wanted)
    return value


def _names(value: object, place: tuple[str, ...], wanted: str) -> tuple[str, ...]:
    if not isinstance(value, list | tuple) or not all(isinstance(each, str) and each for each in value):
        raise TableFault(place, f"is {shown(value)}", wanted)
    names = tuple(value)
    for at, each in enumerate(names):
        if each in names[:at]:
            raise TableFault(place, f"{each!r} is named twice", "each name once")
    return names


def _body(body: str, points: object) -> tuple[str, ...]:
    names = _names(points, ("bodies", body), 'a list of points, such as ["a", "b", "c"]')
    if body != CHASSIS and len(names) < 3:
        hint = "; write it in [rods]" if len(names) == 2 else ""
        raise TableFault(
            ("bodies", body),
            f"has {len(names)} point{'' if len(names) == 1 else 's'}{hint}",
            "three points that are not in one line, or more",
        )
    return names


def _pair(ends: object, place: tuple[str, ...]) -> Ends:
    if isinstance(ends, list | tuple) and len(ends) == 2 and ends[0] == ends[1]:
        raise TableFault(place, f"goes from {shown(ends[0])} to itself, so it has no length", WANTED["pair"])
    names = _names(ends, place, WANTED["pair"])
    if len(names) != 2:
        raise TableFault(place, f"has {len(names)} point{'' if len(names) == 1 else 's'}", WANTED["pair"])
    return names[0], names[1]


def _table(value: object, place: tuple[str, ...], example: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise TableFault(place, f"is {shown(value)}", f"a table, such as {example}")
    return value


def _slide(slide: str, value: object) -> Slide:
    place = ("slides", slide)
    table = _table(value, place, '{ point = "a", through = "b", along = "left" }')
    for key in table:
        if key not in SLIDE_KEYS:
            raise no_such("key of a slide", key, SLIDE_KEYS, (*place, key))
    if ("point" in table) == ("points" in table):
        raise TableFault(place, "needs a point", "either point or points")
    if "point" in table:
        points: tuple[str, ...] = (_name(table["point"], (*place, "point"), WANTED["point"]),)
    else:
        points = _names(table["points"], (*place, "points"), "a list of points")
        if not points:
            raise TableFault((*place, "points"), "is empty", "one point or more")
    for key in ("through", "along"):
        if key not in table:
            raise TableFault((*place, key), "this key is missing", WANTED["point"])
    turns = table.get("turns", True)
    if not isinstance(turns, bool):
        raise TableFault((*place, "turns"), f"is {shown(turns)}", "true or false")
    if not turns and len(points) < 2:
        raise TableFault((*place, "turns"), "a single point has no turn to be kept from", "two points")
    return Slide(
        points,
        _name(table.get("body", CHASSIS), (*place, "body"), WANTED["body"]),
        _name(table["through"], (*place, "through"), WANTED["point"]),
        _name(table["along"], (*place, "along"), f"{WANTED['direction']}, or the name of a point"),
        turns,
    )


def _input(name: str, value: object) -> Input:
    place = ("inputs", name)
    table = _table(value, place, '{ height = "a" }')
    if "angle" in table:
        kind, keys, defaults = TURN if table.get("from") == "drawing" else ARM
    else:
        found = [key for key in table if key in KINDS]
        if len(found) != 1:
            wrong = f"is of {len(found)} kinds" if found else "is of no kind"
            hint = next((key for key in table if key not in ("along", "about")), "")
            if not found and hint:
                raise no_such("kind of input", hint, ("angle", *KINDS), (*place, hint))
            raise TableFault(place, wrong, f"one of {', '.join(('angle', *KINDS))}")
        kind, keys, defaults = KINDS[found[0]]
    for key in table:
        if key not in keys:
            raise no_such(f"key of an input by {next(iter(keys))}", key, keys, (*place, key))
    for key, what in keys.items():
        if key not in table and key not in defaults:
            raise TableFault((*place, key), "this key is missing", WANTED[what])
    whole = {**defaults, **table}
    return Input(kind, tuple((key, _value(whole[key], what, (*place, key))) for key, what in keys.items()))


def _value(value: object, what: str, place: tuple[str, ...]) -> str | tuple[str, ...]:
    if what == "pair":
        return _pair(value, place)
    if what == "slides":
        names = (value,) if isinstance(value, str) else value
        found = _names(names, place, WANTED[what])
        if not found:
            raise TableFault(place, "is empty", WANTED[what])
        return found
    name = _name(value, place, WANTED[what])
    if what == "direction" and name not in DIRECTIONS:
        raise no_such("direction", name, DIRECTIONS, place)
    if what == "chassis" and name != CHASSIS:
        raise TableFault(place, f"is {shown(name)}", WANTED[what])
    return name


def _role(role: str, who: object) -> Role:
    place, last = ("roles", role), role.rpartition(".")[2]
    if last not in ROLES:
        raise no_such("role", role, ROLES, place)
    if last in PAIR_ROLES:
        return _pair(who, place)
    return _name(who, place, "the name of a body" if last == "knuckle" else WANTED["point"])
