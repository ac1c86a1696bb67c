"""Whether the names of a mechanism mean something, and its bodies, rods and slides can be joined so."""

from __future__ import annotations

from collections.abc import Collection
from itertools import combinations

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import TableFault, no_such
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import Structure


def check(structure: Structure) -> None:
    """Check what the entries of a mechanism make together.

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
            _known(structure, "point", name, ("stand_ins", point))


def _known(structure: Structure, kind: str, name: str, place: Collection[str]) -> None:
    """Pass if a name is one of a point, a body or a slide."""
    words, known = {
        "point": ("point of a body, rod or slide", structure.points),
        "body": ("body", structure.bodies),
        "slide": ("slide", structure.slides),
    }[kind]
    if name not in known:
        raise no_such(words, name, known, place)


def _bodies(structure: Structure) -> None:
    if not structure.bodies.get(CHASSIS):
        problem = f"there is no body {CHASSIS!r}, the ground, with points"
        raise TableFault(("bodies",), problem, f"a body {CHASSIS!r}")
    for body, points in structure.moving_bodies.items():
        if len(points) < 3:
            hint = "; write it in [rods]" if len(points) == 2 else ""
            raise TableFault(
                ("bodies", body),
                f"has {len(points)} point{'' if len(points) == 1 else 's'}{hint}",
                "three points that are not in one line, or more",
            )
    for (one, points), (other, others) in combinations(structure.bodies.items(), 2):
        both = [name for name in points if name in others]
        if len(both) > 2:
            raise TableFault(
                ("bodies", other),
                f"shares {', '.join(both)} with {one}: three points make the two one body",
                "one shared point (a ball joint) or two (a hinge); or write the two as one body",
            )
    held = {end for ends in structure.rods.values() for end in ends}
    held |= {name for slide in structure.slides.values() for name in (*slide.points, slide.through)}
    for body, points in structure.moving_bodies.items():
        shared = (name for name in points if len(structure.bodies_of(name)) > 1)
        if held.isdisjoint(points) and not any(shared):
            raise TableFault(
                ("bodies", body),
                "nothing holds this body: no other body, rod or slide has one of its points",
                "a point that it shares with another body, a rod or a slide",
            )


def _rods(structure: Structure) -> None:
    ends = [end for pair in structure.rods.values() for end in pair]
    sliding = {point for slide in structure.slides.values() for point in slide.points}
    for rod, pair in structure.rods.items():
        for body in structure.bodies_of(pair[0]):
            if pair[1] in structure.bodies[body]:
                raise TableFault(
                    ("rods", rod), f"joins two points of {body}, which are held already", "two bodies"
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
        _known(structure, "body", slide.body, (*place, "body"))
        if slide.through not in structure.bodies[slide.body]:
            raise no_such(
                f"point of {slide.body}", slide.through, structure.bodies[slide.body], (*place, "through")
            )
        if slide.along not in DIRECTIONS:
            if slide.along not in structure.points:
                known = (*DIRECTIONS, *structure.points)
                raise no_such("direction or point", slide.along, known, (*place, "along"))
            if slide.along == slide.through:
                raise TableFault(
                    (*place, "along"),
                    f"is {slide.along!r} as through is, so the line has no direction",
                    "a direction, or a point beside it",
                )
        for point in slide.points:
            if point in structure.bodies[slide.body]:
                raise TableFault(
                    (*place, "points"),
                    f"{point!r} is a point of {slide.body} itself, so it cannot slide in it",
                    f"points that {slide.body} does not have",
                )
        if not slide.turns:
            _one_body(structure, slide.points, place)


def _one_body(structure: Structure, points: tuple[str, ...], place: tuple[str, ...]) -> None:
    if len(points) < 2:
        raise TableFault((*place, "turns"), "a single point has no turn to be kept from", "two points")
    bodies = set(structure.bodies_of(points[0])).intersection(structure.bodies_of(points[1]))
    if len(bodies) != 1:
        raise TableFault(
            (*place, "points"),
            f"{points[0]} and {points[1]} are of {' and of '.join(sorted(bodies)) or 'no one body'}, so that "
            "it is not said which of them is kept from turning",
            "with turns = false, the first two of one body alone",
        )


def _inputs(structure: Structure) -> None:
    for name, one in structure.inputs.items():
        place = ("inputs", name)
        for kind in ("body", "slide", "point"):
            for each in one.named(kind):
                _known(structure, kind, each, place if kind != "slide" else (*place, one.kind))
        try:
            one.check(structure.bodies)
        except TableFault as fault:
            raise fault.under(*place) from None


def _roles(structure: Structure) -> None:
    for role, who in structure.roles.items():
        place, names = ("roles", role), (who,) if isinstance(who, str) else who
        carries = role in structure.knuckles
        for name in names:
            _known(structure, "body" if carries else "point", name, place)
        if carries and who == CHASSIS:
            raise TableFault(place, "is the chassis, which carries no wheel", "a moving body")
        _of_body(structure, role, names)


def _of_body(structure: Structure, role: str, points: tuple[str, ...]) -> None:
    """The points of some roles are of one body: the chassis, or what carries the wheel."""
    last = role.rpartition(".")[2]
    body, words = str(CHASSIS), "the chassis"
    if last == "wheel_axis":
        body = structure.knuckles.get(role.removesuffix(last) + "knuckle", "")
        words = f"{body}, which carries the wheel,"
    elif last not in ("front_and_rear", "inboard"):
        return
    for name in points if body in structure.bodies else ():
        if name not in structure.bodies[body]:
            raise no_such(f"point of {words}", name, structure.bodies[body], ("roles", role))
