"""What a mechanism is made of, flat and by name: bodies, rods, slides, inputs and roles; no coordinates.

The types here say how the tables of a mechanism file look, and pydantic reads them so (`structure_of`). A
closure is applied and parts are put in with their prefix before names are looked at (`checks`; see
`mechanisms/README.md` for what the tables mean).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Field,
    StrictBool,
    TypeAdapter,
    ValidationError,
)

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.faults import TableFault, fault_of, no_such
from pointcoord.wording import shown

CHASSIS = "chassis"
CLOSING = ("bodies", "rods", "slides", "inputs", "roles", "stand_ins")
"""Tables with entries by name, which a closure may put others in place of."""
TABLES = (*CLOSING, "closures", "parts")
PAIR_ROLES = ("wheel_axis", "steering_axis", "front_and_rear", "damper")
ROLES = ("knuckle", *PAIR_ROLES, "inboard")


def _once(names: tuple[str, ...]) -> tuple[str, ...]:
    for at, each in enumerate(names):
        if each in names[:at]:
            raise TableFault((), f"{each!r} is named twice", "each name once")
    return names


def _pair(names: object) -> object:
    if isinstance(names, list | tuple) and len(names) != 2:
        counted = f"has {len(names)} point{'' if len(names) == 1 else 's'}"
        raise TableFault((), counted, "two different points, such as [P, Q]")
    if isinstance(names, list | tuple) and names[0] == names[1]:
        raise TableFault((), f"goes from {shown(names[0])} to itself, so it has no length", "two points")
    return names


def _direction(name: str) -> str:
    if name not in DIRECTIONS:
        raise no_such("direction", name, DIRECTIONS, ())
    return name


def known_keys(table: object, known: Collection[str], what: str) -> object:
    """A table that has no other keys than the known ones.

    Raises:
        TableFault: it has.
    """
    for key in table if isinstance(table, Mapping) else ():
        if key not in known:
            raise no_such(f"key of {what}", key, known, (key,))
    return table


Name = Annotated[str, Field(strict=True, min_length=1)]
Ends = tuple[Name, Name]
Role = Name | Ends
Names = Annotated[tuple[Name, ...], Field(min_length=1), AfterValidator(_once)]
# The word at the end says what a name is the name of.
Point = Annotated[Name, "point"]
Pair = Annotated[Ends, BeforeValidator(_pair), "point"]
Body = Annotated[Name, "body"]
SlideNames = Annotated[Names, BeforeValidator(lambda v: (v,) if isinstance(v, str) else v), "slide"]
Direction = Annotated[Name, AfterValidator(_direction)]
Chassis = Literal["chassis"]


_PAIR: TypeAdapter[Role] = TypeAdapter(Pair)
_NAME: TypeAdapter[Role] = TypeAdapter(Name)


def _read(kind: TypeAdapter[Role], value: object, key: str) -> Role:
    """What a key of a table holds, where no type says what it is.

    Raises:
        TableFault: it is not of this kind.
    """
    try:
        return kind.validate_python(value)
    except ValidationError as error:
        raise fault_of(error, (key,)) from None


@dataclass(frozen=True)
class Slide:
    """Points on a line of a body, through one of its points and along a direction or towards a point."""

    points: Names
    through: Name
    along: Name
    body: Name = CHASSIS
    turns: StrictBool = True

    @property
    def named(self) -> tuple[str, ...]:
        """Every point that it names."""
        return (*self.points, self.through, *(() if self.along in DIRECTIONS else (self.along,)))


def _slide(table: object) -> object:
    """With `points`, where there is one `point`."""
    known_keys(table, ("point", "points", "body", "through", "along", "turns"), "a slide")
    if not isinstance(table, Mapping):
        return table
    if ("point" in table) == ("points" in table):
        raise TableFault((), "needs a point", "either point or points")
    if "points" in table:
        return table
    others = {key: value for key, value in table.items() if key != "point"}
    return {"points": (_read(_NAME, table["point"], "point"),), **others}


class Arm(BaseModel):
    """The angle of an arm of a body from a direction."""

    angle: Body
    of: Point
    about: Point
    from_: Direction = Field(alias="from")


class Turn(BaseModel):
    """The turn of a body about a hinge from the drawing."""

    angle: Body
    from_: Literal["drawing"] = Field(alias="from")
    on: Body = CHASSIS


class Travel(BaseModel):
    """The travel of slides."""

    travel: SlideNames


class Height(BaseModel):
    """The height of a point."""

    height: Point
    along: Direction = "up"


class Contact(BaseModel):
    """The height of a wheel's contact point."""

    contact: Pair


class Distance(BaseModel):
    """The distance of two points."""

    distance: Pair


class Moves(BaseModel):
    """A displacement of the whole car."""

    moves: Chassis
    along: Direction


class Turns(BaseModel):
    """A turn of the whole car."""

    turns: Chassis
    about: Point
    along: Direction


KINDS: Mapping[str, type[BaseModel]] = {
    kind.__name__.lower(): kind for kind in (Arm, Turn, Travel, Height, Contact, Distance, Moves, Turns)
}


@cache
def _naming(kind: str, what: str) -> tuple[str, ...]:
    """The keys of a kind of input that name points, bodies or slides."""
    return tuple(key for key, own in KINDS[kind].model_fields.items() if what in own.metadata)


@dataclass(frozen=True)
class Input:
    """Something that can be driven.

    Attributes:
        kind: arm, turn, travel, height, contact, distance, moves or turns.
        table: as written, with what may be left out filled in.
    """

    kind: str
    table: Mapping[str, Any]

    def __getitem__(self, key: str) -> Any:
        return self.table[key]

    @property
    def moves_the_chassis(self) -> bool:
        """Whether it moves the whole car, so that it holds no freedom of the mechanism."""
        return self.kind in ("moves", "turns")

    @property
    def unit(self) -> str:
        """Of its values."""
        return "rad" if self.kind in ("arm", "turn", "turns") else "mm"

    def named(self, what: str) -> tuple[str, ...]:
        """The names of points, bodies or slides that it mentions."""
        values = [self[key] for key in _naming(self.kind, what)]
        return tuple(n for value in values for n in (value if isinstance(value, tuple) else (value,)))

    def renamed(self, rename: Mapping[str, Mapping[str, str]]) -> Input:
        """With other names of points, bodies or slides."""
        new = {key: names for what, names in rename.items() for key in _naming(self.kind, what)}
        return replace(
            self, table={key: _renamed(value, new.get(key, {})) for key, value in self.table.items()}
        )


def _renamed(value: Any, names: Mapping[str, str]) -> Any:
    """A name or some, changed where there is another for it."""
    return tuple(names.get(n, n) for n in value) if isinstance(value, tuple) else names.get(value, value)


def _input(table: object) -> object:
    """As its kind has it, which one of its keys tells."""
    if not isinstance(table, Mapping):
        raise TableFault((), f"is {shown(table)}", 'a table, such as { height = "a" }')
    telling = ("angle", "travel", "height", "contact", "distance", "moves", "turns")
    found = [key for key in telling if key in table]
    if len(found) != 1:
        hint = next((key for key in table if key not in ("along", "about")), "")
        if not found and hint:
            raise no_such("kind of input", hint, telling, (hint,))
        counted = f"is of {len(found)} kinds" if found else "is of no kind"
        raise TableFault((), counted, f"one of {', '.join(telling)}")
    kind = found[0]
    if kind == "angle":
        kind = "turn" if table.get("from") == "drawing" else "arm"
    known = [own.alias or key for key, own in KINDS[kind].model_fields.items()]
    known_keys(table, known, f"an input by {found[0]}")
    return Input(kind, KINDS[kind].model_validate(table).model_dump(by_alias=True))


def _roles(roles: Mapping[str, Any]) -> dict[str, Role]:
    found: dict[str, Role] = {}
    for role, who in roles.items():
        last = role.rpartition(".")[2]
        if last not in ROLES:
            raise no_such("role", role, ROLES, (role,))
        found[role] = _read(_PAIR if last in PAIR_ROLES else _NAME, who, role)
    return found


@dataclass(frozen=True)
class Structure:
    """A mechanism by name.

    Attributes:
        bodies: points of each body, the chassis among them.
        rods: the two ends of each. slides, inputs: by name.
        roles: a name or two of each role that the mechanism has.
        stand_ins: points that a drawing may leave out, each with the one that then stands in for it.
        sides: the side of the car that each part is on, left or right.
    """

    name: str = ""
    bodies: dict[Name, Annotated[tuple[Name, ...], AfterValidator(_once)]] = field(default_factory=dict)
    rods: dict[Name, Pair] = field(default_factory=dict)
    slides: dict[Name, Annotated[Slide, BeforeValidator(_slide)]] = field(default_factory=dict)
    inputs: dict[Name, Annotated[Input, BeforeValidator(_input)]] = field(default_factory=dict)
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
        """Points that must be drawn."""
        return tuple(name for name in self.points if name not in self.stand_ins)

    def bodies_of(self, point: str) -> tuple[str, ...]:
        """The bodies that have a point."""
        return tuple(body for body, points in self.bodies.items() if point in points)

    def shared(self, body: str, other: str) -> tuple[str, ...]:
        """Points of two bodies, as the first lists them."""
        return tuple(point for point in self.bodies[body] if point in self.bodies[other])

    @property
    def knuckles(self) -> dict[str, str]:
        """By role, of the whole or of a part, the body that carries a wheel."""
        return {role: str(who) for role, who in self.roles.items() if role.rpartition(".")[2] == "knuckle"}

    def ball_joints(self, driven: Collection[str]) -> dict[str, tuple[str, ...]]:
        """Points that hold two bodies at each other and nothing else, with those of the body that holds.

        What is held is the knuckle, or the moving body that comes first; of the chassis no points are named.
        Where a rod, a slide or an input takes hold of the point too, nothing says of which of the two halves.
        """
        others = {end for ends in self.rods.values() for end in ends}
        others |= {name for one in self.slides.values() for name in (*one.points, one.through, one.along)}
        for one in (self.inputs[name] for name in driven if not self.inputs[name].moves_the_chassis):
            others |= set() if one.named("body") else {*one.named("point")}
        found = {}
        for point in self.points:
            bodies, knuckles = self.bodies_of(point), self.knuckles.values()
            if len(bodies) != 2 or len(self.shared(*bodies)) != 1 or point in others:
                continue
            held = next((b for b in bodies if b in knuckles), next(b for b in bodies if b != CHASSIS))
            (holding,) = (body for body in bodies if body != held)
            found[point] = () if holding == CHASSIS else self.bodies[holding]
        return found

    def left_out(self, given: Collection[str]) -> dict[str, str]:
        """Points of moving bodies that a drawing leaves out, each with the one that does its work."""
        return {
            name: other
            for name, other in self.stand_ins.items()
            if name not in given and name not in self.bodies[CHASSIS]
        }

    def drawn_with(self, given: Collection[str]) -> Structure:
        """The mechanism of a drawing that gives these points: those that others do the work of are gone."""
        gone = self.left_out(given)
        return self.renamed(points=gone) if gone else self

    def renamed(
        self,
        points: Mapping[str, str] | None = None,
        bodies: Mapping[str, str] | None = None,
        slides: Mapping[str, str] | None = None,
    ) -> Structure:
        """With other names; a name that comes twice in a body comes once then."""
        p, b, s = points or {}, bodies or {}, slides or {}
        every = {**p, **b}
        return replace(
            self,
            bodies={
                b.get(body, body): tuple(dict.fromkeys(_renamed(names, p)))
                for body, names in self.bodies.items()
            },
            rods={rod: _renamed(ends, p) for rod, ends in self.rods.items()},
            slides={
                s.get(name, name): replace(
                    slide,
                    points=_renamed(slide.points, p),
                    through=_renamed(slide.through, p),
                    along=_renamed(slide.along, p),
                    body=_renamed(slide.body, b),
                )
                for name, slide in self.slides.items()
            },
            inputs={
                name: one.renamed({"point": p, "body": b, "slide": s}) for name, one in self.inputs.items()
            },
            roles={role: _renamed(who, every) for role, who in self.roles.items()},
            stand_ins={p.get(a, a): p.get(z, z) for a, z in self.stand_ins.items() if a not in p},
        )

    def prefixed(self, prefix: str) -> Structure:
        """With a prefix before every name but the chassis'."""
        own = self.renamed(
            {n: prefix + n for n in self.points},
            {n: prefix + n for n in self.bodies if n != CHASSIS},
            {n: prefix + n for n in self.slides},
        )
        return replace(
            own,
            rods={prefix + n: ends for n, ends in own.rods.items()},
            inputs={prefix + n: one for n, one in own.inputs.items()},
            roles={prefix + n: who for n, who in own.roles.items()},
            stand_ins={prefix + a: prefix + z for a, z in self.stand_ins.items()},
        )

    def joined(self, other: Structure) -> Structure:
        """With another's tables beside its own, on one chassis."""
        chassis = dict.fromkeys((*self.bodies.get(CHASSIS, ()), *other.bodies.get(CHASSIS, ())))
        return replace(
            self,
            bodies={**self.bodies, **other.bodies, CHASSIS: tuple(chassis)},
            rods={**self.rods, **other.rods},
            slides={**self.slides, **other.slides},
            inputs={**self.inputs, **other.inputs},
            roles={**self.roles, **other.roles},
            stand_ins={**self.stand_ins, **other.stand_ins},
        )

    def moving_bodies(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """The bodies but the chassis, with their points."""
        return ((body, points) for body, points in self.bodies.items() if body != CHASSIS)

    def plain(self, driven: Collection[str]) -> dict[str, Any]:
        """Bodies, rods, slides, driven inputs, roles and the sides of parts as plain data."""
        inputs = {name: one.table for name, one in self.inputs.items() if name in driven}
        slides = {name: vars(slide) for name, slide in self.slides.items()}
        tables = {"bodies": self.bodies, "rods": self.rods, "slides": slides, "inputs": inputs}
        others = {"roles": _with_lists(self.roles), "sides": dict(self.sides)}
        return {"name": self.name, **_with_lists(tables), **others}


def _with_lists(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _with_lists(each) for key, each in value.items()}
    return list(value) if isinstance(value, tuple) else value


_READER = TypeAdapter(Structure)


def structure_of(tables: Mapping[str, Any], name: str) -> Structure:
    """The tables as they stand, each entry read by itself; parts and closures are not looked at.

    Raises:
        TableFault: something has not the shape or type that it must have.
    """
    given = {table: tables[table] for table in CLOSING if tables.get(table) is not None}
    try:
        return _READER.validate_python({"name": name, **given})
    except ValidationError as error:
        raise fault_of(error) from None
