"""The equations of every linkage are differentiated rightly."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_cars import CARS, equations_data

from validate.reference.jet import Jet


@pytest.mark.parametrize("car", CARS)
@given(data=st.data())
@settings(max_examples=30, deadline=None)
def test_the_jacobian_is_exactly_the_central_difference_of_the_quadratic_residual(
    car: str, data: st.DataObject
) -> None:
    linkage = CARS[car].linkage
    known, (y, step) = data.draw(equations_data(linkage, 2))
    ahead = linkage.residual([a + b for a, b in zip(y, step, strict=True)], known)
    behind = linkage.residual([a - b for a, b in zip(y, step, strict=True)], known)
    product = [Fraction(0)] * linkage.size
    for row, column, entry in linkage.jacobian(y, known):
        product[row] += entry * step[column]
    assert product == [(a - b) / 2 for a, b in zip(ahead, behind, strict=True)]


@pytest.mark.parametrize("car", CARS)
@given(data=st.data())
@settings(max_examples=20, deadline=None)
def test_jets_give_the_exact_derivatives_along_a_parabola(car: str, data: st.DataObject) -> None:
    linkage = CARS[car].linkage
    known, (y, rate, bend) = data.draw(equations_data(linkage, 3))

    def at(t: int) -> list[Fraction]:
        moved = [a + b * t + c * t * t / 2 for a, b, c in zip(y, rate, bend, strict=True)]
        return linkage.residual(moved, known)

    # C(y(t)) has degree 4 in t, for which five-point differences are exact.
    p2, p1, p0, m1, m2 = (at(t) for t in (2, 1, 0, -1, -2))
    jets = linkage.residual([Jet(a, b, c) for a, b, c in zip(y, rate, bend, strict=True)], known)
    for i, jet in enumerate(jets):
        assert jet.value == p0[i]
        assert jet.rate == (8 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / 12
        assert jet.acceleration == (16 * (p1[i] + m1[i]) - (p2[i] + m2[i]) - 30 * p0[i]) / 12
