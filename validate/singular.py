"""Random cars driven close to a pose where the mechanism locks, each reproducible by its number.

With the links given, an input can go only so far: the lower arm has a dead point, where its ball joint
is highest or lowest on its circle, and tie rod and steering arm can come to lie in line. Both ends are
worked out here in plain floating point from the circles on which the two ball joints move, apart from
both models and from the truth; the input then steps back by a drawn share of its whole range.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Points = dict[str, tuple[float, float, float]]
Inputs = dict[str, float]

PAPER: Points = {
    "lower_arm_front": (270.0, -5.0, -10.0),
    "lower_arm_rear": (540.0, -10.0, -20.0),
    "rack_centre": (570.0, 60.0, 90.0),
    "strut_top": (460.0, -180.0, 470.0),
    "lower_ball_joint": (450.0, -330.0, -40.0),
    "tie_rod_outer": (560.0, -300.0, 60.0),
    "strut_lower": (452.0, -320.0, 20.0),
    "strut_rod_end": (456.0, -250.0, 246.0),
    "tie_rod_inner": (570.0, 60.0, 90.0),
    "wheel_centre": (452.0, -410.0, 20.0),
}
DRIVEN = ("arm_angle", "rack")
ARM, TIE_ROD = "arm", "tie_rod"
NEAREST = 1e-12  # of an input's range: its own rounding is 1e-4 of that
SCAN = 200  # places between the drawing and the end of an input where a closure is looked at
PATH = 60  # places on the way from the drawing where the closures must be met
BISECTIONS = 60  # halve an interval down to the rounding of its ends


@dataclass(frozen=True)
class Car:
    """Hardpoints, mm, and how the car stands in the frame."""

    points: Points
    side: str
    up: tuple[float, float, float]
    right: tuple[float, float, float]


@dataclass(frozen=True)
class NearPose:
    """A car and inputs close to the end of one of them.

    Attributes:
        number: with the seed it gives the same pose again.
        home: the inputs at which the car is drawn; the way from there to `inputs` is open.
        inputs: arm angle (rad), rack and heave (mm).
        driven: the input that is near its last reachable value.
        closure: what locks there, `arm` or `tie_rod`.
        reach: range of that input, rad or mm.
        distance: from the last reachable value, in parts of the range.
    """

    number: int
    car: Car
    home: Inputs
    inputs: Inputs
    driven: str
    closure: str
    reach: float
    distance: float


def near_pose(number: int, seed: int = 0, nearest: float = NEAREST, farthest: float = 0.1) -> NearPose:
    """The pose of a number: a car drawn until its inputs have an end that an open way leads to.

    Args:
        nearest, farthest: limits of the distance, drawn log-uniformly, in parts of the input's range.
    """
    rng = np.random.default_rng([seed, number])
    while True:
        found = _attempt(number, rng, nearest, farthest)
        if found is not None:
            return found


def _attempt(number: int, rng: np.random.Generator, nearest: float, farthest: float) -> NearPose | None:
    car = random_car(rng)
    linkage = Linkage.of(car)
    driven = DRIVEN[int(rng.integers(2))]
    forward = bool(rng.integers(2))
    size = linkage.size
    share = rng.uniform(-1.0, 1.0)
    distance = float(np.exp(rng.uniform(math.log(nearest), math.log(farthest))))
    heave = float(rng.uniform(-0.1, 0.1) * size) if rng.random() < 0.3 else 0.0
    if not linkage.sound:
        return None
    home = {"arm_angle": linkage.drawn_angle, "rack": linkage.drawn_rack, "heave": 0.0}
    aside = dict(home)
    if driven == "arm_angle":
        aside["rack"] += 0.06 * size * share
    else:
        aside["arm_angle"] += 0.3 * share
    ends = [linkage.end(aside, driven, ahead) for ahead in (False, True)]
    if ends[0] is None or ends[1] is None:
        return None
    (low, _), (high, _) = ends
    reach = high - low
    last, closure = ends[forward]
    inputs = aside | {driven: last - reach * distance * (1 if forward else -1), "heave": heave}
    if not 0.0 < inputs["arm_angle"] < math.pi or not linkage.way_is_open(home, inputs):
        return None
    return NearPose(number, car, home, inputs, driven, closure, reach, distance)


def random_car(rng: np.random.Generator) -> Car:
    """Hardpoints up to 200 mm from the paper's, either side, a share turned, moved and scaled."""
    free = {name: np.array(place) + rng.uniform(-200.0, 200.0, 3) for name, place in PAPER.items()}
    top, ball = free["strut_top"], free["lower_ball_joint"]
    length = float(np.linalg.norm(ball - top))
    # As in any drawing of a strut, its inner points lie near its line, and up to 8 degrees off it.
    for name, low, high in (("strut_lower", 0.55, 0.95), ("strut_rod_end", 0.2, 0.5)):
        place = rng.uniform(low, high)
        aside = 0.08 * min(place, 1.0 - place) * length * rng.uniform(-1.0, 1.0, 3)
        free[name] = top + place * (ball - top) + aside
    free["tie_rod_inner"] = free["rack_centre"] + rng.uniform(-5.0, 5.0, 3)
    side = ("left", "right")[int(rng.integers(2))]
    if side == "right":
        free = {name: place * (1.0, -1.0, 1.0) for name, place in free.items()}
    turn = np.eye(3)
    if rng.random() < 0.3:
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
    scale = 10.0 ** rng.uniform(-3.0, 3.0) if rng.random() < 0.3 else 1.0
    shift = np.zeros(3)
    if rng.random() < 0.3:
        shift = scale * 10.0 ** rng.uniform(2.0, 7.0) * rng.uniform(-1.0, 1.0, 3)
    points = {name: _triple(scale * (turn @ place) + shift) for name, place in free.items()}
    return Car(points, side, _triple(turn[:, 2]), _triple(turn[:, 1]))


def _triple(vector: Array) -> tuple[float, float, float]:
    x, y, z = (float(component) for component in vector)
    return x, y, z


@dataclass(frozen=True)
class Linkage:
    """The circles of a car's ball joints, to say how far its inputs go; arrays of inputs at once."""

    p: Mapping[str, Array]
    up: Array
    right: Array

    @classmethod
    def of(cls, car: Car) -> Linkage:
        """Taken from a car's hardpoints."""
        origin = np.array(car.points["lower_arm_front"])
        places = {name: np.array(place) - origin for name, place in car.points.items()}
        return cls(places, np.array(car.up), np.array(car.right))

    @property
    def size(self) -> float:
        """Largest distance of a point from the arm's front pivot."""
        return max(float(np.linalg.norm(place)) for place in self.p.values())

    @property
    def arm_length(self) -> float:
        """From the front pivot to the ball joint."""
        return float(np.linalg.norm(self.p["lower_ball_joint"]))

    @property
    def drawn_angle(self) -> float:
        """Arm angle of the drawing."""
        return math.acos(float(self.p["lower_ball_joint"] @ self.up) / self.arm_length)

    @property
    def drawn_rack(self) -> float:
        """Rack travel of the drawing; positive against `right`."""
        return -float((self.p["tie_rod_inner"] - self.p["rack_centre"]) @ self.right)

    @property
    def sound(self) -> bool:
        """Whether neither link is shorter than a twentieth of the car, nor the drawing flat or upright."""
        ball, outer, lower = (self.p[n] for n in ("lower_ball_joint", "tie_rod_outer", "strut_lower"))
        lengths = (ball, outer - ball, outer - lower, outer - self.p["tie_rod_inner"], lower - ball)
        axis = self.p["lower_arm_rear"]
        flat = abs(float(np.cross(axis, self.up) @ ball)) / float(np.linalg.norm(axis) * self.arm_length)
        shortest = min(float(np.linalg.norm(vector)) for vector in lengths)
        return shortest > 0.05 * self.size and flat > 0.05

    def dead_points(self) -> tuple[float, float]:
        """Arm angles at which the ball joint is highest and lowest on its circle about the arm's axis."""
        axis, ball = self.p["lower_arm_rear"], self.p["lower_ball_joint"]
        along = float(axis @ ball) / float(axis @ axis)
        radius = float(np.linalg.norm(ball - along * axis))
        middle = along * float(axis @ self.up)
        across = self.up - axis * float(axis @ self.up) / float(axis @ axis)
        swing = radius * float(np.linalg.norm(across))
        high, low = (min(1.0, max(-1.0, (middle + s) / self.arm_length)) for s in (swing, -swing))
        return math.acos(high), math.acos(low)

    def spare(self, angle: Array, rack: Array) -> Array:
        """How far tie rod and steering arm are from lying in line; negative where they cannot meet.

        The square of the height of the tie rod's outer end over the plane of the strut's lower points
        and the rack, in parts of the steering arm's square; NaN beyond the arm's dead points.
        """
        axis, ball, top = (self.p[n] for n in ("lower_arm_rear", "lower_ball_joint", "strut_top"))
        outer, lower, inner = (self.p[n] for n in ("tie_rod_outer", "strut_lower", "tie_rod_inner"))
        with np.errstate(invalid="ignore"):
            height = self.arm_length * np.cos(angle)
            side = math.copysign(1.0, float(np.cross(axis, self.up) @ ball))
            ball_now = _corner(axis, float(axis @ ball), self.up, height, float(ball @ ball), side)
            strut = top - ball_now
            strut /= np.linalg.norm(strut, axis=-1, keepdims=True)
            towards = math.copysign(1.0, float((lower - ball) @ (top - ball)))
            r7 = strut * (towards * float(np.linalg.norm(lower - ball)))
            r9 = self.p["rack_centre"] - rack[..., None] * self.right - ball_now
            arm, rod, stay = (_square(v) for v in (outer - ball, outer - inner, outer - lower))
            along_7 = 0.5 * (arm + _square(lower - ball) - stay)
            along_9 = 0.5 * (arm + np.sum(r9 * r9, axis=-1) - rod)
            flat = _flat(r7, along_7, r9, along_9)
            return np.asarray(1.0 - np.sum(flat * flat, axis=-1) / arm)

    def end(self, inputs: Inputs, driven: str, ahead: bool) -> tuple[float, str] | None:
        """Last value of an input that can be reached from `inputs`, and what locks there; None if none."""
        start = inputs[driven]
        if driven == "arm_angle":
            low, high = self.dead_points()
            limit, closure = (high if ahead else low), ARM
        else:
            limit, closure = start + (2.0 if ahead else -2.0) * self.size, ""

        def spare(values: Array) -> Array:
            pair = {name: np.full_like(values, inputs[name]) for name in DRIVEN} | {driven: values}
            return self.spare(pair["arm_angle"], pair["rack"])

        # The last place of an arm is its dead point itself, where the root is of rounding.
        values = np.linspace(start, limit, SCAN + 1)[: SCAN if driven == "arm_angle" else None]
        open_ = spare(values) > 0.0
        if not open_[0]:
            return None
        if open_.all():
            return (limit, closure) if closure else None
        first = int(np.argmin(open_))
        return _bisected(spare, float(values[first - 1]), float(values[first])), TIE_ROD

    def way_is_open(self, home: Inputs, inputs: Inputs) -> bool:
        """Whether the closures are met all along the straight way of ball joint height and rack."""
        s = np.linspace(0.0, 1.0, PATH)
        rise = (1.0 - s) * math.cos(home["arm_angle"]) + s * math.cos(inputs["arm_angle"])
        rack = (1.0 - s) * home["rack"] + s * inputs["rack"]
        return bool((self.spare(np.arccos(rise), rack)[:-1] > 1e-3 * (1.0 - s[:-1])).all())


def _bisected(spare: Callable[[Array], Array], inside: float, outside: float) -> float:
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        if spare(np.array([middle]))[0] > 0.0:
            inside = middle
        else:
            outside = middle
    return inside


def _square(vector: Array) -> float:
    return float(vector @ vector)


def _flat(a: Array, along_a: Array | float, b: Array, along_b: Array | float) -> Array:
    """The vector in the plane of a and b with the products along_a with a and along_b with b."""
    aa, ab, bb = (np.sum(u * v, axis=-1) for u, v in ((a, a), (a, b), (b, b)))
    determinant = aa * bb - ab * ab
    alpha = (along_a * bb - along_b * ab) / determinant
    beta = (along_b * aa - along_a * ab) / determinant
    return np.asarray(alpha[..., None] * a + beta[..., None] * b)


def _corner(a: Array, along_a: float, b: Array, along_b: Array, squared: float, side: float) -> Array:
    """The vector of given square with these two products, on one side of the plane of a and b."""
    flat = _flat(np.broadcast_to(a, (*along_b.shape, 3)), along_a, b, along_b)
    normal = np.cross(a, b)
    height = np.sqrt((squared - np.sum(flat * flat, axis=-1)) / float(normal @ normal))
    return np.asarray(flat + side * height[..., None] * normal)
