"""Checks the names of a mechanism, and whether its bodies, rods and slides can be joined as given."""

from __future__ import annotations

from itertools import combinations

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import TableFault, known_name, no_such
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import Structure

A_POINT = "point of a body, rod or slide"


def check(structure: Structure) -> None:
    """Check that the entries of a mechanism agree with each other.

    Raises:
        TableFault: the first fault.
    """
    _bodies(structure)
    _rods(structure)
    _slides(structure)
    _inputs(structure)
    _roles(structure)
    for point, other in structure.stand_ins.items():
        for name in (point, other):
            known_name(A_POINT, name, structure.points, ("stand_ins", point))
        if point == other:
            raise TableFault(("stand_ins", point), f"is {other!r}, the omitted point itself", "another point")


def _bodies(structure: Structure) -> None:
    if not structure.bodies.get(CHASSIS):
        problem = f"the body {CHASSIS!r}, the ground, is missing or has no points"
        raise TableFault(("bodies",), problem, f"a body {CHASSIS!r}")
    for body, points in structure.moving_bodies.items():
        if len(points) < 3:
            hint = "; write it in [rods]" if len(points) == 2 else ""
            raise TableFault(
                ("bodies", body),
                f"has {len(points)} point{'' if len(points) == 1 else 's'}{hint}",
                "three points or more, not all in one line",
            )
    for (one, points), (other, others) in combinations(structure.bodies.items(), 2):
        both = [name for name in points if name in others]
        if len(both) > 2:
            raise TableFault(
                ("bodies", other),
                f"shares {', '.join(both)} with {one}: three shared points make the two one rigid body",
                "one shared point (a ball joint) or two (a hinge); or write the two as one body",
            )
    held = {end for ends in structure.rods.values() for end in ends}
    held |= {name for slide in structure.slides.values() for name in (*slide.points, slide.through)}
    for body, points in structure.moving_bodies.items():
        shared = (name for name in points if len(structure.bodies_of(name)) > 1)
        if held.isdisjoint(points) and not any(shared):
            raise TableFault(
                ("bodies", body),
                "nothing holds this body: none of its points is shared with another body, a rod or a slide",
                "a point that it shares with another body, a rod or a slide",
            )


def _rods(structure: Structure) -> None:
    ends = [end for pair in structure.rods.values() for end in pair]
    sliding = {point for slide in structure.slides.values() for point in slide.points}
    for rod, pair in structure.rods.items():
        for body in structure.bodies_of(pair[0]):
            if pair[1] in structure.bodies[body]:
                raise TableFault(
                    ("rods", rod), f"joins two points of {body}, whose distance is fixed", "two bodies"
                )
        for end in pair:
            free = not structure.bodies_of(end) and end not in sliding
            if free and ends.count(end) < 2:
                raise no_such(
                    "point of a body or slide",
                    end,
                    (name for name in structure.points if name != end),
                    ("rods", rod),
                )


def _slides(structure: Structure) -> None:
    for name, slide in structure.slides.items():
        place = ("slides", name)
        known_name("body", slide.body, structure.bodies, (*place, "body"))
        own = structure.bodies[slide.body]
        known_name(f"point of {slide.body}", slide.through, own, (*place, "through"))
        if slide.along not in DIRECTIONS:
            known = (*DIRECTIONS, *structure.points)
            known_name("direction or point", slide.along, known, (*place, "along"))
            if slide.along == slide.through:
                raise TableFault(
                    (*place, "along"),
                    f"is {slide.along!r}, the same point as through, so the line has no direction",
                    "a direction, or another point",
                )
        for point in slide.points:
            if point in own:
                raise TableFault(
                    (*place, "points"),
                    f"{point!r} is a point of {slide.body}, so it cannot slide on a line of {slide.body}",
                    f"points that {slide.body} does not have",
                )
        if not slide.turns:
            _one_body(structure, slide.points, place)


def _one_body(structure: Structure, points: tuple[str, ...], place: tuple[str, ...]) -> None:
    if len(points) < 2:
        raise TableFault((*place, "turns"), "a single point cannot be kept from turning", "two points")
    bodies = set(structure.bodies_of(points[0])).intersection(structure.bodies_of(points[1]))
    if len(bodies) != 1:
        raise TableFault(
            (*place, "points"),
            f"{points[0]} and {points[1]} are of {' and of '.join(sorted(bodies)) or 'no common body'}, so "
            "the body kept from turning is not defined",
            "with turns = false, first two points that one body alone shares",
        )


def _inputs(structure: Structure) -> None:
    for name, one in structure.inputs.items():
        place = ("inputs", name)
        for body in one.named("body"):
            known_name("body", body, structure.bodies, place)
        for slide in one.named("slide"):
            known_name("slide", slide, structure.slides, (*place, one.kind))
        for point in one.named("point"):
            known_name(A_POINT, point, structure.points, place)
        try:
            one.check(structure.bodies)
        except TableFault as fault:
            raise fault.under(*place) from None


def _roles(structure: Structure) -> None:
    """Check names in roles, and that points of some roles belong to the chassis or the wheel's carrier."""
    for part in structure.sides:
        if not any(name.startswith(f"{part}.") for name in (*structure.bodies, *structure.roles)):
            raise TableFault(
                ("parts", part), "has no mechanism and no role", f'a mechanism, or "{part}.knuckle"'
            )
    for role, who in structure.roles.items():
        place, (prefix, dot, last) = ("roles", role), role.rpartition(".")
        if prefix and prefix not in structure.sides:
            known = ", ".join(structure.sides) or 'none yet: write [parts] with PART = { side = "left" }'
            raise TableFault(place, f"is a role of {prefix!r}, which is no part", f"a part: {known}")
        if last == "knuckle":
            known_name("body", who, structure.bodies, place)
            if who == CHASSIS:
                raise TableFault(place, "is the chassis, which carries no wheel", "a moving body")
            continue
        names, body, words = (who,) if isinstance(who, str) else who, str(CHASSIS), "the chassis"
        if last == "wheel_axis":
            body = structure.knuckles.get(f"{prefix}{dot}knuckle", "")
            words = f"{body}, which carries the wheel,"
        for name in names:
            known_name(A_POINT, name, structure.points, place)
            if last in ("wheel_axis", "front_and_rear", "inboard") and body in structure.bodies:
                known_name(f"point of {words}", name, structure.bodies[body], place)
