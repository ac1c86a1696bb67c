"""A linkage as plain data: points, the bodies that hold them, joints and inputs."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from absolute.errors import DescriptionError
from absolute.laws import LAWS
from absolute.mapping import ReadOnly
from absolute.solution import Array

Vector = tuple[float, float, float]

# Rows each joint kind takes away from the six relative freedoms of its two bodies.
JOINT_ROWS = {"spherical": 3, "universal": 4, "cylindrical": 4, "revolute": 5, "prismatic": 5}

# The product of three vectors between such points, mm^3, is far from the end of the floating-point range.
LARGEST_COORDINATE = 1e100


@dataclass(frozen=True)
class Axis:
    """A line fixed to a body, as drawn.

    Attributes:
        through: a point of the body.
        toward: a second point, of any body: the line leads to where it is drawn; or a direction in
            the frame of the points; or None where only the point matters (spherical joint).
    """

    through: str
    toward: str | Vector | None = None


@dataclass(frozen=True)
class Joint:
    """Two bodies and the axis each brings; the joint makes the two axes fit.

    Kinds: `spherical` joins the points; `revolute` joins points and lines; `cylindrical` makes the
    two lines one line; `prismatic` does so and lets neither body turn about it against the other;
    `universal` joins the points and keeps the two lines at a right angle (the pins of a cross).
    Lines that become one keep the sense in which they are drawn.
    """

    kind: str
    first: str
    second: str
    on_first: Axis
    on_second: Axis


@dataclass(frozen=True)
class Input:
    """A driven coordinate: how far a point of one body stands along an axis of another.

    axis . (point - axis.through) = factor * value          law "linear", value in mm
    axis . (point - axis.through) = factor * cos(value)     law "cosine", value in rad, factor in mm
    """

    first: str
    axis: Axis
    second: str
    point: str
    law: str
    factor: float


@dataclass(frozen=True)
class Carried:
    """The vector between two points as drawn, carried by a body that need not hold them."""

    body: str
    start: str
    end: str


@dataclass(frozen=True)
class BranchSign:
    """A product of vectors whose sign tells the assemblies of a linkage apart.

    Two vectors give a . b, three give (a x b) . c. Choose it so that it is zero where two assemblies
    meet and nowhere else: then no regular motion changes its sign, and the drawing's sign is the
    branch. Each vector leads from one point to another, or is carried, or is a direction of the chassis.

    Attributes:
        vectors: two or three.
        limits: the links that are at their dead point where the product is zero, for messages.
    """

    vectors: tuple[tuple[str, str] | Vector | Carried, ...]
    limits: tuple[str, ...] = ()


@dataclass(frozen=True)
class Corner:
    """What of a linkage is the wheel, the knuckle and the steering axis, and which way the car points.

    Attributes:
        knuckle: the body that carries the wheel.
        wheel_axis: the wheel's spin axis, from its inner point to the wheel centre.
        steering_axis: the axis about which the wheel is steered, from its lower to its upper point.
        up, right, outboard: directions of the car in the frame of the points, given at any length and kept
            as unit vectors; outboard leads from the car's middle to the wheel: right or minus right.
    Raises:
        DescriptionError: a direction is no three finite numbers, or zero.
    """

    knuckle: str
    wheel_axis: tuple[str, str]
    steering_axis: tuple[str, str]
    up: Vector
    right: Vector
    outboard: Vector

    def __post_init__(self) -> None:
        for name in ("up", "right", "outboard"):
            direction = unit_of(name, vector_of(name, name, getattr(self, name)))
            object.__setattr__(self, name, plain(direction))

    @property
    def down(self) -> Vector:
        """Minus up."""
        return plain(-np.array(self.up))

    @property
    def inboard(self) -> Vector:
        """Minus outboard."""
        return plain(-np.array(self.outboard))

    @property
    def forward(self) -> Vector:
        """up x right: -x where x is rearward, y right and z up."""
        return plain(np.cross(self.up, self.right))

    @property
    def rearward(self) -> Vector:
        """Minus forward."""
        return plain(np.cross(self.right, self.up))


@dataclass(frozen=True)
class Model:
    """A linkage, checked on construction.

    Attributes:
        points: name -> (x, y, z) of the drawing, mm.
        chassis: name of the body that does not turn and carries all others.
        bodies: name -> names of its points; the chassis is one of them.
        joints: name -> Joint.
        inputs: name -> Input.
        branch_signs: name -> BranchSign, whose sign in the drawing every pose must keep; none by default.
        corner: what of it is the wheel, where effects are asked for; none by default.
    Raises:
        DescriptionError: a name is unknown, a number is not finite, a coordinate is beyond
            LARGEST_COORDINATE, an axis has no length, or joints and inputs do not give six rows per
            moving body.
    """

    points: Mapping[str, Vector]
    chassis: str
    bodies: Mapping[str, tuple[str, ...]]
    joints: Mapping[str, Joint]
    inputs: Mapping[str, Input]
    branch_signs: Mapping[str, BranchSign] = field(default_factory=dict)
    corner: Corner | None = None

    def __post_init__(self) -> None:
        points = {name: point_of(name, value) for name, value in self.points.items()}
        object.__setattr__(self, "points", ReadOnly(points))
        object.__setattr__(self, "bodies", ReadOnly({k: tuple(v) for k, v in self.bodies.items()}))
        object.__setattr__(self, "joints", ReadOnly(self.joints))
        object.__setattr__(self, "inputs", ReadOnly(self.inputs))
        object.__setattr__(self, "branch_signs", ReadOnly(self.branch_signs))
        _check_bodies(self)
        for name, joint in self.joints.items():
            _check_choice(f"kind of joint {name!r}", name, joint.kind, JOINT_ROWS)
            _check_pair(self, f"joint {name!r}", name, joint.first, joint.second)
            for body, axis in ((joint.first, joint.on_first), (joint.second, joint.on_second)):
                _check_axis(self, f"joint {name!r}", name, body, axis, joint.kind != "spherical")
        for name, drive in self.inputs.items():
            _check_choice(f"law of input {name!r}", name, drive.law, LAWS)
            _check_pair(self, f"input {name!r}", name, drive.first, drive.second)
            _check_axis(self, f"input {name!r}", name, drive.first, drive.axis, True)
            _check_axis(self, f"input {name!r}", name, drive.second, Axis(drive.point), False)
            if not np.isfinite(drive.factor) or drive.factor == 0:
                raise DescriptionError(
                    f"factor of input {name!r} is {drive.factor!r}; it must be finite and not zero",
                    name,
                    drive.factor,
                )
        for name, sign in self.branch_signs.items():
            _check_branch_sign(self, name, sign)
        if self.corner is not None:
            _check_corner(self, self.corner)
        self._check_count()

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of the bodies that move, in the order given."""
        return tuple(name for name in self.bodies if name != self.chassis)

    def require_corner(self) -> Corner:
        """The corner, for those who need one.

        Raises:
            DescriptionError: the model has none.
        """
        if self.corner is None:
            raise DescriptionError(
                "the linkage does not say which of its parts is the wheel, so it has no effects: give a "
                "`corner`, or ask for no effects",
                "corner",
            )
        return self.corner

    def _check_count(self) -> None:
        rows = sum(JOINT_ROWS[joint.kind] for joint in self.joints.values()) + len(self.inputs)
        unknowns = 6 * len(self.moving)
        if rows != unknowns:
            cure = "add an input or a joint" if rows < unknowns else "remove an input or free a joint"
            raise DescriptionError(
                f"joints and inputs give {rows} rows for {unknowns} unknown velocities "
                f"(6 for each of {len(self.moving)} moving bodies); they must be equal: {cure}",
                "rows",
                rows,
            )


def vector_of(what: str, name: str, value: object) -> Vector:
    """Three finite floats, or a DescriptionError that says what is wrong with `what`."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise DescriptionError(f"{what} is {value!r}; three finite numbers are needed", name, value)
    return (float(array[0]), float(array[1]), float(array[2]))


def unit_of(name: str, vector: Vector) -> Array:
    """The direction of a vector, or a DescriptionError where it is zero."""
    array = np.array(vector)
    largest = float(np.abs(array).max())
    if largest == 0:
        raise DescriptionError(f"{name} is {vector}; a direction must not be zero", name, vector)
    # Scaled before the norm: squares of the smallest and largest numbers are lost.
    array = array / largest
    return np.asarray(array / np.linalg.norm(array))


def plain(vector: Array) -> Vector:
    """Three numbers."""
    return (float(vector[0]), float(vector[1]), float(vector[2]))


def point_of(name: str, value: object) -> Vector:
    """Coordinates of a point, mm, or a DescriptionError that says what is wrong with them."""
    point = vector_of(f"point {name!r}", name, value)
    if max(map(abs, point)) > LARGEST_COORDINATE:
        raise DescriptionError(
            f"point {name!r} is {point}; products of such coordinates overflow, so they must lie "
            f"between -{LARGEST_COORDINATE:g} and {LARGEST_COORDINATE:g} mm: correct it or use a larger "
            "unit of length",
            name,
            point,
        )
    return point


def _check_choice(what: str, name: str, value: str, allowed: Mapping[str, object]) -> None:
    if value not in allowed:
        raise DescriptionError(f"{what} is {value!r}; it must be one of {sorted(allowed)}", name, value)


def _check_bodies(model: Model) -> None:
    _check_choice("chassis", "chassis", model.chassis, model.bodies)
    if not model.moving:
        raise DescriptionError("there is no moving body; give at least one beside the chassis", "bodies")
    placed: set[str] = set()
    for body, names in model.bodies.items():
        if not names:
            raise DescriptionError(f"body {body!r} has no points; give it at least one", body)
        for name in names:
            _check_choice(f"a point of body {body!r}", body, name, model.points)
        placed.update(names)
    loose = sorted(set(model.points) - placed)
    if loose:
        raise DescriptionError(f"points {loose} belong to no body; add them to one or drop them", loose[0])


def _check_pair(model: Model, what: str, name: str, first: str, second: str) -> None:
    for body in (first, second):
        _check_choice(f"a body of {what}", name, body, model.bodies)
    if first == second:
        raise DescriptionError(f"{what} joins body {first!r} to itself; name two bodies", name, first)


def _check_axis(model: Model, what: str, name: str, body: str, axis: Axis, needs_line: bool) -> None:
    if axis.through not in model.bodies[body]:
        raise DescriptionError(
            f"{what} uses point {axis.through!r}, which body {body!r} does not hold; "
            f"its points are {list(model.bodies[body])}",
            name,
            axis.through,
        )
    if isinstance(axis.toward, str):
        _check_choice(f"a point of {what}", name, axis.toward, model.points)
    if needs_line and axis.toward is None:
        raise DescriptionError(f"{what} needs a direction at {axis.through!r}: give `toward`", name)
    if axis.toward is not None and not isinstance(axis.toward, str):
        _check_direction(what, name, axis.toward)


def _check_branch_sign(model: Model, name: str, sign: BranchSign) -> None:
    if len(sign.vectors) not in (2, 3):
        raise DescriptionError(
            f"branch sign {name!r} has {len(sign.vectors)} vectors; a product of two or three is needed",
            name,
            sign,
        )
    for vector in sign.vectors:
        if isinstance(vector, Carried):
            _check_choice(f"a body of branch sign {name!r}", name, vector.body, model.bodies)
            ends: tuple[object, ...] = (vector.start, vector.end)
        elif len(vector) == 2 and all(isinstance(end, str) for end in vector):
            ends = vector
        else:
            _check_direction(f"branch sign {name!r}", name, vector)
            continue
        for end in ends:
            _check_choice(f"a point of branch sign {name!r}", name, str(end), model.points)


def _check_corner(model: Model, corner: Corner) -> None:
    _check_choice("the knuckle", "knuckle", corner.knuckle, model.bodies)
    for what, ends in (("wheel_axis", corner.wheel_axis), ("steering_axis", corner.steering_axis)):
        for end in ends:
            _check_choice(f"an end of the {what}", what, end, model.points)


def _check_direction(what: str, name: str, value: object) -> None:
    direction = vector_of(f"a direction of {what}", name, value)
    if not any(direction):
        raise DescriptionError(f"a direction of {what} is {direction}; it must not be zero", name, direction)
