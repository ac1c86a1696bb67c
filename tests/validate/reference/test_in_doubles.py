"""The equations in doubles at many instants are those of the proven instants, up to rounding."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from reference_cars import ReferenceCar

from validate.reference.design import Known, values_only
from validate.reference.dual import Dual, slope_of
from validate.reference.in_doubles import (
    changes_of,
    inverse_of,
    jacobian_of,
    known_in_doubles,
    local_places,
    newton_step,
    order_of,
    part_of,
    unknown_jets_of,
    with_slopes,
)
from validate.reference.jet import Jet

QUANTITIES = ("position", "velocity", "acceleration")
HEAVE = "heave"


def unknowns(car: ReferenceCar, places: dict[str, np.ndarray], still: Known) -> np.ndarray:
    """The unknowns of points, (size, N)."""
    count = len(next(iter(places.values())))
    read = car.design.mechanism.unknown_of(local_places(car.design, places, still), float)
    return np.array([np.broadcast_to(x, count) for x in read], dtype=float)


def inputs_of(car: ReferenceCar, heave: bool) -> list[dict[str, tuple[Any, ...]]]:
    """Three instants near the drawing, not all with the same rates."""
    moved = []
    for k in range(3):
        one = {name: (a + Fraction(k, 50), b * (k + 1), c - k) for name, (a, b, c) in car.inputs.items()}
        moved.append({name: triple for name, triple in one.items() if heave or name != HEAVE})
    return moved


@pytest.mark.parametrize("heave", [True, False])
def test_poses_and_rates_in_doubles_are_those_of_the_proven_instants(car: ReferenceCar, heave: bool) -> None:
    inputs, design = inputs_of(car, heave), car.design
    instants = [car.solve(one) for one in inputs]
    laws = {name: np.array([[float(x) for x in one[name]] for one in inputs]) for name in inputs[0]}
    places = {name: np.array([one.position_as_float(name) for one in instants]) for name in design.names}
    known = known_in_doubles(design, laws, 3)
    still = values_only(known)
    values = unknowns(car, places, still)
    inverse = inverse_of(jacobian_of(list(values), still.numbers, still.equations))
    # Local coordinates are of the size of 1; their rounding times the equations' condition, below 1e4.
    assert np.abs(newton_step(values, inverse, still)).max() < 1e-11
    points = known.points_of(unknown_jets_of(list(values), inverse, known))
    unit = float(design.unit)
    origin = np.array([float(x) for x in design.origin])
    for order, quantity in enumerate(QUANTITIES):
        proven = {
            name: np.array([getattr(one, quantity)[name] for one in instants], dtype=float) for name in points
        }
        largest = max(np.abs(vectors).max() for vectors in proven.values())
        for name, vectors in proven.items():
            found = np.stack([np.broadcast_to(x, 3) for x in order_of(points[name], order)], axis=-1) * unit
            found = found + origin if order == 0 else found
            np.testing.assert_allclose(found, vectors, rtol=0.0, atol=1e-10 * largest)


def test_a_matrix_without_an_inverse_has_the_one_that_comes_nearest() -> None:
    good, flat = np.diag([2.0, 4.0]), np.diag([2.0, 0.0])
    assert inverse_of(np.array([good])).tolist() == [[[0.5, 0.0], [0.0, 0.25]]]
    assert inverse_of(np.array([good, flat])).tolist() == [
        [[0.5, 0.0], [0.0, 0.25]],
        [[0.5, 0.0], [0.0, 0.0]],
    ]


@pytest.mark.parametrize("name", ["arm_angle", "rack"])
def test_what_an_input_changes_is_the_proven_derivative(car: ReferenceCar, name: str) -> None:
    proven, instant, design = car.sensitivities()[name, "value"], car.solve(car.inputs), car.design
    laws = {n: np.array([[float(x) for x in law]] * 2) for n, law in car.inputs.items()}
    places = {n: np.array([instant.position_as_float(n)] * 2) for n in design.names}
    known = known_in_doubles(design, laws, 2)
    still = values_only(known)
    values = unknowns(car, places, still)
    inverse = inverse_of(jacobian_of(list(values), still.numbers, still.equations))
    jets = unknown_jets_of(list(values), inverse, known)
    # The derivative of what the equations take for the input, by its own value.
    step, which = 1e-6, list(design.mechanism.drives).index(name)
    ahead, behind = (
        known_in_doubles(design, {**laws, name: laws[name] + [sign * step, 0.0, 0.0]}, 2).numbers[which]
        for sign in (1.0, -1.0)
    )
    slopes = [(part_of(ahead, d) - part_of(behind, d))[None] / (2.0 * step) for d in range(3)]
    dual = Jet(*(Dual(part_of(known.numbers[which], d), slopes[d]) for d in range(3)))
    changed = replace(known, numbers=[dual if i == which else w for i, w in enumerate(known.numbers)])
    found = changes_of(jets, inverse, changed, 1)
    assert found.shape == (3, design.mechanism.size, 1, 2)
    points = changed.points_of(with_slopes(jets, found))
    for d, quantity in enumerate(QUANTITIES):
        exact = {n: np.array(getattr(proven, quantity)[n], dtype=float) for n in design.names}
        largest = max(np.abs(v).max() for v in exact.values())
        for n, vector in exact.items():
            slope = [np.broadcast_to(slope_of(part_of(x, d)), (1, 2))[0] for x in points[n]]
            # A central difference of numbers of the size of 1 over 1e-6 rounds to 1e-10.
            np.testing.assert_allclose(
                np.stack(slope, axis=-1) * float(design.unit), [vector] * 2, rtol=0.0, atol=1e-7 * largest
            )
    again = changes_of(jets, inverse, changed, 1, found[0])
    np.testing.assert_allclose(again, found, rtol=1e-9, atol=1e-9 * np.abs(found).max())
    assert np.array_equal(again[0], found[0])
