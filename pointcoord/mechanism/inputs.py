"""The kinds of inputs, each with its keys and what the keys may name.

Rows and drives of inputs are made in `compiled`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from pointcoord.linkage.directions import DIRECTIONS, axis_along
from pointcoord.mechanism.faults import TableFault, known_keys, known_name, no_such
from pointcoord.wording import shown

LENGTHS = {
    "wheel_radius": ("the height of the wheel's contact point", 300.0),
    "rack_per_turn": ("the turn of a steering wheel", 50.0),
}
"""Further lengths that inputs may need: the kind of input, for messages, and a typical value, mm."""
CHASSIS: Literal["chassis"] = "chassis"


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
    known_name("direction", name, DIRECTIONS)
    return name


Name = Annotated[str, Field(strict=True, min_length=1)]
Ends = tuple[Name, Name]
Role = Name | Ends
Distinct = Annotated[tuple[Name, ...], AfterValidator(_once)]
Names = Annotated[tuple[Name, ...], Field(min_length=1), AfterValidator(_once)]
# The last word says what kind of object the name belongs to.
Point = Annotated[Name, "point"]
Pair = Annotated[Ends, BeforeValidator(_pair), "point"]
Body = Annotated[Name, "body"]
SlideNames = Annotated[Names, BeforeValidator(lambda v: (v,) if isinstance(v, str) else v), "slide"]
Direction = Annotated[Name, AfterValidator(_direction), "direction"]
Chassis = Literal["chassis"]

Bodies = Mapping[str, Sequence[str]]


class Entry(BaseModel):
    """An entry of a table; its field types say which values name points, bodies, slides or directions."""

    model_config = ConfigDict(frozen=True, defer_build=True)

    def named(self, what: str) -> tuple[str, ...]:
        """The names of points, bodies, slides or directions in the entry."""
        values = [getattr(self, key) for key in self._naming(what)]
        return tuple(n for value in values for n in (value if isinstance(value, tuple) else (value,)))

    def renamed(self, rename: Mapping[str, Mapping[str, str]]) -> Self:
        """The entry with other names for points, bodies or slides."""
        keys = ((key, names) for what, names in rename.items() for key in self._naming(what))
        return self.model_copy(update={key: renamed(getattr(self, key), names) for key, names in keys})

    @classmethod
    def _naming(cls, what: str) -> list[str]:
        return [key for key, own in cls.model_fields.items() if what in own.metadata]


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

    def check(self, bodies: Bodies) -> None:
        """Check that the names, which exist, fit together.

        Raises:
            TableFault: the names make no input; its place is relative to the input's place.
        """


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
        for key, point in (("of", self.of), ("about", self.about)):
            known_name(f"point of {self.angle}", point, bodies[self.angle], (key,))


class Turn(Input):
    """The rotation of a body about a hinge, from the drawing, rad."""

    unit = "rad"
    angle: Body
    from_: Literal["drawing"] = Field(alias="from")
    on: Body = CHASSIS

    def check(self, bodies: Bodies) -> None:
        shared = [point for point in bodies[self.angle] if point in bodies[self.on]]
        if self.angle in (CHASSIS, self.on) or len(shared) != 2:
            points = ", ".join(shared if self.angle != self.on else ()) or "no point"
            problem = f"{self.angle} and {self.on} share {points}, which is not a hinge"
            raise TableFault((), problem, "two bodies that share two points")


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
        if not any({*self.contact} <= {*points} for points in bodies.values()):
            problem = f"{' and '.join(self.contact)} do not belong to one body, so they are no wheel axis"
            raise TableFault((), problem, "two points of one body")
        if {*self.contact} <= {*bodies[CHASSIS]}:
            problem = f"{' and '.join(self.contact)} are points of the chassis, whose height is fixed"
            raise TableFault((), problem, "two points of a moving body")


class Distance(Input):
    """The distance between two points, mm."""

    distance: Pair

    def check(self, bodies: Bodies) -> None:
        for body, points in bodies.items():
            if {*self.distance} <= {*points}:
                raise TableFault((), f"joins two points of {body}, whose distance is fixed", "two bodies")


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
        TableFault: no key or several keys indicate a kind, or a key does not belong to that kind.
    """
    if not isinstance(table, Mapping):
        raise TableFault((), f"is {shown(table)}", 'a table, such as { height = "a" }')
    found = [key for key in TELLING if key in table]
    if len(found) != 1:
        hint = next((key for key in table if key not in ("along", "about")), "")
        if not found and hint:
            raise no_such("kind of input", hint, TELLING, (hint,))
        counted = f"has keys of {len(found)} kinds" if found else "has no key of a known kind"
        raise TableFault((), counted, f"one of {', '.join(TELLING)}")
    kind = KINDS[found[0]] if found[0] != "angle" else Turn if table.get("from") == "drawing" else Arm
    known_keys(table, [own.alias or key for key, own in kind.model_fields.items()])
    return kind.model_validate(table)


def renamed(value: Any, names: Mapping[str, str]) -> Any:
    """A name, or a tuple of names, with those in `names` replaced."""
    return tuple(names.get(n, n) for n in value) if isinstance(value, tuple) else names.get(value, value)
