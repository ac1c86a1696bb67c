"""A linkage as `compile` makes it: bodies as drawn, rows, inputs, wheels."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from absolute.errors import DescriptionError
from absolute.vectors import Array, Places

CHASSIS = "chassis"
# What effects and loads may need, with examples, by table of the description.
ROLES: Mapping[str, str] = {
    "wheel_axis": '["inner point", "wheel centre"]',
    "steering_axis": '["lower point", "upper point"]',
    "damper": '["lower point", "upper point"]',
}
CAR: Mapping[str, str] = {
    "axle": '"front"',
    "wheelbase": "2700.0",
    "centre_of_gravity_height": "550.0",
    "brake_share": "0.6",
    "drive_share": "0.5",
    "spring_rate": "30.0",
    "spring_free_length": "350.0",
}
TABLES: Mapping[str, Mapping[str, str]] = {
    "mechanism": {"wheel_radius": "300.0, in mm"},
    "roles": {**ROLES, "knuckle": '"the body that carries the wheel"'},
    "car": CAR,
}


class Row(NamedTuple):
    """A row of bodies `first` and `second` (indices), by vectors in their axes, in units of size.

    See `rows` for a, r1 and r2.

    Attributes:
        kind: "angle", "offset", "distance" or "turn".
        along: a; for a turn, x; zero for a distance.
        first_arm, second_arm: r1 and r2; for a right angle, zero and the partner direction; for a turn, zero
            and -y.
        drawn: the value that a joint keeps: 0, or the drawn distance.
    """

    owner: str
    kind: str
    first: int
    second: int
    along: Array
    first_arm: Array
    second_arm: Array
    drawn: float = 0.0


class Input(NamedTuple):
    """A driven row, equal to factor * value, or to factor * cos(value) if it is an angle.

    Attributes:
        value: name of the value, which several rows may share; mm or rad.
        drawn: the value in the drawing.
        steers: travel of the slide per unit of the value, mm; 0 if the input drives no slide.
        turns: direction of the line about which it turns the whole car, "" if it does not.
        over_ground: whether it is a height over the ground, which displacements of the car change.
    """

    row: Row
    value: str
    factor: float
    drawn: float
    steers: float = 0.0
    turns: str = ""
    over_ground: bool = False


@dataclass(frozen=True)
class Corner:
    """A wheel: its points and body in the linkage, and the car's axes.

    Attributes:
        side: side of the car, "left" or "right".
        axes: (3, 3) outboard, rearward and up in the frame of the points, unit vectors as rows; outboard
            leads from the car's middle to the wheel: right or minus right.
        given: as far as they are given: the two points each of `wheel_axis` (inner point, wheel centre),
            `steering_axis` (lower, upper) and `damper`; `knuckle`, the body that carries the wheel;
            `wheel_radius`, mm; and numbers of the car; its axle is -1 for the front and 1 for the rear.
    """

    side: str
    axes: Array
    given: Mapping[str, Any]

    def needs(self, *names: str) -> list[Any]:
        """What is given under names of one table; the DescriptionError names all that are missing."""
        if lacking := [name for name in names if name not in self.given]:
            table, examples = next((t, of) for t, of in TABLES.items() if lacking[0] in of)
            lines = ", ".join(f"{name} = {examples[name]}" for name in lacking)
            raise DescriptionError(
                f"needs {' and '.join(lacking)}, not given: write in [{table}], for example, {lines}, or "
                "ask for other effects",
                lacking[0],
            )
        return [self.given[name] for name in names]

    def need(self, name: str) -> Any:
        """What is given under one name; DescriptionError if it is missing."""
        return self.needs(name)[0]


@dataclass(frozen=True)
class Model:
    """A linkage, made by `compile` from checked names.

    Lengths without a unit are in units of the mechanism's size. Body frames are drawn parallel to the frame
    of the points. The difference of two given coordinates has one rounding, however close the points are;
    coordinates from the middle are rounded already. So the origin of a body that moves in the car is one of
    its points.

    Attributes:
        points: name -> (3,) drawn place, mm.
        middle: mean of the points, mm. Positions are measured from here, so that results do not depend on the
            distance of the car from its origin.
        size: unit of length: largest distance of a point from the middle, mm.
        bodies: name -> names of its points. The first one stands still: the chassis, or what it turns on.
        origins: (bodies, 3) drawn origins of the body frames, from the middle.
        holders: name of a point -> index of the first body that has it.
        arms: name of a point -> (3,) vector from the origin of that body.
        joints, inputs: their rows.
        moves: name of an input that displaces the whole car, after all turns -> the direction.
        corners: part -> its wheel; "" for a mechanism without parts.
        loads: part -> (2, 3) load of the ground on its wheel at the contact point, N and N mm, in the frame
            of the points.
        dampers: part -> row of its damper's length, if there are loads.
        reported_joints: point of a ball joint, or both points of a hinge, that exactly two bodies share; or
            point on a slide -> name of the joint, and the body on which the force is reported.
        reported: bodies whose rates are reported.
        unturned: bodies that consist of one free point and do not turn.
    """

    points: Mapping[str, Array]
    middle: Array
    size: float
    bodies: Mapping[str, tuple[str, ...]]
    origins: Array
    holders: Mapping[str, int]
    arms: Mapping[str, Array]
    joints: tuple[Row, ...]
    inputs: tuple[Input, ...]
    moves: Mapping[str, Array]
    corners: Mapping[str, Corner]
    loads: Mapping[str, Array]
    dampers: Mapping[str, Row]
    reported_joints: Mapping[tuple[str, ...], tuple[str, str]]
    reported: tuple[str, ...]
    unturned: frozenset[str]

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Name of a body -> its index; 0 is the body that stands still."""
        return {name: number for number, name in enumerate(self.bodies)}

    def line(self, start: str, end: str) -> Array:
        """Vector from one drawn point to another."""
        return np.asarray((self.points[end] - self.points[start]) / self.size)

    def held(self) -> tuple[Places, Array]:
        """Body of each point, (P,), and the vectors from the bodies' origins, (P, 3)."""
        return np.array([*self.holders.values()], dtype=np.intp), np.array([*self.arms.values()])

    def input_of(self, part: str, by: str, what: str) -> str:
        """The one driven input of a part that is the travel of a slide ("rack"), or is not ("travel"), or the
        one input of the model that rolls the chassis ("roll").

        Raises:
            DescriptionError: there is not exactly one such input, which `what` needs.
        """
        others = tuple(f"{other}." for other in self.corners if other != part)
        held = [drive for drive in self.inputs if not drive.turns and not drive.value.startswith(others)]
        kind, fitting = {
            "travel": ("is not the travel of a slide", [drive for drive in held if not drive.steers]),
            "rack": ("is the travel of a slide", [drive for drive in held if drive.steers]),
            "roll": (
                "rolls the chassis",
                [drive for drive in self.inputs if drive.turns in ("forward", "rearward")],
            ),
        }[by]
        found = list(dict.fromkeys(drive.value for drive in fitting))
        if len(found) != 1:
            own = list(dict.fromkeys(drive.value for drive in held))
            raise DescriptionError(
                f"{what} needs exactly one driven input that {kind}, and there are {len(found)}: "
                f"{found} of {own}; drive other inputs, or ask for other effects",
                what,
                found,
            )
        return found[0]
