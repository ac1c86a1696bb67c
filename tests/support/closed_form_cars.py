"""Random cars of every suspension that has a closed form in mpmath."""

from __future__ import annotations

from fractions import Fraction

from closed_forms import ClosedFormCar
from hypothesis import strategies as st
from off_axis_cars import BASE, OffAxisCar, closing, off_axis_cars
from wishbone_cars import LOTUS, wishbone_cars

RANDOM: dict[str, st.SearchStrategy[ClosedFormCar]] = {
    "strut as drawn": off_axis_cars(),
    "double wishbone": wishbone_cars(),
}
PLAIN: dict[str, ClosedFormCar] = {
    "strut as drawn": OffAxisCar(
        closing(BASE, Fraction(1, 2), Fraction(230), (0, 1, 0)), (0, 0, 1), (0, 1, 0)
    ),
    "double wishbone": LOTUS,
}
