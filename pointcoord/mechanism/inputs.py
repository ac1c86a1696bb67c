"""The entries of a mechanism's tables that have keys: slides, and each kind of input.

The types of the keys say what a name belongs to. Rows and drives of inputs are made in `compiled`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    AliasChoices,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StrictBool,
    model_validator,
)

from pointcoord.linkage.directions import axis_along
from pointcoord.mechanism.faults import TableFault, known_keys, known_name, no_such
from pointcoord.wording import shown

LENGTHS = {"wheel_radius": 300.0, "rack_per_turn": 50.0}
"""Further lengths that inputs may need, each with a typical value, mm."""
CHASSIS: Literal["chassis"] = "chassis"


def _once(names: tuple[str, ...]) -> tuple[str, ...]:
    for at, each in enumerate(names):
        if each in names[:at]:
            raise TableFault((), f"{each!r} is named twice", "each name once")
    return names


def _pair(names: object) -> object:
    if isinstance(names, list | tuple) and (len(names) != 2 or names[0] == names[1]):
        why = ", so it has no length" if len(names) == 2 else ""
        raise TableFault((), f"is {shown(names)}{why}", "two different points, such as [P, Q]")
    return names


Name = Annotated[str, Field(strict=True, min_length=1)]
Ends = tuple[Name, Name]
Role = Name | Ends
Distinct = Annotated[tuple[Name, ...], AfterValidator(_once)]
Names = Annotated[tuple[Name, ...], Field(min_length=1), AfterValidator(_once)]
# The last word is the kind of object that the name belongs to.
Point = Annotated[Name, "point"]
Pair = Annotated[Ends, BeforeValidator(_pair), "point"]
Body = Annotated[Name, "body"]
OneOrMore = Annotated[Names, BeforeValidator(lambda v: (v,) if isinstance(v, str) else v)]
SlideNames = Annotated[OneOrMore, "slide"]
Direction = Annotated[Name, "direction"]
Towards = Annotated[Name, "direction or point"]
Chassis = Literal["chassis"]

Bodies = Mapping[str, Sequence[str]]
Rename = Callable[[str, str], str]
"""A kind of object, and a name -> the new name."""


class Entry(BaseModel):
    """An entry of a table; its field types say which values name points, bodies, slides or directions."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    more_keys: ClassVar[tuple[str, ...]] = ()
    """Keys that a table may have besides the entry's own: second spellings, and what is read elsewhere."""

    @model_validator(mode="before")
    @classmethod
    def _of_known_keys(cls, table: object) -> object:
        keys = (own.alias or key for key, own in cls.model_fields.items())
        return known_keys(table, (*keys, *cls.more_keys))

    @classmethod
    def naming(cls) -> list[tuple[str, str]]:
        """Keys whose values are names, each with the kind of object that has the name."""
        fields = cls.model_fields.items()
        return [(key, kind) for key, own in fields for kind in own.metadata if isinstance(kind, str)]

    def names(self) -> Iterator[tuple[str, str, str]]:
        """Every name in the entry: its key, the kind of object that has it, and the name."""
        for key, kind in self.naming():
            value = getattr(self, key)
            for name in (value,) if isinstance(value, str) else value:
                yield key.removesuffix("_"), kind, name

    def named(self, kind: str) -> tuple[str, ...]:
        """The names of points, bodies, slides or directions in the entry."""
        return tuple(name for _, own, name in self.names() if own == kind)

    def renamed(self, new: Rename) -> Self:
        """The entry with other names for points, bodies and slides."""
        changes = {key: renamed(getattr(self, key), kind, new) for key, kind in self.naming()}
        return self.model_copy(update=changes)

    def check(self, bodies: Bodies) -> None:
        """Check that the names, which exist, fit together.

        Raises:
            TableFault: they do not; its place is relative to the entry's place.
        """


class Slide(Entry):
    """Points on a line of a body, through one of the body's points, along a direction or towards a point."""

    more_keys = ("point",)

    points: Annotated[OneOrMore, "point"] = Field(validation_alias=AliasChoices("points", "point"))
    through: Point
    along: Towards
    body: Body = CHASSIS
    turns: StrictBool = True

    def check(self, bodies: Bodies) -> None:
        own = bodies[self.body]
        known_name(f"point of {self.body}", self.through, own, ("through",))
        if self.along == self.through:
            problem = f"is {self.along!r}, the same point as through, so the line has no direction"
            raise TableFault(("along",), problem, "a direction, or another point")
        for point in self.points:
            if point in own:
                problem = f"{point!r} is a point of {self.body}, so it cannot slide on a line of {self.body}"
                raise TableFault(("points",), problem, f"points that {self.body} does not have")
        if self.turns:
            return
        both = [body for body, points in bodies.items() if {*self.points[:2]} <= {*points}]
        if len(self.points) < 2 or len(both) != 1:
            found = f"{' and '.join(self.points)} belong together to {' and '.join(both) or 'no body'}"
            problem = f"{found}, so the body kept from turning is not defined"
            raise TableFault(("turns",), problem, "first two points that one body alone shares")


class Input(Entry):
    """An input that can be driven, as its table describes it.

    Attributes:
        unit: unit of its values.
        length: name of the further length that it needs from the scene; empty if none.
        moves_the_chassis: whether it moves the whole car, so that it holds no freedom of the mechanism.
    """

    unit: ClassVar[str] = "mm"
    length: ClassVar[str] = ""
    moves_the_chassis: ClassVar[bool] = False

    @property
    def kind(self) -> str:
        """The kind by name: arm, turn, travel, steers, height, contact, distance, moves or turns."""
        return type(self).__name__.lower()

    @property
    def directions(self) -> tuple[str, ...]:
        """Directions of the car that the input needs, fixed to the chassis."""
        return self.named("direction")

    @property
    def holds(self) -> int:
        """Number of freedoms that it holds when driven: one for each of its slides, otherwise one."""
        return max(len(self.named("slide")), 1)


class Arm(Input):
    """The angle between an arm of a body and a direction of the car, rad."""

    unit = "rad"
    angle: Body
    of: Point
    about: Point
    from_: Direction = Field(alias="from")

    def check(self, bodies: Bodies) -> None:
        if self.of == self.about:
            raise TableFault(("of",), f"is {self.of!r}, the same point as about", "two different points")
        if self.angle == CHASSIS:
            raise TableFault(("angle",), "is the chassis, which does not turn", "a moving body")
        for key in ("of", "about"):
            known_name(f"point of {self.angle}", getattr(self, key), bodies[self.angle], (key,))


class Turn(Input):
    """The rotation of a body about a hinge, from the drawing, rad."""

    unit = "rad"
    angle: Body
    from_: Literal["drawing"] = Field(alias="from")
    on: Body = CHASSIS

    def check(self, bodies: Bodies) -> None:
        shared = [point for point in bodies[self.angle] if point in bodies[self.on]]
        if self.angle in (CHASSIS, self.on) or len(shared) != 2:
            points = ", ".join(shared) or "no point"
            problem = f"{self.angle} and {self.on} share {points}, which is not a hinge"
            raise TableFault((), problem, "a moving body, and another that shares two points with it")


class Travel(Input):
    """The travel of slides, mm."""

    travel: SlideNames


class Steers(Input):
    """The rotation of a steering wheel, whose pinion moves slides, rad."""

    unit = "rad"
    length = "rack_per_turn"
    steers: SlideNames


class Height(Input):
    """The height of a point, mm."""

    height: Point
    along: Direction = "up"

    def check(self, bodies: Bodies) -> None:
        if self.height in bodies[CHASSIS]:
            problem = f"is {self.height!r}, a point of the chassis, whose height is fixed"
            raise TableFault(("height",), problem, "a point that moves")


class Contact(Input):
    """The height of a wheel's contact point, in the chassis' frame or over the ground, mm."""

    length = "wheel_radius"
    contact: Pair
    over: Literal["chassis", "ground"] = CHASSIS

    @property
    def directions(self) -> tuple[str, ...]:
        return ("up",)

    def check(self, bodies: Bodies) -> None:
        both = [body for body, points in bodies.items() if {*self.contact} <= {*points}]
        if not both or CHASSIS in both:
            of = "points of the chassis" if both else "not points of one body"
            problem = f"{' and '.join(self.contact)} are {of}, so they are no wheel axis"
            raise TableFault(("contact",), problem, "two points of one moving body")


class Distance(Input):
    """The distance between two points, mm."""

    distance: Pair

    def check(self, bodies: Bodies) -> None:
        check_apart(self.distance, bodies)


class Moves(Input):
    """A displacement of the whole car, mm."""

    moves_the_chassis = True
    moves: Chassis
    along: Direction


class Turns(Input):
    """A rotation of the whole car, rad."""

    unit = "rad"
    moves_the_chassis = True
    turns: Chassis
    about: Point
    along: Direction

    @property
    def directions(self) -> tuple[str, ...]:
        return (axis_along(self.along),)


KINDS: Mapping[str, type[Input]] = {
    kind.__name__.lower(): kind
    for kind in (Arm, Turn, Travel, Steers, Height, Contact, Distance, Moves, Turns)
}
TELLING = ("angle", "travel", "steers", "height", "contact", "distance", "moves", "turns")


def input_of(table: object) -> object:
    """A table as an input of the kind that one of its keys indicates.

    Raises:
        TableFault: no key or several keys indicate a kind, or the table is not one of that kind.
    """
    if not isinstance(table, Mapping):
        return table
    found = [key for key in TELLING if key in table]
    if not found:
        raise no_such("kind of input", next(iter(table), ""), TELLING, (next(iter(table), ""),))
    if len(found) > 1:
        raise TableFault((), f"is of several kinds: {', '.join(found)}", f"one of {', '.join(TELLING)}")
    kind = KINDS[found[0]] if found[0] != "angle" else Turn if table.get("from") == "drawing" else Arm
    return kind.model_validate(table)


def check_apart(ends: Ends, bodies: Bodies) -> None:
    """Check that no body fixes the distance of two points.

    Raises:
        TableFault: a body has both.
    """
    for body, points in bodies.items():
        if {*ends} <= {*points}:
            raise TableFault((), f"joins two points of {body}, whose distance is fixed", "two bodies")


def renamed(names: Any, kind: str, new: Rename) -> Any:
    """A name of a kind, or a tuple of such names, with new names."""
    return tuple(new(kind, name) for name in names) if isinstance(names, tuple) else new(kind, names)
