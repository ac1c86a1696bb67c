"""A comparison instant by instant says at its worst what the comparison says."""

import numpy as np
import pytest

from pointcoord import Scene
from validate.comparison.compare import compare
from validate.comparison.over_time import over_time


@pytest.mark.parametrize("name", ["bounce-and-steer", "double-wishbone"])
@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_the_largest_share_over_time_is_the_comparison_s(name: str, factor: float) -> None:
    scene = Scene.load(name)
    outcome = compare(scene, "pointcoord", "absolute", factor=factor)
    assert outcome.rows
    for row in outcome.rows:
        found = over_time(outcome, row, scene.instants)
        assert found is not None
        assert float(found.share.max()) == row.share
        assert np.array_equal(found.times, scene.instants)


def test_of_a_quantity_that_one_does_not_give_there_is_nothing_over_time() -> None:
    scene = Scene.load("bounce")
    outcome = compare(scene, "pointcoord", "absolute")
    row = outcome.rows[0]
    first, second = outcome.solutions
    silent = second.with_numbers({row.quantity: {}})
    lacking = type(outcome)(outcome.scene, outcome.rows, (first, silent), (), ())
    assert over_time(lacking, row, scene.instants) is None
