"""The equations of every mechanism are differentiated rightly, by the unknowns and by time."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanism_drawings import DRAWINGS

from validate.reference.equations import Equations, equations_in
from validate.reference.jet import Jet

fractions = st.integers(-1000, 1000).map(lambda n: Fraction(n, 16))


def exact_equations(name: str) -> tuple[Equations, int]:
    """The equations in fractions, and how many numbers of inputs they take."""
    design = DRAWINGS[name]()
    count = sum(len(drive.drawn()) for drive in design.mechanism.drives.values())
    return equations_in(design.mechanism, design.chosen, lambda number: number), count


@pytest.mark.parametrize("name", DRAWINGS)
@given(data=st.data())
@settings(max_examples=10, deadline=None)
def test_the_jacobian_is_exactly_the_central_difference_of_the_quadratic_residual(
    name: str, data: st.DataObject
) -> None:
    equations, count = exact_equations(name)
    size = equations.size
    y, step = (data.draw(st.lists(fractions, min_size=size, max_size=size)) for _ in range(2))
    w = data.draw(st.lists(fractions, min_size=count, max_size=count))
    ahead = equations.residual([a + b for a, b in zip(y, step, strict=True)], w)
    behind = equations.residual([a - b for a, b in zip(y, step, strict=True)], w)
    product = [Fraction(0)] * size
    for row, column, entry in equations.jacobian(y, w):
        product[row] += entry * step[column]
    assert product == [(a - b) / 2 for a, b in zip(ahead, behind, strict=True)]


@pytest.mark.parametrize("name", DRAWINGS)
@given(data=st.data())
@settings(max_examples=5, deadline=None)
def test_jets_give_the_exact_derivatives_along_a_parabola(name: str, data: st.DataObject) -> None:
    equations, count = exact_equations(name)
    size = equations.size
    y, rate, bend = (data.draw(st.lists(fractions, min_size=size, max_size=size)) for _ in range(3))
    w = data.draw(st.lists(fractions, min_size=count, max_size=count))

    def at(t: int) -> list[Fraction]:
        moved = [a + b * t + c * t * t / 2 for a, b, c in zip(y, rate, bend, strict=True)]
        return equations.residual(moved, w)

    # C(y(t)) has degree 4 in t, for which five-point differences are exact.
    p2, p1, p0, m1, m2 = (at(t) for t in (2, 1, 0, -1, -2))
    jets = equations.residual([Jet(a, b, c) for a, b, c in zip(y, rate, bend, strict=True)], w)
    for i, jet in enumerate(jets):
        assert jet.value == p0[i]
        assert jet.part(1) == (8 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / 12
        assert jet.part(2) == (16 * (p1[i] + m1[i]) - (p2[i] + m2[i]) - 30 * p0[i]) / 12
