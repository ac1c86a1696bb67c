"""Every effect once more, by the words of its definition and in 50 digits: nothing of pointcoord's is used.

A car is carried along as one rigid body, so that its exact rates are known before any point is. Whoever adds
an effect adds a line to `BY_HAND`; a test finds it missing.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from mpmath import mp, mpc, mpf, workdps

DIGITS = 50
Vector = tuple[mpf, mpf, mpf]
Numbers = dict[str, dict[str, list[mpf]]]


@dataclass(frozen=True)
class Car:
    """A car at an instant; mm, s, rad.

    Attributes:
        points: by name, position and velocity in the chassis' frame.
        wheel_axis: from the inner point to the outer one. steering_axis: from the lower to the upper one.
        damper: its two ends, if there is one.
        in_chassis, rates_in_chassis: positions and velocities before the turns of the chassis.
        drawn: as drawn.
        moving, moving_in_chassis: how the points and those in the chassis' frame change by an input, per mm.
        driven_turn: how every body turns by the input.
        origin: from the user's to that of the points.
        data: what the scene says of the whole car; of its axle -1 at the front and +1 at the rear.
        up, right, outboard: of the car.
    """

    points: Mapping[str, Sequence[Vector]]
    wheel_axis: tuple[str, str]
    steering_axis: tuple[str, str]
    damper: tuple[str, ...]
    wheel_radius: mpf
    in_chassis: Mapping[str, Vector]
    rates_in_chassis: Mapping[str, Vector]
    drawn: Mapping[str, Vector]
    moving: Mapping[str, Vector]
    moving_in_chassis: Mapping[str, Vector]
    driven_turn: Vector
    origin: Vector
    data: Mapping[str, mpf]
    up: Vector
    right: Vector
    outboard: Vector

    def ahead(self, step: mpf) -> "Car":
        """The car after a step of the input."""
        points = {n: [plus(p[0], self.moving[n], step), *p[1:]] for n, p in self.points.items()}
        in_chassis = {n: plus(p, self.moving_in_chassis[n], step) for n, p in self.in_chassis.items()}
        return replace(self, points=points, in_chassis=in_chassis)

    @property
    def places(self) -> dict[str, Vector]:
        """The positions."""
        return {name: states[0] for name, states in self.points.items()}

    def contact(self, places: Mapping[str, Vector]) -> Vector:
        """The point of a thin disc about the spin axis that lies farthest down."""
        inner, centre = (places[name] for name in self.wheel_axis)
        spin = plus(centre, inner, -1)
        # What is left of up beside the spin axis lies in the disc.
        in_disc = plus(self.up, spin, -dot(self.up, spin) / dot(spin, spin))
        return plus(centre, in_disc, -self.wheel_radius / mp.sqrt(dot(in_disc, in_disc)))

    def line(self, ends: tuple[str, str]) -> Vector:
        """From the first of two points to the second."""
        start, end = (self.points[name][0] for name in ends)
        return plus(end, start, -1)


def plus(a: Vector, b: Vector, factor: int | mpf = 1) -> Vector:
    """a + factor b."""
    x, y, z = (p + factor * q for p, q in zip(a, b, strict=True))
    return x, y, z


def dot(a: Vector, b: Vector) -> mpf:
    """Scalar product."""
    return sum((p * q for p, q in zip(a, b, strict=True)), mpf(0))


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    (x, y, z), (u, v, w) = a, b
    return y * w - z * v, z * u - x * w, x * v - y * u


def _wheel_angles(car: Car) -> Numbers:
    """A wheel that leans out at the top has a spin axis that falls on its way outboard."""
    spin, kingpin = car.line(car.wheel_axis), car.line(car.steering_axis)
    camber = -mp.arg(mpc(dot(spin, car.outboard), dot(spin, car.up)))
    lean_in = -mp.arg(mpc(dot(kingpin, car.up), dot(kingpin, car.outboard)))
    return {"wheel": {"camber": [camber], "kingpin": [lean_in]}}


def _camber(car: Car) -> Numbers:
    return {"wheel": {"camber": _wheel_angles(car)["wheel"]["camber"]}}


def _toe(car: Car) -> Numbers:
    """A wheel whose front edge is nearer the middle has a spin axis that goes forward on its way out."""
    spin, forward = car.line(car.wheel_axis), cross(car.up, car.right)
    return {"wheel": {"toe": [mp.arg(mpc(dot(spin, car.outboard), dot(spin, forward)))]}}


def _steer_angle(car: Car) -> Numbers:
    """Where the outward end of the spin axis goes as the wheel is turned to the left about up."""
    spin, to_the_left = car.line(car.wheel_axis), cross(car.up, car.outboard)
    return {"wheel": {"steer_angle": [mp.arg(mpc(dot(spin, car.outboard), dot(spin, to_the_left)))]}}


def _toe_change_by_arcsine(car: Car) -> Numbers:
    """How much farther the unit spin axis leans forward out of the plane across the car than it is drawn."""
    forward, (inner, centre) = cross(car.up, car.right), car.wheel_axis
    leans = []
    for places in (car.places, car.drawn):
        spin = plus(places[centre], places[inner], -1)
        leans.append(mp.pi / 2 - mp.acos(dot(spin, forward) / mp.sqrt(dot(spin, spin))))
    return {"wheel": {"toe_change_by_arcsine": [leans[0] - leans[1]]}}


def _caster(car: Car) -> Numbers:
    """A steering axis that leans rearward at the top goes rearward on its way up."""
    kingpin, rearward = car.line(car.steering_axis), cross(car.right, car.up)
    return {"wheel": {"caster": [mp.arg(mpc(dot(kingpin, car.up), dot(kingpin, rearward)))]}}


def _wheel_travel(car: Car) -> Numbers:
    rearward, centre = cross(car.right, car.up), car.wheel_axis[1]
    in_chassis = plus(car.contact(car.in_chassis), car.contact(car.drawn), -1)
    moved = plus(car.contact(car.places), car.contact(car.drawn), -1)
    numbers = {
        "travel": dot(plus(car.in_chassis[centre], car.drawn[centre], -1), car.up),
        "contact_travel": dot(in_chassis, car.up),
        "half_track_change": dot(moved, car.outboard),
        "recession": dot(moved, rearward),
    }
    return {"dimension": {name: [number] for name, number in numbers.items()}}


def _steering_axis(car: Car) -> Numbers:
    """By where the axis' line passes the heights of the contact point and of the wheel centre."""
    lower, upper = (car.places[name] for name in car.steering_axis)
    kingpin, contact, centre = plus(upper, lower, -1), car.contact(car.places), car.places[car.wheel_axis[1]]
    rearward = cross(car.right, car.up)

    def beside(place: Vector) -> Vector:
        share = dot(plus(place, lower, -1), car.up) / dot(kingpin, car.up)
        return plus(place, plus(lower, kingpin, share), -1)

    ground, hub = beside(contact), beside(centre)
    # Level, at right angles to the spin axis, and forward where that points outboard.
    ahead = cross(car.line(car.wheel_axis), car.up)
    if dot(cross(car.outboard, car.up), rearward) > 0:
        ahead = plus((mpf(0),) * 3, ahead, -1)
    numbers = {
        "kingpin_offset": dot(ground, car.outboard),
        "scrub_radius": mp.sqrt(dot(ground, ground)),
        "mechanical_trail": -dot(ground, ahead) / mp.sqrt(dot(ahead, ahead)),
        "castor_offset": dot(ground, rearward),
        "kingpin_offset_at_wheel": dot(hub, car.outboard),
        "hub_trail": -dot(hub, rearward),
    }
    return {"dimension": {name: [number] for name, number in numbers.items()}}


def _damper(car: Car) -> Numbers:
    line = car.line(car.damper)
    return {"dimension": {"damper_length": [mp.sqrt(dot(line, line))]}}


STEP = mpf(10) ** -16  # of central differences: what they leave out is its square


def _slopes(base: Callable[[Car], Numbers], car: Car) -> dict[str, mpf]:
    """The derivative of each number of an effect by the input, by differences in many digits."""
    (ahead,), (behind,) = (base(car.ahead(step)).values() for step in (STEP, -STEP))
    return {name: (ahead[name][0] - behind[name][0]) / (2 * STEP) for name in ahead}


def _derived(effect: str, by: str) -> Callable[[Car], Numbers]:
    """The change of its numbers for each mm of the rack or of travel, or for each second."""

    def numbers(car: Car) -> Numbers:
        (quantity,) = BY_HAND[effect](car)
        if by == "time":
            rates = {name: states[1] for name, states in car.points.items()}
            car = replace(car, moving=rates, moving_in_chassis=car.rates_in_chassis)
        step = _slopes(_wheel_travel, car)["travel"] if by == "travel" else mpf(1)
        found = _slopes(BY_HAND[effect], car)
        per = PER_SECOND if by == "time" else PER_MM
        return {per[quantity]: {f"{name}_by_{by}": [slope / step] for name, slope in found.items()}}

    return numbers


def _roll_centre(car: Car) -> Numbers:
    """Where the normal of the contact point's way meets the middle plane, in the front view."""
    contact, centre = car.contact(car.places), car.wheel_axis[1]
    arm = plus(contact, car.places[centre], -1)
    velocity = plus(car.moving[centre], cross(car.driven_turn, arm))
    # The normal leads from the contact point inwards by its distance, and up by as much as it rises.
    out = dot(plus(contact, car.origin), car.outboard)
    return {"dimension": {"roll_centre_height": [out * dot(velocity, car.outboard) / dot(velocity, car.up)]}}


def _going(car: Car, place: Vector) -> Vector:
    """How a point of the knuckle at a place moves by the input."""
    centre = car.wheel_axis[1]
    arm = plus(place, car.places[centre], -1)
    return plus(car.moving[centre], cross(car.driven_turn, arm))


def _centre(car: Car, level: Vector) -> tuple[mpf, mpf]:
    """The instant centre in the plane of a level direction and up: along both from the contact point.

    It lies on the normal of the way of the contact point, and on that of a point above it.
    """
    contact = car.contact(car.places)
    high = mpf(100)
    one, two = (_going(car, plus(contact, car.up, h)) for h in (mpf(0), high))
    (a, b), (c, d) = ((dot(way, level), dot(way, car.up)) for way in (one, two))
    # a x + b y = 0 and c x + d (y - high) = 0
    return -b * d * high / (a * d - b * c), a * d * high / (a * d - b * c)


def _instant_centres(car: Car) -> Numbers:
    outward, front = _centre(car, car.outboard)
    rearward, side = _centre(car, cross(car.right, car.up))
    numbers = {
        "front_view_swing_arm": -outward,
        "front_view_centre_height": front,
        "side_view_swing_arm": rearward,
        "side_view_centre_height": side,
    }
    return {"dimension": {name: [number] for name, number in numbers.items()}}


def _anti_features(car: Car) -> Numbers:
    """The steepness of the way of the contact point, or of the wheel centre, in the side view."""
    data, rearward = car.data, cross(car.right, car.up)
    height = data["centre_of_gravity_height"] - _wheel_travel(car)["dimension"]["contact_travel"][0]
    found = {}
    for name, share, place in (
        ("anti_brake", "brake_share", car.contact(car.places)),
        ("anti_drive", "drive_share", car.places[car.wheel_axis[1]]),
    ):
        way = _going(car, place)
        steep = dot(way, rearward) / dot(way, car.up)
        found[name] = [100 * data[share] * data["axle"] * steep * data["wheelbase"] / height]
    return {"load_share": found}


def _angles_by_arcsine(car: Car) -> Numbers:
    """By the unit spin axis, whose parts up and forward are sines."""
    spin, forward = car.line(car.wheel_axis), cross(car.up, car.right)
    size = mp.sqrt(dot(spin, spin))
    camber, toe = -mp.asin(dot(spin, car.up) / size), mp.asin(dot(spin, forward) / size)
    return {"wheel": {"camber_by_arcsine": [camber], "toe_by_arcsine": [toe]}}


def _screw_axis(car: Car) -> Numbers:
    """By the place at each height where the knuckle moves along its turn: v + w x (p - W) = pitch w.

    Seen along the turn, the wheel centre goes on a circle about that place.
    """
    turn, centre = car.driven_turn, car.places[car.wheel_axis[1]]
    square, moved = dot(turn, turn), car.moving[car.wheel_axis[1]]
    pitch = dot(turn, moved) / square
    across = plus(moved, turn, -pitch)
    place = plus(centre, cross(turn, across), 1 / square)
    upper = plus(place, turn if dot(turn, car.up) > 0 else plus((mpf(0),) * 3, turn, -1), 1000)
    points = {name: [p] for name, p in {**car.places, "screw lower": place, "screw upper": upper}.items()}
    other = replace(car, points=points, steering_axis=("screw lower", "screw upper"))
    angles = {
        "kingpin": _wheel_angles(other)["wheel"]["kingpin"],
        "caster": _caster(other)["wheel"]["caster"],
    }
    return {
        "wheel": {f"screw_{name}": number for name, number in angles.items()},
        "dimension": {f"screw_{name}": n for name, n in _steering_axis(other)["dimension"].items()},
        "screw_pitch": {"screw_pitch": [pitch]},
    }


def _motion_ratio(car: Car) -> Numbers:
    """By differences of the damper's length and of the travel."""
    length = _slopes(_damper, car)["damper_length"]
    ratio = -length / _slopes(_wheel_travel, car)["travel"]
    return {"dimension_gradient": {"damper_per_wheel": [ratio], "wheel_per_damper": [1 / ratio]}}


def _spring(car: Car) -> Numbers:
    """A linear spring between the damper's ends; the wheel's work is the damper's."""
    ratio = _motion_ratio(car)["dimension_gradient"]["damper_per_wheel"][0]
    rate, free = car.data["spring_rate"], car.data["spring_free_length"]
    force = rate * (free - _damper(car)["dimension"]["damper_length"][0])
    return {
        "spring_force": {"spring_force": [force], "wheel_force": [force * ratio]},
        "wheel_rate": {"wheel_rate": [rate * ratio**2]},
    }


def _arm_roll_centre(car: Car) -> Numbers:
    """The motion of both ball joints by a turn about a line: where planes square to their ways meet.

    These planes, through the ball joints, are those of the arms; c goes square to the line, about it.
    """
    lower, upper = (car.places[name] for name in car.steering_axis)
    one, two = _going(car, lower), _going(car, upper)
    along, contact = cross(one, two), car.contact(car.places)
    # A place of the line: on both planes, and at right angles to it from the origin.
    rows = mp.matrix([[*one], [*two], [*along]])
    place = tuple(mp.lu_solve(rows, mp.matrix([dot(one, lower), dot(two, upper), mpf(0)])))
    velocity = cross(along, plus(contact, place, -1))
    out = dot(plus(contact, car.origin), car.outboard)
    height = out * dot(velocity, car.outboard) / dot(velocity, car.up)
    return {"dimension": {"arm_roll_centre_height": [height]}}


PER_MM = {"wheel": "angle_gradient", "dimension": "dimension_gradient"}
PER_SECOND = {"wheel": "angle_rate", "dimension": "dimension_rate"}
BY_HAND: dict[str, Callable[[Car], Numbers]] = {
    "wheel_angles": _wheel_angles,
    "camber": _camber,
    "toe": _toe,
    "steer_angle": _steer_angle,
    "caster": _caster,
    "wheel_travel": _wheel_travel,
    "steering_axis": _steering_axis,
    "damper": _damper,
    "angles_by_arcsine": _angles_by_arcsine,
    "toe_change_by_arcsine": _toe_change_by_arcsine,
    "screw_axis": _screw_axis,
    "motion_ratio": _motion_ratio,
    "spring": _spring,
    "roll_centre": _roll_centre,
    "arm_roll_centre": _arm_roll_centre,
    "instant_centres": _instant_centres,
    "anti_features": _anti_features,
}


def by_hand(effect: str, car: Car) -> Numbers:
    """The numbers of an effect, by quantity and name; each a list of its components."""
    base, _, by = effect.rpartition("_by_")
    with workdps(DIGITS):
        return (BY_HAND[effect] if effect in BY_HAND else _derived(base, by))(car)
