"""How the wheel's carrier moves as the wheel travels."""

from __future__ import annotations

from dataclasses import dataclass

from validate.reference.dual import slope_of, value_of
from validate.reference.effects.car import Car
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Scalar, Vector, cross, each, minus, plus


@dataclass(frozen=True)
class KnuckleMotion:
    """Derivatives by the input that the car's numbers are duals of.

    Attributes:
        contact, centre: the contact point c and the wheel centre W.
        turning: omega, rad per unit of the input.
        of_centre: W'.
    """

    contact: Vector
    centre: Vector
    turning: Vector
    of_centre: Vector

    @classmethod
    def of(cls, car: Car) -> KnuckleMotion:
        """Of a car that says how its knuckle turns."""
        assert car.knuckle is not None
        turning, _ = body_rates(*(each(_moving, vector) for vector in car.knuckle))
        centre = car.wheel.end
        return cls(each(value_of, car.contact), each(value_of, centre), turning, each(slope_of, centre))

    @property
    def of_contact(self) -> Vector:
        """Of the carrier's own point that is at c now: W' + omega x (c - W)."""
        return plus(self.of_centre, cross(self.turning, minus(self.contact, self.centre)))


def _moving(number: Scalar) -> Jet:
    return Jet(value_of(number), slope_of(number))
