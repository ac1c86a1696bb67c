"""What a mechanism is made of, flat and by name: bodies, rods, slides, inputs and roles; no coordinates.

The types here say how the tables of a mechanism file look, and pydantic reads them so. A
closure is applied and parts are put in with their prefix before names are looked at (`checks`; see
`mechanisms/README.md` for what the tables mean).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import combinations
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    StrictBool,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import TableFault, faults_of, known_keys, no_such
from pointcoord.mechanism.inputs import (
    CHASSIS,
    Body,
    Distinct,
    Entry,
    Input,
    Name,
    Names,
    Pair,
    Point,
    Role,
    input_of,
    renamed,
)

CLOSING = ("bodies", "rods", "slides", "inputs", "roles", "stand_ins")
"""Tables with entries by name, which a closure may put others in place of."""
TABLES = (*CLOSING, "closures", "parts")
PAIR_ROLES = ("wheel_axis", "steering_axis", "front_and_rear", "damper")
ROLES = ("knuckle", *PAIR_ROLES, "inboard")


@cache
def _reader(kind: Any) -> TypeAdapter[Any]:
    """What reads a type, built when the first table is read."""
    return TypeAdapter(kind)


def read(kind: Any, value: object, *key: str) -> Any:
    """A value of a type; the key of a table that holds it, where no type says so.

    Raises:
        TableFault: it is not of this type.
    """
    try:
        return _reader(kind).validate_python(value)
    except ValidationError as error:
        raise faults_of(error, key)[0] from None


class Slide(Entry):
    """Points on a line of a body, through one of its points and along a direction or towards a point."""

    points: Annotated[Names, "point"]
    through: Point
    along: Point
    body: Body = CHASSIS
    turns: StrictBool = True

    @model_validator(mode="before")
    @classmethod
    def _point_or_points(cls, table: object) -> object:
        known_keys(table, ("point", *cls.model_fields))
        if not isinstance(table, Mapping):
            return table
        if ("point" in table) == ("points" in table):
            raise TableFault((), "needs a point", "either point or points")
        return {"points": (table["point"],), **table} if "point" in table else table


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
        rods: the two ends of each. slides, inputs: by name.
        roles: a name or two of each role that the mechanism has.
        stand_ins: points that a drawing may leave out, each with the one that then stands in for it.
        sides: the side of the car that each part is on, left or right.
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

    def bodies_of(self, point: str) -> tuple[str, ...]:
        return tuple(body for body, points in self.bodies.items() if point in points)

    def shared(self, body: str, other: str) -> tuple[str, ...]:
        """Points of two bodies, as the first lists them."""
        return tuple(point for point in self.bodies[body] if point in self.bodies[other])

    @property
    def knuckles(self) -> dict[str, str]:
        """By role, of the whole or of a part, the body that carries a wheel."""
        return {role: str(who) for role, who in self.roles.items() if role.rpartition(".")[2] == "knuckle"}

    def joints(self, driven: Collection[str]) -> dict[tuple[str, ...], tuple[str, ...]]:
        """The point of each ball joint, or both of each hinge, with the other points of the body that holds.

        What is held is the knuckle, or the moving body that comes first, and points are as it lists them; of
        the chassis none are named. Where a rod, a slide or an input takes hold of a point too, nothing says
        of which of the two halves, nor at which point an input turns a hinge.
        """
        others = {end for ends in self.rods.values() for end in ends}
        others |= {point for one in self.slides.values() for point in (*one.points, one.through, one.along)}
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
        """The points on one turning slide, each with the slide and whether the line's body is held.

        What is held is the knuckle, or the moving body that comes first; a point of no body is held itself.
        Nothing pulls those that hang on other points of the slide alone. What keeps a body from turning holds
        it by a couple, of which each formulation has its own share in forces.
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
        """The body of two whose force at a joint is given: the knuckle, or the first that moves."""
        knuckle = next((body for body in bodies if body in self.knuckles.values()), "")
        return knuckle or next(body for body in bodies if body != CHASSIS)

    def drawn_with(self, given: Collection[str]) -> Structure:
        """The mechanism of a drawing that gives these points: of moving bodies, those that others do the
        work of are gone.
        """
        gone = {
            name: other
            for name, other in self.stand_ins.items()
            if name not in given and name not in self.bodies[CHASSIS]
        }
        return self.renamed(points=gone) if gone else self

    def renamed(
        self,
        points: Mapping[str, str] | None = None,
        bodies: Mapping[str, str] | None = None,
        slides: Mapping[str, str] | None = None,
        prefix: str = "",
    ) -> Structure:
        """With other names; a name that comes twice in a body comes once then.

        What a drawing may leave out stays known: messages say what stands in for what.

        Args:
            prefix: before the names of rods, inputs and roles.
        """
        p, b, s = points or {}, bodies or {}, slides or {}
        rename = {"point": p, "body": b, "slide": s}
        return replace(
            self,
            bodies={
                b.get(body, body): tuple(dict.fromkeys(renamed(names, p)))
                for body, names in self.bodies.items()
            },
            rods={prefix + rod: renamed(ends, p) for rod, ends in self.rods.items()},
            slides={s.get(name, name): slide.renamed(rename) for name, slide in self.slides.items()},
            inputs={prefix + name: one.renamed(rename) for name, one in self.inputs.items()},
            roles={prefix + role: renamed(who, {**p, **b}) for role, who in self.roles.items()},
            stand_ins={prefix + point: prefix + other for point, other in self.stand_ins.items()},
        )

    def prefixed(self, prefix: str) -> Structure:
        """With a prefix before every name but the chassis'."""
        return self.renamed(
            {n: prefix + n for n in self.points},
            {n: prefix + n for n in self.bodies if n != CHASSIS},
            {n: prefix + n for n in self.slides},
            prefix,
        )

    def joined(self, other: Structure) -> Structure:
        """With another's tables beside its own, on one chassis."""
        tables: dict[str, Any] = {
            table: {**getattr(self, table), **getattr(other, table)} for table in CLOSING
        }
        both = (*self.bodies.get(CHASSIS, ()), *other.bodies.get(CHASSIS, ()))
        tables["bodies"][CHASSIS] = tuple(dict.fromkeys(both))
        return replace(self, **tables)

    @cached_property
    def moving_bodies(self) -> dict[str, tuple[str, ...]]:
        return {body: points for body, points in self.bodies.items() if body != CHASSIS}

    def plain(self, driven: Collection[str]) -> dict[str, Any]:
        """Bodies, rods, slides, driven inputs, roles and the sides of parts as plain data."""
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
    """Every ball joint, hinge, slide and rod, one a line."""
    for one, other in combinations(structure.bodies, 2):
        shared = structure.shared(one, other)
        if len(shared) == 1:
            yield f"ball joint of {one} and {other} at {shared[0]}"
        if len(shared) == 2:
            yield f"hinge of {one} and {other} about {shared[0]} - {shared[1]}"
    for name, slide in structure.slides.items():
        yield _slide_in_words(name, slide)
    for rod, (start, end) in structure.rods.items():
        yield f"rod {rod} from {_end(structure, start)} to {_end(structure, end)}"


def _slide_in_words(name: str, slide: Slide) -> str:
    line = slide.along if slide.along in DIRECTIONS else f"towards {slide.along} as drawn"
    turns = "" if slide.turns else ", and does not turn"
    points = " and ".join(slide.points)
    return f"slide {name}: {points} on the line of {slide.body} through {slide.through} {line}{turns}"


def _end(structure: Structure, point: str) -> str:
    bodies = structure.bodies_of(point)
    return f"{point} ({', '.join(bodies)})" if bodies else point
