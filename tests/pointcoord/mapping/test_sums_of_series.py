"""Sums of series on patches, whichever way they are laid out; and patches only where they are wanted."""

from __future__ import annotations

import numpy as np
import pytest
from sample_cars import PAPER_STRUT

from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import sum_rows, sum_series
from pointcoord.patches.flood import Limits, flood
from pointcoord.patches.lookup import Lookup, Marked
from pointcoord.solve.assembly import assemble


@pytest.mark.parametrize("patches", [1, 3])
def test_sums_side_by_side_are_those_of_each_pose(patches: int) -> None:
    generator = np.random.default_rng(patches)
    every = powers(2, 3)
    coefficients = generator.normal(size=(patches, every.count, 4))
    middle, half = generator.normal(size=(patches, 2)), generator.uniform(1.0, 2.0, (patches, 2))
    patch = generator.integers(0, patches, 700)
    states = list(generator.normal(size=(3, 700, 2)))
    poses = sum_series(coefficients, middle, half, 3, patch, states)
    # Of each derivative only some are wanted.
    rows = sum_rows(
        [coefficients, coefficients[..., 1:], coefficients[..., :2]], middle, half, 3, patch, states
    )
    for row, pose in zip(rows, (poses[0], poses[1][:, 1:], poses[2][:, :2]), strict=True):
        np.testing.assert_allclose(row.T, pose, rtol=1e-12, atol=1e-12)
    local = (states[0] - middle[patch]) / half[patch]
    sums = np.einsum("nk,nkm->nm", np.prod(local[:, None] ** every.exponents, axis=-1), coefficients[patch])
    np.testing.assert_allclose(poses[0], sums, rtol=1e-12, atol=1e-12)


def test_only_what_is_wanted_of_a_range_is_covered_and_all_of_that() -> None:
    mechanism = PAPER_STRUT.mechanism()
    domain = Domain(mechanism, {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}, 6)
    start = assemble(mechanism, {"arm_angle": np.array(1.0), "rack": np.array(0.0)})
    marks = np.zeros((64, 64), dtype=bool)
    marks[30:34, 30:34] = marks[:4, :4] = True
    wanted = Marked.of(marks)
    cover = flood(domain, 8, Limits(1e-9), (np.array([64, 64]), start.y), 4096, wanted)
    assert cover.patches is not None
    assert cover.given_up == ()
    assert wanted.any_in(cover.patches.low, cover.patches.high).all()
    assert (Lookup.of(domain, cover.patches.low, cover.patches.high).table[marks] >= 0).all()
    assert (Lookup.of(domain, cover.patches.low, cover.patches.high).table < 0).any()
