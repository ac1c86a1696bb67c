"""Sums of a chain's series are those of its polynomials, one by one."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from pointcoord.numerics.counters import Work
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.taylor import Chain, Segment


@pytest.mark.parametrize("batch", [(), (3,), (2, 3)])
@pytest.mark.parametrize("size", [1, 9])
@pytest.mark.parametrize("ordered", [True, False])
def test_sums_are_those_of_the_polynomials(batch: tuple[int, ...], size: int, ordered: bool) -> None:
    rng = np.random.default_rng(5)
    ends, scales, orders = (0.0, 0.5, 0.75, 2.0), (1.0, 0.25, 2.0), (6, 3, 7)
    segments = tuple(
        Segment(start, stop, scale, rng.normal(size=(*batch, order + 1, size)))
        for start, stop, scale, order in zip(ends[:-1], ends[1:], scales, orders, strict=True)
    )
    chain = Chain(segments, Work())
    # More than a block of them in the last segment.
    instants = np.sort(rng.uniform(0.0, 2.0, 3000))
    if not ordered:
        instants = rng.permutation(instants)
    found = evaluate(chain, [segment.coefficients for segment in segments], instants, 2)
    assert found.shape == (3, *batch, 3000, size)
    for number, t in list(enumerate(instants.tolist()))[::149]:
        segment = next(s for s in reversed(segments) if s.start <= t)
        for place in np.ndindex(*batch):
            for k in range(size):
                series = Polynomial(segment.coefficients[(*place, slice(None), k)])
                for d in range(3):
                    one = series.deriv(d)((t - segment.start) / segment.scale) / segment.scale**d
                    assert found[(d, *place, number, k)] == pytest.approx(one, rel=1e-11, abs=1e-11)
