"""Checks the names of a mechanism, and whether its bodies, rods and slides can be joined as given."""

from __future__ import annotations

from collections.abc import Collection
from itertools import combinations

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import TableFault, known_name, no_such, under
from pointcoord.mechanism.inputs import CHASSIS, check_apart
from pointcoord.mechanism.structure import Structure


def check(structure: Structure) -> None:
    """Check that the entries of a mechanism agree with each other.

    Raises:
        TableFault: the first fault.
    """
    _bodies(structure)
    _rods(structure)
    known: dict[str, Collection[str]] = {
        "body": structure.bodies,
        "slide": structure.slides,
        "point": structure.points,
        "direction": DIRECTIONS,
        "direction or point": (*DIRECTIONS, *structure.points),
    }
    for table, entries in (("slides", structure.slides), ("inputs", structure.inputs)):
        for name, entry in entries.items():
            with under(table, name):
                for key, kind, each in entry.names():
                    known_name(kind, each, known[kind], (key,))
                entry.check(structure.bodies)
    _roles(structure)
    for point, other in structure.stand_ins.items():
        for name in (point, other):
            known_name("point", name, structure.points, ("stand_ins", point))
        if point == other:
            raise TableFault(("stand_ins", point), f"is {other!r}, the omitted point itself", "another point")


def _bodies(structure: Structure) -> None:
    if not structure.bodies.get(CHASSIS):
        problem = f"the body {CHASSIS!r}, the ground, is missing or has no points"
        raise TableFault(("bodies",), problem, f"a body {CHASSIS!r}")
    for (one, points), (other, others) in combinations(structure.bodies.items(), 2):
        both = [name for name in points if name in others]
        if len(both) > 2:
            raise TableFault(
                ("bodies", other),
                f"shares {', '.join(both)} with {one}: three shared points make the two one rigid body",
                "one shared point (a ball joint) or two (a hinge); or write the two as one body",
            )
    for body, points in structure.moving_bodies.items():
        if len(points) < 3:
            allowed = "three points or more, not all in one line; a body of two points is written in [rods]"
            raise TableFault(("bodies", body), f"has the points {', '.join(points) or 'none'}", allowed)
        if structure.attached.isdisjoint(points) and all(
            len(structure.bodies_of(name)) == 1 for name in points
        ):
            allowed = "a point that it shares with another body, a rod or a slide"
            raise TableFault(("bodies", body), "nothing holds this body", allowed)


def _rods(structure: Structure) -> None:
    ends = [end for pair in structure.rods.values() for end in pair]
    sliding = {point for slide in structure.slides.values() for point in slide.points}
    for rod, pair in structure.rods.items():
        with under("rods", rod):
            check_apart(pair, structure.bodies)
        for end in pair:
            if not structure.bodies_of(end) and end not in sliding and ends.count(end) < 2:
                known = (name for name in structure.points if name != end)
                raise no_such("point of a body or slide", end, known, ("rods", rod))


def _roles(structure: Structure) -> None:
    """Check names in roles, and that points of some roles belong to the chassis or the wheel's carrier."""
    for part in structure.sides:
        if not any(name.startswith(f"{part}.") for name in (*structure.bodies, *structure.roles)):
            allowed = f'a mechanism, or "{part}.knuckle"'
            raise TableFault(("parts", part), "has no mechanism and no role", allowed)
    for role, who in structure.roles.items():
        place, (prefix, dot, last) = ("roles", role), role.rpartition(".")
        if prefix and prefix not in structure.sides:
            known = ", ".join(structure.sides) or 'none yet: write [parts] with PART = { side = "left" }'
            raise TableFault(place, f"is a role of {prefix!r}, which is no part", f"a part: {known}")
        if last == "knuckle":
            known_name("moving body", who, structure.moving_bodies, place)
            continue
        knuckle = structure.knuckles.get(f"{prefix}{dot}knuckle", "")
        body = {"wheel_axis": knuckle, "front_and_rear": CHASSIS, "inboard": CHASSIS}.get(last)
        for name in structure.role(role):
            known_name("point", name, structure.points, place)
            if body in structure.bodies:
                words = f"{body}, which carries the wheel" if body == knuckle else body
                known_name(f"point of {words}", name, structure.bodies[body], place)
