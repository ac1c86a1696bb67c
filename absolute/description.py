"""A linkage as plain data: points, the bodies that hold them, joints and inputs."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from absolute.errors import DescriptionError
from absolute.solution import Array

Vector = tuple[float, float, float]

X, Y, Z = 0, 1, 2
# Of each joint kind: axes i of the first body's frame along which the origins may not part; axes (i of the
# first, j of the second) that stay at a right angle; axes whose product must stay positive.
KINDS: Mapping[str, tuple[tuple[int, ...], tuple[tuple[int, int], ...], tuple[tuple[int, int], ...]]] = {
    "spherical": ((X, Y, Z), (), ()),
    "revolute": ((X, Y, Z), ((Y, Z), (X, Z)), ((Z, Z),)),
    "prismatic": ((X, Y), ((Y, Z), (X, Z), (Y, X)), ((Z, Z), (X, X))),
    "on_line": ((X, Y), (), ()),
    "key": ((), ((Y, X),), ((X, X),)),
    "parallel": ((), ((Y, Z), (X, Z), (Y, X)), ((Z, Z), (X, X))),
    "level": ((), ((Z, Z),), ()),
    "distance": ((), (), ()),
}


@dataclass(frozen=True)
class Axis:
    """A line fixed to a body, as drawn.

    Attributes:
        through: a point of the body.
        toward: a second point, of any body: the line leads to where it is drawn; or a direction in
            the frame of the points; or None where only the point matters.
    """

    through: str
    toward: str | Vector | None = None


@dataclass(frozen=True)
class Joint:
    """Two bodies and the axis each brings; the joint makes the two axes fit.

    Kinds: `spherical` joins the points; `revolute` joins points and lines; `prismatic` makes the two
    lines one line and lets neither body turn against the other; `on_line` keeps the point of the second
    body on the line of the first, and `key` keeps the second body from turning about its line there;
    `parallel` lets neither body turn against the other; `level` keeps the two lines at a right angle;
    `distance` keeps the points as far apart as drawn. Lines that become one keep the sense in which they
    are drawn.
    """

    kind: str
    first: str
    second: str
    on_first: Axis
    on_second: Axis

    @property
    def rows(self) -> int:
        """How many of the six relative freedoms it takes away."""
        offsets, angles, _ = KINDS[self.kind]
        return len(offsets) + len(angles) + (self.kind == "distance")


@dataclass(frozen=True)
class Input:
    """A driven coordinate: how far a point of one body stands along an axis of another, or from it.

    axis . (point - axis.through) = factor * value          law "linear", value in mm
    axis . (point - axis.through) = factor * cos(value)     law "cosine", value in rad, factor in mm
    |point - axis.through|        = factor * value          law "distance", value in mm
    turn of `second` against `first` about the axis, which a hinge gives them = factor * value
                                                            law "turn", value in rad, 0 in the drawing

    Attributes:
        value: name of the value, which several coordinates may take.
        steers: whether it is the travel of a slide.
    """

    first: str
    axis: Axis
    second: str
    point: str
    law: str
    factor: float
    value: str
    steers: bool = False


@dataclass(frozen=True)
class Load:
    """What the ground does to a wheel at its contact point: N and N mm, in the frame of the points."""

    force: Vector
    moment: Vector


@dataclass(frozen=True)
class Corner:
    """A wheel: what of a linkage carries it, and which way the car points.

    Attributes:
        side: of the car, "left" or "right".
        outboard, rearward, up: directions of the car in the frame of the points, unit vectors; outboard leads
            from the car's middle to the wheel: right or minus right.
        roles: the two points each of `wheel_axis` (inner point, wheel centre), `steering_axis` (lower, upper)
            and `damper`, as far as the linkage has them.
        knuckle: the body that carries the wheel, "" if there is none.
        wheel_radius: of the wheel, mm, if it is given.
        car: numbers of the car, as far as they are given (see `car_of`).
    """

    side: str
    outboard: Vector
    rearward: Vector
    up: Vector
    roles: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    knuckle: str = ""
    wheel_radius: float | None = None
    car: Mapping[str, float] = field(default_factory=dict)

    @property
    def axes(self) -> Array:
        """(3, 3) with outboard, rearward and up as rows."""
        return np.array((self.outboard, self.rearward, self.up))

    def ends(self, role: str) -> tuple[str, str]:
        """The two points of a role; DescriptionError where the mechanism has none."""
        if role not in self.roles:
            raise DescriptionError(
                f"needs the role {role!r}, and the mechanism has none: name the two points of {role} in "
                "[roles], or ask for other effects",
                role,
            )
        return self.roles[role]

    @property
    def carrier(self) -> str:
        """The knuckle; DescriptionError where there is none."""
        if not self.knuckle:
            raise DescriptionError(
                "needs the role 'knuckle', and the mechanism has none: name the body that carries the wheel "
                "in [roles], or ask for other effects",
                "knuckle",
            )
        return self.knuckle

    @property
    def radius(self) -> float:
        """The wheel's radius, mm; DescriptionError where it is not given."""
        if self.wheel_radius is None:
            raise DescriptionError(
                "needs wheel_radius, and none is given: write it in [mechanism], in mm, or ask for other "
                "effects",
                "wheel_radius",
            )
        return self.wheel_radius


@dataclass(frozen=True)
class Model:
    """A linkage, as `compile` makes it of names that it has checked.

    Attributes:
        points: name -> (x, y, z) of the drawing, mm.
        chassis: name of the body that carries all others.
        bodies: name -> names of its points; the chassis is one of them.
        joints: name -> Joint.
        inputs: name -> Input.
        corners: part -> its wheel; "" for a mechanism without parts.
        loads: part -> what acts on its wheel.
        ball_joints: point that two bodies share, and no other -> the one whose force is reported.
        aids: bodies, and points, that are there for the equations only and are not reported.
        turns: name -> Axis through the drawn place of a point, by which inputs of these names turn the whole
            car, one after the other; these directions do not turn.
    """

    points: Mapping[str, Vector]
    chassis: str
    bodies: Mapping[str, tuple[str, ...]]
    joints: Mapping[str, Joint]
    inputs: Mapping[str, Input]
    corners: Mapping[str, Corner]
    loads: Mapping[str, Load] = field(default_factory=dict)
    ball_joints: Mapping[str, str] = field(default_factory=dict)
    aids: frozenset[str] = frozenset()
    turns: Mapping[str, Axis] = field(default_factory=dict)

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of the bodies that move, in the order given."""
        return tuple(name for name in self.bodies if name != self.chassis)

    @property
    def values(self) -> tuple[str, ...]:
        """Names of the values that the inputs take, each once."""
        return tuple(dict.fromkeys(drive.value for drive in self.inputs.values()))

    @property
    def steering(self) -> frozenset[str]:
        """Names of the values that are the travel of a slide."""
        return frozenset(drive.value for drive in self.inputs.values() if drive.steers)

    @property
    def reported(self) -> tuple[str, ...]:
        """Names of the points that are not aids."""
        return tuple(name for name in self.points if name not in self.aids)

    def input_of(self, part: str, by: str, what: str) -> str:
        """The one driven input of a part, or of all, that is the travel of a slide ("rack") or is not.

        Raises:
            DescriptionError: there is none, or another; `what` needs it.
        """
        others = tuple(f"{other}." for other in self.corners if other != part)
        own = [value for value in self.values if not value.startswith(others)]
        found = [value for value in own if (value in self.steering) == (by == "rack")]
        if len(found) != 1:
            kind = "is the travel of a slide" if by == "rack" else "is not the travel of a slide"
            raise DescriptionError(
                f"{what} needs exactly one driven input that {kind}, and there are {len(found)}: "
                f"{found} of {own}; drive other inputs, or ask for other effects",
                what,
                found,
            )
        return found[0]
