"""Laws of the inputs of every speed, length and smoothness: right numbers, or a refusal that says why."""

from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.hard.case import Case
from validate.hard.cases import extreme_durations, laws
from validate.hard.family import PAPER
from validate.hard.run import examine

BY_NAME = {case.name: case for case in (*laws.CASES, *extreme_durations.CASES)}


def at(case: str, *values: float) -> Case:
    """A case at some values of its parameter only."""
    return replace(BY_NAME[case], values=values)


@pytest.mark.parametrize("name", ["come-to-rest", "seen-at-rest-only", "stop-before-a-lock"])
def test_where_the_inputs_stop_every_formulation_is_right(name: str) -> None:
    values = BY_NAME[name].values
    result = examine(at(name, values[0], values[2], values[len(values) // 2]))
    for formulation in ("pointcoord", "pointcoord-newton", "absolute"):
        assert [answer.outcome for _, answer in result.answers(formulation)] == ["right"] * 3


def test_a_million_swings_are_right_by_a_map_and_at_their_instants() -> None:
    (trial,) = examine(at("long-sine", 1e6)).trials
    found = {answer.formulation: answer for answer in trial.answers}
    assert found["pointcoord"].outcome == "right"
    assert found["pointcoord-newton"].outcome == "right"
    assert found["absolute"].outcome == "right"


def test_the_same_way_at_any_rate_has_the_same_poses() -> None:
    """Time only scales: positions at the same shares of the duration are those of the rate of 1."""
    from validate.formulations.registry import formulation

    fast, slow = (
        formulation("pointcoord").solve(Scene.from_mapping(laws._scaled(PAPER, rate)))
        for rate in (2.0**40, 2.0**-40)
    )
    for name in fast.position:
        assert np.abs(fast.position[name] - slow.position[name]).max() < 1e-12
        gap = fast.velocity[name] * 2.0**-80 - slow.velocity[name]
        assert np.abs(gap).max() <= 1e-12 * np.abs(slow.velocity["wheel_centre"]).max()


def test_the_way_of_the_stopping_law_is_at_rest_at_its_three_instants() -> None:
    law = np.polynomial.Polynomial(laws.STOPPING)
    assert np.array_equal(law(np.array([0.0, 0.5, 1.0])), [0.0, 1.0, 0.0])
    assert np.array_equal(law.deriv(1)(np.array([0.0, 0.5, 1.0])), [0.0, 0.0, 0.0])
    assert (law.deriv(2)(np.array([0.0, 0.5, 1.0])) != 0.0).all()
