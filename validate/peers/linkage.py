r"""A suspension as any multibody program is told it: bodies on joints, a tree, and ball joints that close it.

    chassis - hinge (driven) - arm - ball - knuckle
    chassis - slide (driven) - rack - ball - tie rod      closed by tie rod - ball - knuckle
    strut:    knuckle - slide - rod                       closed by rod - ball - chassis
    wishbone: chassis - hinge - upper arm                 closed by upper arm - ball - knuckle

Lengths are told from a hardpoint, in a power of two of mm that is the size of the car: programs take lengths
about 1 best, and another unit of that kind rounds nothing.

Programs have no input that is the height of an arm's end, so the turn phi of the arm from its drawing is
told, which follows from

    r(phi) . up = d cos(theta),    r(phi) = along + across cos(phi) + (n x across) sin(phi),

r from the front pivot to the ball joint, n the unit vector of the pivots' line. An assembly is told by three
signs, which change only where two assemblies meet: the side of the arm, which picks one of the two phi; the
side of what holds the knuckle's upper end; and the side of the tie rod beside the steering axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.data_classes import dataclass

Array = NDArray[np.float64]
Kind = Literal["hinge", "ball", "slide"]

CHASSIS = "chassis"
ARM, KNUCKLE, RACK, TIE_ROD, ROD, UPPER_ARM = "arm", "knuckle", "rack", "tie rod", "rod", "upper arm"
DRIVEN = (ARM, RACK)
"""The bodies whose joints are driven: by the arm's turn, rad, and by the rack's travel."""
# Below this share of the lengths that a side is made of, a drawing lies on both sides; of drawings that need
# not be assembled.
CLEAR_SIDE = 1e-9
UNIT_ROUNDOFF = 0.5 * float(np.finfo(float).eps)


class PeerError(Exception):
    """A peer does not answer: the drawing makes no mechanism, or a pose is not reached.

    Attributes:
        instant: its number, None if it is the drawing.
    """

    def __init__(self, problem: str, instant: int | None = None) -> None:
        self.problem = problem
        self.instant = instant
        super().__init__(problem)


@dataclass(frozen=True)
class Joint:
    """How a body hangs on another one; both are told in drawn coordinates, about parallel axes.

    Attributes:
        on_parent, on_child: where the joint is in either body; of a slide, where it stands at travel zero.
        axis: of a hinge or a slide, a unit vector; of the tie rod's ball joint the rod itself.
        drawn: travel of a slide at the drawing.
    """

    kind: Kind
    parent: str
    child: str
    on_parent: Array
    on_child: Array
    axis: Array
    drawn: float = 0.0


@dataclass(frozen=True)
class Loop:
    """A ball joint that closes the tree: a place of one body that a place of another one must meet."""

    name: str
    body: str
    place: Array
    other: str
    other_place: Array


@dataclass(frozen=True)
class Inputs:
    """What is told to a program, and how far it may be off by rounding; in the linkage's unit.

    Attributes:
        driven, doubt: turn of the arm and travel of the rack with two time derivatives, (N, 3, 2).
        chassis: displacement of the chassis and two time derivatives, (N, 3, 3), mm.
    """

    driven: Array
    doubt: Array
    chassis: Array


@dataclass(frozen=True)
class Linkage:
    """A suspension; every place is (3,), from `origin` in `unit`.

    Attributes:
        drawn: every hardpoint as drawn.
        joints: parents first.
        points: the body of each moving point, and its place there.
        kingpin: the two points of the steering axis, the lower one first; its angles are those of `leaning`.
        spin_axis: the two points of the wheel's axis, the inner one first.
        origin: mm. unit: mm.
    """

    drawn: Mapping[str, Array]
    up: Array
    right: Array
    outboard: Array
    joints: tuple[Joint, ...]
    loops: tuple[Loop, ...]
    points: Mapping[str, tuple[str, Array]]
    knuckle: tuple[str, str, str]
    kingpin: tuple[str, str]
    leaning: tuple[str, str]
    spin_axis: tuple[str, str]
    origin: Array
    unit: float

    @property
    def drawn_inputs(self) -> Array:
        """Turn of the arm and travel of the rack at the drawing, (2,)."""
        return np.array([0.0, next(joint.drawn for joint in self.joints if joint.child == RACK)])

    def inputs(self, laws: Mapping[str, Array]) -> Inputs:
        """What is told to a program.

        Args:
            laws: every input's value and two time derivatives, (N, 3), rad or mm per s^d.
        Raises:
            PeerError: the arm does not reach what it is driven to.
        """
        turn, off = self.turns(laws["arm_angle"])
        travel = laws["rack"] / self.unit
        doubt = np.stack([off, UNIT_ROUNDOFF * np.abs(travel)], axis=-1)
        heave = laws["heave"] if "heave" in laws else np.zeros_like(travel)
        return Inputs(np.stack([turn, travel], axis=-1), doubt, heave[..., None] * self.up)

    def turns(self, theta: Array) -> tuple[Array, Array]:
        """The arm's turn from its drawing with two time derivatives, and how far rounding may put them off.

        Args:
            theta: the input and its time derivatives, (N, 3).
        Returns:
            Two arrays (N, 3); the second are estimates: eight roundings of what each number is made of, and
            what the numbers before it are off by.
        Raises:
            PeerError: the arm does not reach such a height, or is drawn where its two sides meet.
        """
        front, rear, ball = (self.drawn[n] for n in ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"))
        n, r = _unit(rear - front, "lower_arm_front and lower_arm_rear"), ball - front
        across = r - (r @ n) * n
        cosine, sine = float(across @ self.up), float(np.cross(n, across) @ self.up)
        reach, d = float(np.hypot(cosine, sine)), float(np.linalg.norm(r))
        if abs(sine) <= CLEAR_SIDE * d:
            raise PeerError("the drawing has the lower arm at its dead point, where its two sides meet")
        angle, rate, acceleration = theta.T
        outside = ~((angle >= 0.0) & (angle <= np.pi))
        if outside.any():
            raise PeerError("arm_angle is outside 0 to pi rad", int(np.argmax(outside)))
        height = d * np.cos(angle) - float(r @ n) * float(n @ self.up)
        if (np.abs(height) >= reach).any():
            raise PeerError("the arm does not reach such a height", int(np.argmax(np.abs(height) >= reach)))
        # About the place of the greatest height the height is reach cos(beta); the drawing tells beta's sign.
        side = -np.sign(sine)
        beta = side * np.arctan2(np.sqrt((reach - height) * (reach + height)), height)
        turn = beta - side * np.arctan2(abs(sine), cosine)
        slope = -reach * np.sin(beta)
        lift, push = -d * np.sin(angle) * rate, -d * (np.sin(angle) * acceleration + np.cos(angle) * rate**2)
        first = lift / slope
        second = (push + height * first**2) / slope
        rounding, lean = 8.0 * UNIT_ROUNDOFF, np.abs(height / slope)
        off = rounding * (np.abs(turn) + (d + reach) / np.abs(slope))
        off_first = np.abs(first) * (rounding + lean * off)
        parts = d * (np.abs(np.sin(angle) * acceleration) + np.abs(np.cos(angle)) * rate**2) / np.abs(slope)
        off_second = (rounding + lean * off) * (parts + lean * first**2)
        off_second += 2.0 * lean * np.abs(first) * off_first + first**2 * off
        return np.stack([turn, first, second], axis=-1), np.stack([off, off_first, off_second], axis=-1)

    def sides(self, places: Mapping[str, Array]) -> Array:
        """On which side the upper end and the tie rod are, (..., 2), positive or negative, from places
        (..., 3)."""
        ball, outer, inner = (places[n] for n in ("lower_ball_joint", "tie_rod_outer", "tie_rod_inner"))
        upper = self._upper_side(places)
        k = places[self.kingpin[1]] - ball
        steering = _dot(np.cross(k, inner - ball), outer - ball)
        return np.stack([upper, steering], axis=-1)

    def _upper_side(self, places: Mapping[str, Array]) -> Array:
        ball = places["lower_ball_joint"]
        if "strut_top" in self.drawn:
            # Two places of the axis are as far from the ball joint: one to either side of its foot.
            return _dot(places["strut_top"] - ball, self._strut_axis(places))
        front, rear = (places[n] - ball for n in ("upper_arm_front", "upper_arm_rear"))
        return _dot(np.cross(front, rear), places["upper_ball_joint"] - ball)

    def _strut_axis(self, places: Mapping[str, Array]) -> Array:
        """The axis that is fixed in the knuckle, as the knuckle stands; as long as it may be."""
        axis = next(joint.axis for joint in self.joints if joint.child == ROD)
        drawn, now = (_edges(*(found[n] for n in self.knuckle)) for found in (self.drawn, places))
        shares = np.linalg.solve(np.stack(drawn, axis=-1), axis)
        return np.asarray(sum(share * edge for share, edge in zip(shares, now, strict=True)))

    def on_other_side(self, places: Mapping[str, Array]) -> NDArray[np.bool_]:
        """Which poses, (N,), are no poses of the drawing's assembly.

        Raises:
            PeerError: the drawing is where two assemblies meet.
        """
        wanted = self.sides(self.drawn)
        if not (np.abs(wanted) > CLEAR_SIDE).all():
            raise PeerError("the drawing lies where two assemblies meet")
        return np.asarray((self.sides(places) * np.sign(wanted) <= 0.0).any(axis=-1))

    def with_chassis(self, places: Mapping[str, Array]) -> dict[str, Array]:
        """Every hardpoint, (N, 3), from the moving ones."""
        shape = next(iter(places.values())).shape
        still = {n: np.broadcast_to(p, shape) for n, p in self.drawn.items() if n not in self.points}
        return {n: places[n] if n in places else still[n] for n in self.drawn}


def linkage_of(
    suspension: str,
    points: Mapping[str, ArrayLike],
    up: ArrayLike,
    right: ArrayLike,
    closure: str = "drawn",
    side: str = "left",
) -> Linkage:
    """The bodies and joints of a suspension.

    Args:
        suspension: `macpherson` or `double_wishbone`.
        points: hardpoints, mm.
        closure: of a strut: `drawn` has its axis through strut_lower and strut_top as drawn, `collinear`
            through the ball joint and strut_lower.
        side: of the car, `left` or `right`.
    Raises:
        PeerError: there is no such suspension here, or two points coincide that must not.
    """
    located = {name: np.array(place, dtype=float) for name, place in points.items()}
    located.setdefault("rack_centre", located["tie_rod_inner"])
    corners = np.array(list(located.values()))
    unit = float(np.ldexp(1.0, np.frexp(np.max(np.ptp(corners, axis=0)))[1]))
    origin = located["lower_ball_joint"]
    p = {name: (place - origin) / unit for name, place in located.items()}
    up, right = np.array(up, dtype=float), np.array(right, dtype=float)
    if (suspension, closure) == ("double_wishbone", "drawn"):
        joint, loop, riding = _upper_arm(p)
        knuckle = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer")
    elif suspension == "macpherson" and closure in ("drawn", "collinear"):
        joint, loop, riding = _strut(p, closure)
        knuckle = ("lower_ball_joint", "tie_rod_outer", "strut_lower")
    else:
        raise PeerError(f"there is no {suspension} with closure {closure!r} here")
    rod = p["tie_rod_outer"] - p["tie_rod_inner"]
    ball, rack = p["lower_ball_joint"], p["rack_centre"]
    pivots = _unit(p["lower_arm_rear"] - p["lower_arm_front"], "lower_arm_front and lower_arm_rear")
    travel = float((rack - p["tie_rod_inner"]) @ right)
    joints = (
        Joint("hinge", CHASSIS, ARM, p["lower_arm_front"], p["lower_arm_front"], pivots),
        Joint("ball", ARM, KNUCKLE, ball, ball, pivots),
        joint,
        Joint("slide", CHASSIS, RACK, rack, rack, -right, travel),
        Joint("ball", RACK, TIE_ROD, rack, p["tie_rod_inner"], _unit(rod, "the ends of the tie rod")),
    )
    riding |= {
        "lower_ball_joint": (ARM, ball),
        "tie_rod_outer": (KNUCKLE, p["tie_rod_outer"]),
        "tie_rod_inner": (RACK, rack),
    }
    riding |= {n: (KNUCKLE, p[n]) for n in ("wheel_centre", "wheel_axis_inner") if n in p}
    steering = Loop("tie_rod_outer", TIE_ROD, p["tie_rod_outer"], KNUCKLE, p["tie_rod_outer"])
    top = "strut_top" if suspension == "macpherson" else "upper_ball_joint"
    kingpin = ("lower_ball_joint", top)
    return Linkage(
        drawn=p,
        up=up,
        right=right,
        outboard=-right if side == "left" else right,
        joints=joints,
        loops=(loop, steering),
        points=riding,
        knuckle=knuckle,
        kingpin=kingpin,
        leaning=("lower_ball_joint", "strut_lower") if closure == "collinear" else kingpin,
        spin_axis=("wheel_axis_inner" if "wheel_axis_inner" in p else "strut_lower", "wheel_centre"),
        origin=origin,
        unit=unit,
    )


Riding = dict[str, tuple[str, Array]]


def _strut(p: Mapping[str, Array], closure: str) -> tuple[Joint, Loop, Riding]:
    """The rod that slides along the strut's axis in the knuckle and is held at its top."""
    top = p["strut_top"]
    low, high = (("strut_lower", "strut_top"), ("lower_ball_joint", "strut_lower"))[closure == "collinear"]
    axis = _unit(p[high] - p[low], f"{low} and {high}")
    end = p["strut_rod_end"] - top
    along = np.copysign(np.linalg.norm(end), end @ axis)
    joint = Joint("slide", KNUCKLE, ROD, p[low], top, axis, float((top - p[low]) @ axis))
    riding = {"strut_lower": (KNUCKLE, p["strut_lower"]), "strut_rod_end": (ROD, top + along * axis)}
    return joint, Loop("strut_top", ROD, top, CHASSIS, top), riding


def _upper_arm(p: Mapping[str, Array]) -> tuple[Joint, Loop, Riding]:
    """The upper arm, which holds the knuckle's upper ball joint."""
    front, ball = p["upper_arm_front"], p["upper_ball_joint"]
    pivots = _unit(p["upper_arm_rear"] - front, "upper_arm_front and upper_arm_rear")
    joint = Joint("hinge", CHASSIS, UPPER_ARM, front, front, pivots)
    loop = Loop("upper_ball_joint", UPPER_ARM, ball, KNUCKLE, ball)
    return joint, loop, {"upper_ball_joint": (KNUCKLE, ball)}


def axes_along(axis: Array, first: Array | None = None) -> Array:
    """Right-handed axes as columns, of which the third lies along a unit vector.

    Args:
        first: what the first lies along as nearly as it can; any direction if None, or if it is no other.
    """
    other = np.eye(3)[int(np.argmin(np.abs(axis)))]
    for guess in (other,) if first is None else (first, other):
        across = guess - (guess @ axis) * axis
        if np.linalg.norm(across) > CLEAR_SIDE:
            break
    across = across / np.linalg.norm(across)
    return np.stack([across, np.cross(axis, across), axis], axis=-1)


def _edges(a: Array, b: Array, c: Array) -> tuple[Array, Array, Array]:
    first, second = b - a, c - a
    return first, second, np.cross(first, second)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1))


def _unit(vector: Array, what: str) -> Array:
    length = float(np.linalg.norm(vector))
    if length == 0.0:
        raise PeerError(f"{what} are at the same place")
    return np.asarray(vector / length)
