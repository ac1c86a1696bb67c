"""The equations of every mechanism are differentiated correctly by the unknowns."""

from __future__ import annotations

import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanism_drawings import DRAWINGS, drawing

from validate.reference.equations import Equations, equations_in

fractions = st.integers(-1000, 1000).map(lambda n: fmpq(n, 16))


def exact_equations(name: str) -> tuple[Equations, int]:
    """The equations in fractions, and the number of the numbers w."""
    mechanism = drawing(name).mechanism
    return equations_in(mechanism, lambda number: number), mechanism.count


@pytest.mark.parametrize("name", DRAWINGS)
@given(data=st.data())
@settings(max_examples=10, deadline=None)
def test_the_jacobian_is_exactly_the_central_difference_of_the_quadratic_residual(
    name: str, data: st.DataObject
) -> None:
    equations, count = exact_equations(name)
    size = len(equations.rows)
    y, step = (data.draw(st.lists(fractions, min_size=size, max_size=size)) for _ in range(2))
    w = data.draw(st.lists(fractions, min_size=count, max_size=count))
    ahead = equations.residual([a + b for a, b in zip(y, step, strict=True)], w)
    behind = equations.residual([a - b for a, b in zip(y, step, strict=True)], w)
    product = [fmpq(0)] * size
    for row, column, entry in equations.jacobian(y, w):
        product[row] += entry * step[column]
    assert product == [(a - b) / 2 for a, b in zip(ahead, behind, strict=True)]
