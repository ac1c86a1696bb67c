"""The suspensions that have a closed form, with random cars of each; written apart from the package."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import off_axis_cars
import wishbone_cars
from closed_forms import ClosedFormCar
from hypothesis import strategies as st
from sample_cars import GENERAL_STRUT, WISHBONE, SampleCar


@dataclass(frozen=True)
class ClosedForm:
    """A suspension: random cars of it, and where a car's points are by its closed form."""

    sample: SampleCar
    cars: st.SearchStrategy[ClosedFormCar]
    make: Callable[..., ClosedFormCar]
    steering_axis: tuple[str, str]
    knuckle: tuple[str, str, str]

    @property
    def type(self) -> str:
        """What a scene calls the suspension."""
        return self.sample.type

    @property
    def sample_car(self) -> ClosedFormCar:
        """The sample as a car of the closed form."""
        points = dict(self.sample.points)
        points.setdefault("rack_centre", points["tie_rod_inner"])
        exact = {name: tuple(Fraction(c) for c in place) for name, place in points.items()}
        return self.make(exact, (0, 0, 1), (0, 1, 0))


FORMS = [
    ClosedForm(
        GENERAL_STRUT,
        off_axis_cars.off_axis_cars(),
        off_axis_cars.OffAxisCar,
        ("lower_ball_joint", "strut_top"),
        ("lower_ball_joint", "tie_rod_outer", "strut_lower"),
    ),
    ClosedForm(
        WISHBONE,
        wishbone_cars.wishbone_cars(),
        wishbone_cars.WishboneCar,
        ("lower_ball_joint", "upper_ball_joint"),
        ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer"),
    ),
]
RANDOM = {"strut as drawn": FORMS[0].cars, "double wishbone": FORMS[1].cars}
PLAIN: dict[str, ClosedFormCar] = {
    "strut as drawn": off_axis_cars.OffAxisCar(
        off_axis_cars.closing(off_axis_cars.BASE, Fraction(1, 2), Fraction(230), (0, 1, 0)),
        (0, 0, 1),
        (0, 1, 0),
    ),
    "double wishbone": wishbone_cars.LOTUS,
}


def rounded(car: ClosedFormCar, form: ClosedForm) -> ClosedFormCar:
    """The car as a scene gives it: every coordinate a double."""

    def double(vector: Any) -> tuple[Fraction, ...]:
        return tuple(Fraction(float(c)) for c in vector)

    points = {name: double(place) for name, place in car.points.items()}
    return form.make(points, double(car.up), double(car.right))
