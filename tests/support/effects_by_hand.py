"""Every effect once more, by the words of its definition and in 50 digits: nothing of pointcoord's is used.

A car is carried along as one rigid body, so that its exact rates are known before any point is. Whoever adds
an effect adds a line to `BY_HAND`; a test finds it missing.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from mpmath import mp, mpc, mpf, workdps

DIGITS = 50
Vector = tuple[mpf, mpf, mpf]
Numbers = dict[str, dict[str, list[mpf]]]


@dataclass(frozen=True)
class Car:
    """A car at an instant; mm, s, rad.

    Attributes:
        points: by name, position, velocity and acceleration in the chassis' frame.
        added: what the chassis' motion and the user's origin add to each of these.
        turn: angular velocity and acceleration of every body.
        bodies: their names.
        wheel_axis: from the inner point to the outer one. steering_axis: from the lower to the upper one.
        up, right, outboard: of the car.
    """

    points: Mapping[str, Sequence[Vector]]
    added: Sequence[Vector]
    turn: tuple[Vector, Vector]
    bodies: tuple[str, ...]
    wheel_axis: tuple[str, str]
    steering_axis: tuple[str, str]
    up: Vector
    right: Vector
    outboard: Vector

    def line(self, ends: tuple[str, str]) -> Vector:
        """From the first of two points to the second."""
        start, end = (self.points[name][0] for name in ends)
        return plus(end, start, -1)


def plus(a: Vector, b: Vector, factor: int = 1) -> Vector:
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


def _of_points(quantity: str, derivative: int) -> Callable[[Car], Numbers]:
    def numbers(car: Car) -> Numbers:
        added = car.added[derivative]
        return {quantity: {name: [*plus(p[derivative], added)] for name, p in car.points.items()}}

    return numbers


def _rates(car: Car) -> Numbers:
    names = ("angular_velocity", "angular_acceleration")
    return {name: {body: [*turn] for body in car.bodies} for name, turn in zip(names, car.turn, strict=True)}


def _wheel_angles(car: Car) -> Numbers:
    """A wheel that leans out at the top has a spin axis that falls on its way outboard."""
    spin, kingpin = car.line(car.wheel_axis), car.line(car.steering_axis)
    camber = -mp.arg(mpc(dot(spin, car.outboard), dot(spin, car.up)))
    lean_in = -mp.arg(mpc(dot(kingpin, car.up), dot(kingpin, car.outboard)))
    return {"wheel": {"camber": [camber], "kingpin": [lean_in]}}


def _toe(car: Car) -> Numbers:
    """A wheel whose front edge is nearer the middle has a spin axis that goes forward on its way out."""
    spin, forward = car.line(car.wheel_axis), cross(car.up, car.right)
    return {"wheel": {"toe": [mp.arg(mpc(dot(spin, car.outboard), dot(spin, forward)))]}}


def _caster(car: Car) -> Numbers:
    """A steering axis that leans rearward at the top goes rearward on its way up."""
    kingpin, rearward = car.line(car.steering_axis), cross(car.right, car.up)
    return {"wheel": {"caster": [mp.arg(mpc(dot(kingpin, car.up), dot(kingpin, rearward)))]}}


BY_HAND: dict[str, Callable[[Car], Numbers]] = {
    "position": _of_points("position", 0),
    "velocity": _of_points("velocity", 1),
    "acceleration": _of_points("acceleration", 2),
    "knuckle_rates": _rates,
    "wheel_angles": _wheel_angles,
    "toe": _toe,
    "caster": _caster,
}


def by_hand(effect: str, car: Car) -> Numbers:
    """The numbers of an effect, by quantity and name; each a list of its components."""
    with workdps(DIGITS):
        return BY_HAND[effect](car)
