"""Sums of series on patches, whichever way they are laid out; and patches only where they are wanted."""

from __future__ import annotations

import numpy as np
import pytest
from sample_cars import PAPER_STRUT

from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import sum_one, sum_series, table_of_exponents
from pointcoord.patches.flood import Limits, flood
from pointcoord.patches.lookup import Marked
from pointcoord.solve.assembly import assemble


@pytest.mark.parametrize("patches", [1, 3])
def test_sums_side_by_side_are_those_of_each_pose(patches: int) -> None:
    generator = np.random.default_rng(patches)
    every = powers(2, 3)
    coefficients = generator.normal(size=(patches, every.count, 4))
    middle, half = generator.normal(size=(patches, 2)), generator.uniform(1.0, 2.0, (patches, 2))
    patch = generator.integers(0, patches, 700)
    states = list(generator.normal(size=(3, 700, 2)))
    # Of each derivative only some are wanted.
    tables = [coefficients, coefficients[..., 1:], coefficients[..., :2]]
    many = sum_series(tables, (middle, half), 3, patch, states)
    local = (states[0] - middle[patch]) / half[patch]
    sums = np.einsum("nk,nkm->nm", np.prod(local[:, None] ** every.exponents, axis=-1), coefficients[patch])
    np.testing.assert_allclose(many[0].T, sums, rtol=1e-12, atol=1e-12)
    for n in range(0, 700, 50):
        number = patch[n]
        scaled = [(states[0][n] - middle[number]) / half[number], *(s[n] / half[number] for s in states[1:])]
        ready = table_of_exponents(coefficients[number], 2, 3)
        for count in (1, 2, 3):
            one = sum_one(*ready, [each.tolist() for each in scaled[:count]])
            for sums, alone, part in zip(many, one, (slice(4), slice(1, 4), slice(2)), strict=False):
                np.testing.assert_allclose(alone[part], sums[:, n], rtol=1e-12, atol=1e-12)


def test_only_what_is_wanted_of_a_range_is_covered_and_all_of_that() -> None:
    mechanism = PAPER_STRUT.mechanism()
    domain = Domain(mechanism, {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}, 6)
    start = assemble(mechanism, {"arm_angle": np.array(1.0), "rack": np.array(0.0)})
    marks = np.zeros((64, 64), dtype=bool)
    marks[30:34, 30:34] = marks[:4, :4] = True
    wanted = Marked.of(marks)
    cover = flood(domain, 8, Limits(1e-9), (np.array([64, 64]), start.y), 4096, wanted)
    assert cover.given_up == ()
    assert wanted.any_in(cover.patches.low, cover.patches.high).all()
    assert (cover.patches.lookup.table[marks] >= 0).all()
    assert (cover.patches.lookup.table < 0).any()
