"""A linkage as `compile` makes it: bodies as drawn, rows, inputs, wheels."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from absolute.errors import DescriptionError
from absolute.vectors import Array, Places

CHASSIS = "chassis"
# Numbers of the whole car that some effects need, with examples for messages.
CAR: Mapping[str, str | float] = {
    "axle": "front",
    "wheelbase": 2700.0,
    "centre_of_gravity_height": 550.0,
    "brake_share": 0.6,
    "drive_share": 0.5,
    "spring_rate": 30.0,
    "spring_free_length": 350.0,
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
    """A driven row, equal to factor * value or factor * cos(value).

    Attributes:
        value: name of the value, which several rows may share; mm or rad.
        drawn: the value in the drawing.
        steers: travel of the slide per unit of the value, mm; 0 if the input drives no slide.
        turns: whether it turns the whole car. rolls: whether it does so about a line along the car.
        over_ground: whether it is a height over the ground, which displacements of the car change.
    """

    row: Row
    value: str
    factor: float
    drawn: float
    cosine: bool = False
    steers: float = 0.0
    turns: bool = False
    rolls: bool = False
    over_ground: bool = False


@dataclass(frozen=True)
class Drawing:
    """Bodies as drawn, in units of the mechanism's size; body frames are parallel to the points' frame.

    The difference of two given coordinates has one rounding, however close the points are; coordinates from
    the middle are rounded already. So the origin of a body that moves in the car is one of its points.

    Attributes:
        points: name -> (3,), mm.
        middle: mean of the points, mm. Positions are measured from here, so that results do not depend on the
            distance of the car from its origin.
        size: unit of length: largest distance of a point from the middle, mm.
        bodies: name -> index; 0 is the body that stands still.
        anchors: (bodies, 3) origin of each body, mm: the middle for the chassis.
        holders: name of a point -> the first body that has it.
    """

    points: Mapping[str, Array]
    middle: Array
    size: float
    bodies: Mapping[str, int]
    anchors: Array
    holders: Mapping[str, str]

    @property
    def origins(self) -> Array:
        """(bodies, 3) origins of the body frames, from the middle."""
        return np.asarray((self.anchors - self.middle) / self.size)

    def line(self, start: str, end: str) -> Array:
        """Vector from one drawn point to another."""
        return np.asarray((self.points[end] - self.points[start]) / self.size)

    def arm(self, body: int, point: str) -> Array:
        """Vector from the origin of a body to a point."""
        return np.asarray((self.points[point] - self.anchors[body]) / self.size)

    def held(self) -> tuple[Places, Array]:
        """Body of each point, (P,), and the vectors from the bodies' origins, (P, 3)."""
        body = np.array([self.bodies[self.holders[point]] for point in self.points], dtype=np.intp)
        return body, (np.array(list(self.points.values())) - self.anchors[body]) / self.size


class Load(NamedTuple):
    """Load of the ground on a wheel at its contact point: N and N mm, in the frame of the points."""

    force: Array
    moment: Array


@dataclass(frozen=True)
class Corner:
    """A wheel: its points and body in the linkage, and the car's axes.

    Attributes:
        side: side of the car, "left" or "right".
        axes: (3, 3) outboard, rearward and up in the frame of the points, unit vectors as rows; outboard
            leads from the car's middle to the wheel: right or minus right.
        roles: the two points each of `wheel_axis` (inner point, wheel centre), `steering_axis` (lower, upper)
            and `damper`, as far as the linkage has them.
        knuckle: the body that carries the wheel, "" if there is none.
        wheel_radius: mm, or None if not given.
        car: numbers of the car, as far as they are given; its axle is -1 for the front and 1 for the rear.
    """

    side: str
    axes: Array
    roles: Mapping[str, tuple[str, str]]
    knuckle: str
    wheel_radius: float | None
    car: Mapping[str, float]

    def ends(self, role: str) -> tuple[str, str]:
        """The two points of a role; DescriptionError without the role."""
        if role not in self.roles:
            raise _lacking(f"the role {role!r}", f"the two points of {role} in [roles]", role)
        return self.roles[role]

    @property
    def carrier(self) -> str:
        """The knuckle; DescriptionError without one."""
        if not self.knuckle:
            raise _lacking("the role 'knuckle'", "the body that carries the wheel in [roles]", "knuckle")
        return self.knuckle

    @property
    def radius(self) -> float:
        """The wheel's radius, mm; DescriptionError without it."""
        if self.wheel_radius is None:
            raise _lacking("wheel_radius", "it in [mechanism], in mm", "wheel_radius")
        return self.wheel_radius

    def numbers(self, *names: str) -> list[float]:
        """Some numbers of the car; the DescriptionError names all missing ones."""
        lacking = [name for name in names if name not in self.car]
        if lacking:
            lines = ", ".join(f"{name} = {json.dumps(CAR[name])}" for name in lacking)
            raise DescriptionError(
                f"needs {' and '.join(lacking)}, not given: write in [car], for example, {lines}, or "
                "ask for other effects",
                lacking[0],
            )
        return [self.car[name] for name in names]


def _lacking(what: str, where: str, name: str) -> DescriptionError:
    return DescriptionError(f"needs {what}, which is missing: write {where}, or ask for other effects", name)


@dataclass(frozen=True)
class Model:
    """A linkage, made by `compile` from checked names.

    Attributes:
        bodies: name -> names of its points. The first one stands still: the chassis, or what it turns on.
        drawing: places of the bodies and points.
        joints, inputs: their rows.
        moves: name of an input that displaces the whole car, after all turns -> the direction.
        corners: part -> its wheel; "" for a mechanism without parts.
        loads: part -> load on its wheel.
        dampers: part -> row of its damper's length, if there are loads.
        reported_joints: point of a ball joint, or both points of a hinge, that exactly two bodies share; or
            point on a slide -> name of the joint, and the body on which the force is reported.
        reported: bodies whose rates are reported.
        unturned: bodies that consist of one free point and do not turn.
    """

    bodies: Mapping[str, tuple[str, ...]]
    drawing: Drawing
    joints: tuple[Row, ...]
    inputs: tuple[Input, ...]
    moves: Mapping[str, Array]
    corners: Mapping[str, Corner]
    loads: Mapping[str, Load]
    dampers: Mapping[str, Row]
    reported_joints: Mapping[tuple[str, ...], tuple[str, str]]
    reported: tuple[str, ...]
    unturned: frozenset[str]

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
            "roll": ("rolls the chassis", [drive for drive in self.inputs if drive.rolls]),
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
