"""Structure of a mechanism by names, without coordinates: bodies, rods, slides, inputs and roles.

The types here describe the tables of a mechanism file, and pydantic reads the tables by them. A closure is
applied, and parts are included with their prefix, before names are checked (`checks`). See
`mechanisms/README.md` for the meaning of the tables.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import combinations
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, TypeAdapter

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import no_such, under
from pointcoord.mechanism.inputs import (
    CHASSIS,
    Distinct,
    Input,
    Name,
    Pair,
    Rename,
    Role,
    Slide,
    input_of,
    renamed,
)

T = TypeVar("T")

CLOSING = ("bodies", "rods", "slides", "inputs", "roles", "stand_ins")
"""Tables of named entries, which a closure may replace."""
TABLES = (*CLOSING, "closures", "parts")
PAIR_ROLES = ("wheel_axis", "steering_axis", "front_and_rear", "damper")
ROLES = ("knuckle", *PAIR_ROLES, "inboard")


@cache
def _reader(kind: Any) -> TypeAdapter[Any]:
    """The reader of a type, built at first use."""
    return TypeAdapter(kind)


def read(kind: Any, value: object, *key: str) -> Any:
    """A value read as a type; `key` is the key of the table that holds the value, for messages.

    Raises:
        TableFault: the value is not of this type.
    """
    with under(*key):
        # A reader of a model would be a second one.
        known = isinstance(kind, type) and issubclass(kind, BaseModel)
        return kind.model_validate(value) if known else _reader(kind).validate_python(value)


def _roles(roles: Mapping[str, Any]) -> dict[str, Role]:
    found: dict[str, Role] = {}
    for role, who in roles.items():
        last = role.rpartition(".")[2]
        if last not in ROLES:
            raise no_such("role", role, ROLES, (role,))
        found[role] = read(Pair if last in PAIR_ROLES else Name, who, role)
    return found


@dataclass(frozen=True)
class Structure:
    """A mechanism by names.

    Attributes:
        bodies: points of each body, the chassis among them.
        rods: name -> its two ends. slides, inputs: by name.
        roles: role -> the name or the two names that have it.
        stand_ins: point that a drawing may omit -> the point that then stands in for it.
        sides: part with a wheel -> the side of the car, left or right.
    """

    bodies: dict[Name, Distinct] = field(default_factory=dict)
    rods: dict[Name, Pair] = field(default_factory=dict)
    slides: dict[Name, Slide] = field(default_factory=dict)
    inputs: dict[Name, Annotated[Input, BeforeValidator(input_of)]] = field(default_factory=dict)
    roles: Annotated[dict[Name, Any], AfterValidator(_roles)] = field(default_factory=dict)
    stand_ins: dict[Name, Name] = field(default_factory=dict)
    sides: dict[str, str] = field(default_factory=dict)

    @cached_property
    def points(self) -> tuple[str, ...]:
        """Every point of a body, a rod or a slide."""
        found = dict.fromkeys(point for points in self.bodies.values() for point in points)
        found |= dict.fromkeys(end for ends in self.rods.values() for end in ends)
        found |= dict.fromkeys(point for slide in self.slides.values() for point in slide.points)
        return tuple(found)

    @property
    def required_points(self) -> tuple[str, ...]:
        return tuple(name for name in self.points if name not in self.stand_ins)

    @cached_property
    def attached(self) -> frozenset[str]:
        """The points that rods and slides are attached to."""
        ends = {end for ends in self.rods.values() for end in ends}
        return frozenset(ends.union(*((*one.points, one.through) for one in self.slides.values())))

    def bodies_of(self, point: str) -> tuple[str, ...]:
        return tuple(body for body, points in self.bodies.items() if point in points)

    def shared(self, body: str, other: str) -> tuple[str, ...]:
        """Points that both bodies have, in the order of the first."""
        return tuple(point for point in self.bodies[body] if point in self.bodies[other])

    def role(self, name: str) -> tuple[str, ...]:
        """The names that have a role; empty without such a role."""
        who = self.roles.get(name, ())
        return (who,) if isinstance(who, str) else who

    @property
    def knuckles(self) -> dict[str, str]:
        """Role of a knuckle, with the part's prefix -> the body that carries the wheel."""
        return {role: str(who) for role, who in self.roles.items() if role.rpartition(".")[2] == "knuckle"}

    def joints(self, driven: Collection[str]) -> dict[tuple[str, ...], tuple[str, ...]]:
        """Points of joints whose force is reported -> the other points of the body that holds the joint.

        A ball joint has one point, a hinge two. The held body, on which the force acts, is the knuckle, or
        the moving body that comes first; points are in its order. For the chassis no other points are named.
        Joints are left out where a rod, a slide or an input acts on the point too, or an input turns the
        hinge: how the force is shared is not determined there.
        """
        others = self.attached | {one.along for one in self.slides.values()}
        inputs = [self.inputs[name] for name in driven if not self.inputs[name].moves_the_chassis]
        others |= {p for one in inputs if not one.named("body") for p in one.named("point")}
        turned = {body for one in inputs for body in one.named("body")}
        found = {}
        for bodies in combinations(self.bodies, 2):
            held = self._held(bodies)
            (holding,) = (body for body in bodies if body != held)
            shared = self.shared(held, holding)
            alone = all(len(self.bodies_of(point)) == 2 and point not in others for point in shared)
            if shared and alone and not (len(shared) == 2 and turned.intersection(bodies)):
                beside = tuple(point for point in self.bodies[holding] if point not in shared)
                found[shared] = () if holding == CHASSIS else beside
        return found

    @cached_property
    def sliding(self) -> dict[str, tuple[str, bool]]:
        """Points on one turning slide -> the slide, and whether the body of its line is the held one.

        The held body is the knuckle, or the moving body that comes first; a point of no body is held itself.
        Points of no body are left out if rods join them to points of that slide only, since nothing loads
        them. Slides that keep a body from turning are left out: they add a couple, which every formulation
        distributes over the points differently.
        """
        found = {}
        for name, slide in self.slides.items():
            for point in slide.points if slide.turns else ():
                own = self.bodies_of(point)
                once = sum(point in other.points for other in self.slides.values()) == 1
                pulls = (ends for ends in self.rods.values() if not {*ends} <= {*slide.points})
                if once and (len(own) == 1 or (not own and any(point in ends for ends in pulls))):
                    both = [body for body in self.bodies if body in (slide.body, *own)]
                    found[point] = name, bool(own) and self._held(both) == slide.body
        return found

    def _held(self, bodies: Collection[str]) -> str:
        """The one of two bodies on which a joint's force is given: the knuckle, or the first that moves."""
        knuckle = next((body for body in bodies if body in self.knuckles.values()), "")
        return knuckle or next(body for body in bodies if body != CHASSIS)

    def drawn_with(self, given: Collection[str]) -> Structure:
        """The structure of a drawing with these points: stand-ins replace omitted points of moving bodies.

        `stand_ins` keeps its entries, since messages name them.
        """
        gone = {
            name: other
            for name, other in self.stand_ins.items()
            if name not in given and name not in self.bodies[CHASSIS]
        }
        return self.renamed(lambda kind, n: gone.get(n, n) if kind.endswith("point") else n) if gone else self

    def placed(self, points: Mapping[str, T]) -> dict[str, T]:
        """Drawn places, with the omitted points of the chassis where their stand-ins are drawn."""
        omitted = ((name, other) for name, other in self.stand_ins.items() if name in self.bodies[CHASSIS])
        return {name: points[other] for name, other in omitted if other in points} | dict(points)

    def prefixed(self, prefix: str) -> Structure:
        """The structure with a prefix before every name except the chassis' and directions."""
        fixed = {"body": (CHASSIS,), "direction": DIRECTIONS, "direction or point": DIRECTIONS}
        return self.renamed(lambda kind, name: name if name in fixed.get(kind, ()) else prefix + name)

    def renamed(self, new: Rename) -> Structure:
        """The structure with other names; a name that then occurs twice in a body is listed once.

        Names that only serve as keys are of the kind `entry`.
        """
        return replace(
            self,
            bodies={
                new("body", body): tuple(dict.fromkeys(renamed(points, "point", new)))
                for body, points in self.bodies.items()
            },
            rods={new("entry", rod): renamed(ends, "point", new) for rod, ends in self.rods.items()},
            slides={new("slide", name): slide.renamed(new) for name, slide in self.slides.items()},
            inputs={new("entry", name): one.renamed(new) for name, one in self.inputs.items()},
            roles={
                new("entry", role): renamed(who, "body" if role in self.knuckles else "point", new)
                for role, who in self.roles.items()
            },
            stand_ins={new("entry", one): new("entry", other) for one, other in self.stand_ins.items()},
            sides={new("entry", part): side for part, side in self.sides.items()},
        )

    def joined(self, other: Structure) -> Structure:
        """The structure with the tables of another added, on one chassis."""
        tables: dict[str, Any] = {
            table: {**getattr(self, table), **getattr(other, table)} for table in (*CLOSING, "sides")
        }
        both = (*self.bodies.get(CHASSIS, ()), *other.bodies.get(CHASSIS, ()))
        tables["bodies"][CHASSIS] = tuple(dict.fromkeys(both))
        return replace(self, **tables)

    @cached_property
    def moving_bodies(self) -> dict[str, tuple[str, ...]]:
        return {body: points for body, points in self.bodies.items() if body != CHASSIS}

    def plain(self, driven: Collection[str]) -> dict[str, Any]:
        """Bodies, rods, slides, driven inputs, roles and sides of parts as plain data."""
        inputs = {name: one for name, one in self.inputs.items() if name in driven}
        plain: dict[str, Any] = _reader(Structure).dump_python(
            replace(self, inputs=inputs),
            mode="json",
            by_alias=True,
            exclude={"stand_ins"},
            serialize_as_any=True,
        )
        return plain


def joints_in_words(structure: Structure) -> Iterator[str]:
    """Describe every ball joint, hinge, slide and rod, one per line."""
    for one, other in combinations(structure.bodies, 2):
        shared = structure.shared(one, other)
        if len(shared) == 1:
            yield f"ball joint of {one} and {other} at {shared[0]}"
        if len(shared) == 2:
            yield f"hinge of {one} and {other} about {shared[0]} - {shared[1]}"
    for name, slide in structure.slides.items():
        line = slide.along if slide.along in DIRECTIONS else f"towards {slide.along} as drawn"
        turns = "" if slide.turns else ", and does not turn"
        points = " and ".join(slide.points)
        yield f"slide {name}: {points} on the line of {slide.body} through {slide.through} {line}{turns}"
    for rod, ends in structure.rods.items():
        bodies = (", ".join(structure.bodies_of(end)) for end in ends)
        start, end = (f"{n} ({of})" if of else n for n, of in zip(ends, bodies, strict=True))
        yield f"rod {rod} from {start} to {end}"
