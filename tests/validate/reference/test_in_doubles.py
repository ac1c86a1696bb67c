"""The equations in doubles: the effect of a residual on a motion."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from mechanism_drawings import ReferenceCar

from validate.reference.design import Known, values_only
from validate.reference.in_doubles import (
    by_doubles,
    inverse_of,
    jacobian_of,
    known_in_doubles,
    local_places,
    motion_of_a_miss,
)
from validate.reference.jet import Jet
from validate.reference.kinematics import with_rates


def unknowns(car: ReferenceCar, places: dict[str, np.ndarray], still: Known) -> np.ndarray:
    """The unknowns from points, (size, N)."""
    count = len(next(iter(places.values())))
    read = car.design.mechanism.unknown_of(local_places(car.design, places, still), still.numbers, float)
    return np.array([np.broadcast_to(x, count) for x in read], dtype=float)


def inputs_of(car: ReferenceCar) -> list[dict[str, tuple[Any, ...]]]:
    """Three instants near the drawing, not all with the same rates."""
    return [
        {
            name: (a + Fraction(k, 50), b * (k + 1), c - k, 2 * k + b, 5 * c - k * b)
            for name, (a, b, c) in car.inputs.items()
        }
        for k in range(3)
    ]


def test_what_missing_an_equation_makes_of_a_motion_is_the_difference_of_motions_that_miss_it(
    car: ReferenceCar,
) -> None:
    inputs, design = inputs_of(car), car.design
    instants = [car.solve(one) for one in inputs]
    laws = {name: np.array([[float(x) for x in one[name]] for one in inputs]) for name in inputs[0]}
    places = {name: np.array([one.position[name] for one in instants], dtype=float) for name in design.table}
    known = known_in_doubles(design, laws, 3)
    still = values_only(known)
    values = unknowns(car, places, still)

    def moving(missed: np.ndarray) -> tuple[list[Jet], np.ndarray]:
        """The motion with these residuals of the equations, and the inverse of its Jacobian."""
        solved = values
        for _ in range(4):
            inverse = inverse_of(jacobian_of(list(solved), still))
            less = np.einsum("nij,j->in", inverse, missed)
            solved = solved + np.array(by_doubles(inverse)(still.residual(list(solved)))) + less
        inverse = inverse_of(jacobian_of(list(solved), still))
        return with_rates(list(solved), known, by_doubles(inverse)), inverse

    size = design.mechanism.size
    jets, inverse = moving(np.zeros(size))
    found = motion_of_a_miss(inverse.transpose(1, 2, 0), jets, inverse, known)
    assert found.shape == (5, size, size, 3)
    # A central difference leaves step^2 of the third derivative, and rounding over the step.
    step = 1e-5
    for row in range(size):
        ahead, behind = (moving(sign * step * np.eye(size)[row])[0] for sign in (1.0, -1.0))
        for d in range(4):
            changes = [a.part(d) - b.part(d) for a, b in zip(ahead, behind, strict=True)]
            exact = np.array([np.broadcast_to(change, 3) for change in changes]) / (2.0 * step)
            largest = np.abs(found[d]).max()
            np.testing.assert_allclose(found[d, :, row], exact, rtol=0.0, atol=1e-6 * largest)


def test_quotients_and_roots_of_jets_are_undone_by_products_in_every_order() -> None:
    one, two = Jet(*map(Fraction, (3, -1, 4, 1, -5))), Jet(*map(Fraction, (2, 7, -1, 8)))
    assert (one / two * two).parts[:5] == one.parts
    assert (1 / two * two).parts == (1, 0, 0, 0)
    root = Jet(*np.array([[2.0], [3.0], [-1.0], [5.0]])).sqrt()
    assert np.abs((root * root - Jet(2.0, 3.0, -1.0, 5.0)).parts).max() < 1e-14
