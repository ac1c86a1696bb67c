"""A linkage as plain data: points, the bodies that hold them, joints and inputs."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from absolute.errors import DescriptionError
from absolute.mapping import ReadOnly
from absolute.solution import Array

Vector = tuple[float, float, float]

# Rows each joint kind takes away from the six relative freedoms of its two bodies.
JOINT_ROWS = {
    "spherical": 3,
    "revolute": 5,
    "prismatic": 5,
    "on_line": 2,
    "key": 1,
    "parallel": 3,
    "level": 1,
    "distance": 1,
}
# Of these only the points matter.
WITHOUT_LINE = ("spherical", "parallel", "distance")

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


@dataclass(frozen=True)
class Input:
    """A driven coordinate: how far a point of one body stands along an axis of another, or from it.

    axis . (point - axis.through) = factor * value          law "linear", value in mm
    axis . (point - axis.through) = factor * cos(value)     law "cosine", value in rad, factor in mm
    |point - axis.through|        = factor * value          law "distance", value in mm
    turn of `second` against `first` about the axis, which a hinge gives them = factor * value
                                                            law "turn", value in rad, 0 in the drawing

    Attributes:
        value: name of the value where several coordinates take the same; the coordinate's own by default.
        steers: whether it is the travel of a slide.
    """

    first: str
    axis: Axis
    second: str
    point: str
    law: str
    factor: float
    value: str = ""
    steers: bool = False


@dataclass(frozen=True)
class Corner:
    """What of a linkage is the wheel and the steering axis, and which way the car points.

    Attributes:
        outboard, rearward, up: directions of the car in the frame of the points, unit vectors; outboard leads
            from the car's middle to the wheel: right or minus right.
        roles: the two points each of `wheel_axis` (inner point, wheel centre), `steering_axis` (lower, upper)
            and `damper`, as far as the linkage has them.
        wheel_radius: of the wheel, mm, if it is given.
        car: numbers of the car, as far as they are given (see `car_of`).
    """

    outboard: Vector
    rearward: Vector
    up: Vector
    roles: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    wheel_radius: float | None = None
    car: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("roles", "car"):
            object.__setattr__(self, name, ReadOnly(getattr(self, name)))

    @property
    def axes(self) -> Array:
        """(3, 3) with outboard, rearward and up as rows."""
        return np.array((self.outboard, self.rearward, self.up))

    def ends(self, role: str) -> tuple[str, str]:
        """The two points of a role.

        Raises:
            DescriptionError: the mechanism has no such role.
        """
        if role not in self.roles:
            raise DescriptionError(
                f"needs the role {role!r}, and the mechanism has none: name the two points of {role} in "
                "[roles], or ask for other effects",
                role,
            )
        return self.roles[role]

    @property
    def radius(self) -> float:
        """The wheel's radius, mm.

        Raises:
            DescriptionError: it is not given.
        """
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
        corner: what of it is the wheel.
        aids: bodies, and points, that are there for the equations only and are not reported.
        turns: name -> Axis through the drawn place of a point, by which inputs of these names turn the whole
            car, one after the other; these directions do not turn.
    Raises:
        DescriptionError: no body moves, a body has no point or a point no body, or joints and inputs give
            fewer than six rows per moving body.
    """

    points: Mapping[str, Vector]
    chassis: str
    bodies: Mapping[str, tuple[str, ...]]
    joints: Mapping[str, Joint]
    inputs: Mapping[str, Input]
    corner: Corner
    aids: frozenset[str] = frozenset()
    turns: Mapping[str, Axis] = field(default_factory=dict)

    def __post_init__(self) -> None:
        # Turns last: rows of lengths and rows of angles stay apart.
        driven = dict(sorted(self.inputs.items(), key=lambda drive: drive[1].law == "turn"))
        object.__setattr__(self, "inputs", driven)
        for name in ("points", "bodies", "joints", "inputs", "turns"):
            object.__setattr__(self, name, ReadOnly(getattr(self, name)))
        _check_bodies(self)
        self._check_count()

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of the bodies that move, in the order given."""
        return tuple(name for name in self.bodies if name != self.chassis)

    @property
    def values(self) -> tuple[str, ...]:
        """Names of the values that the inputs take, each once."""
        return tuple(dict.fromkeys(drive.value or name for name, drive in self.inputs.items()))

    @property
    def steering(self) -> frozenset[str]:
        """Names of the values that are the travel of a slide."""
        return frozenset(drive.value or name for name, drive in self.inputs.items() if drive.steers)

    @property
    def reported(self) -> tuple[str, ...]:
        """Names of the points that are not aids."""
        return tuple(name for name in self.points if name not in self.aids)

    def _check_count(self) -> None:
        rows = sum(JOINT_ROWS[joint.kind] for joint in self.joints.values()) + len(self.inputs)
        unknowns = 6 * len(self.moving)
        if rows < unknowns:
            raise DescriptionError(
                f"joints and inputs give {rows} rows for {unknowns} unknown velocities (6 for each of "
                f"{len(self.moving)} moving bodies), so {unknowns - rows} freedoms are left over: add "
                "an input or a joint",
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


def _check_bodies(model: Model) -> None:
    if not model.moving:
        raise DescriptionError("there is no moving body; give at least one beside the chassis", "bodies")
    placed: set[str] = set()
    for body, names in model.bodies.items():
        if not names:
            raise DescriptionError(f"body {body!r} has no points; give it at least one", body)
        placed.update(names)
    loose = sorted(set(model.points) - placed)
    if loose:
        raise DescriptionError(f"points {loose} belong to no body; add them to one or drop them", loose[0])
