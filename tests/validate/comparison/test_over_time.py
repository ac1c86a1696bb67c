"""A comparison instant by instant says at its worst what the comparison says."""

from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.comparison.compare import compare, compare_solutions
from validate.comparison.over_time import over_time
from validate.formulations.protocol import Solution


@pytest.mark.parametrize(("name", "factor"), [("bounce-and-steer", 1.0), ("double-wishbone", 3.0)])
def test_the_largest_share_over_time_is_the_comparison_s(name: str, factor: float) -> None:
    scene = Scene.load(name)
    outcome = compare(scene, "pointcoord", "absolute", factor=factor)
    assert outcome.rows
    for row in outcome.rows:
        found = over_time(outcome, row, scene.instants)
        assert found is not None
        assert float(found.share.max()) == row.share
        assert np.array_equal(found.times, scene.instants)


def at(solution: Solution, kept: np.ndarray) -> Solution:
    """Some instants of a solution."""
    numbers, claims = (
        {quantity: {name: array[kept] for name, array in part.items()} for quantity, part in arrays.items()}
        for arrays in (solution.numbers, solution.accuracy.claims)
    )
    usual = {quantity: most[kept] for quantity, most in solution.accuracy.usual.items()}
    condition = solution.accuracy.condition[kept]
    accuracy = replace(solution.accuracy, claims=claims, condition=condition, usual=usual)
    return replace(solution, times=solution.times[kept], numbers=numbers, accuracy=accuracy)


def test_only_instants_that_both_give_are_compared_over_time() -> None:
    scene = Scene.load("bounce")
    first, second = compare(scene, "pointcoord", "absolute").solutions
    count = len(scene.instants)
    one, two = at(first, np.arange(0, count, 2)), at(second, np.arange(0, count, 3))
    for pair in ((one, two), (two, one), (first, two), (two, first)):
        step = 3 if pair[0] is first or pair[1] is first else 6
        outcome = compare_solutions(scene, *pair, "bounce")
        for row in outcome.rows:
            found = over_time(outcome, row, scene.instants)
            assert found is not None
            assert np.array_equal(found.times, scene.instants[::step])
            assert float(found.share.max()) == row.share
