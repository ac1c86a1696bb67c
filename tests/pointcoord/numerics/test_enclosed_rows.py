"""Rows of a quadratic map of enclosed coordinates, against rational arithmetic."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosed_rows import differences, residual
from pointcoord.numerics.enclosure import Enclosed

U = Fraction(1, 2**53)


@given(seed=st.integers(0, 2**32 - 1), moved=st.booleans())
def test_a_residual_is_right_to_within_what_it_says_itself(strut: Mechanism, seed: int, moved: bool) -> None:
    rng = np.random.default_rng(seed)
    system, n = strut.map, strut.map.unknowns
    y = strut.drawn + np.concatenate([rng.normal(size=n), np.zeros(system.size - n)])
    low = np.zeros_like(y)
    low[n:] = rng.uniform(-4.0, 4.0, size=system.size - n) * float(U) * y[n:]
    data = np.abs(y) * 1e-10 * moved
    rows = residual(system, differences(system, Enclosed.of(y, low, data)))
    value, doubt = rows.middle, rows.radius[0] + float(U) * np.abs(rows.high)
    meant = [
        Fraction(a) + Fraction(b) + Fraction(c)
        for a, b, c in zip(
            y.tolist(), low.tolist(), (data * rng.uniform(-1.0, 1.0, size=len(y))).tolist(), strict=True
        )
    ]
    for row, found, least in zip(system.rows, value.tolist(), doubt.tolist(), strict=True):
        exact = sum(
            Fraction(p.coefficient)
            * (meant[p.left[0]] - meant[p.left[1]])
            * (meant[p.right[0]] - meant[p.right[1]])
            for p in row
        )
        assert abs(Fraction(found) - exact) <= Fraction(least)
        if not moved:
            # One rounding of the result is all that is left of it, and squares of roundings.
            assert least <= 3 * float(U) * abs(found) + 1e-28
