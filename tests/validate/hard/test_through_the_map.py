"""Hard cases go through the map of the inputs too, with bounded effort, and its wrong numbers are found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from stand_in import stand_in

from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard import trial
from validate.hard.cars import PAPER_CAR, scene_content
from validate.hard.case import MAP, RIGHT, Case, case, decades
from validate.hard.report import summary_parts
from validate.hard.run import as_expected, examine
from validate.hard.trial import OURS
from validate.output.table import text_of


def steered(far: Callable[[float], float], expected: str = OURS) -> Case:
    """A case that holds the rack somewhere while the arm turns."""
    return case(
        lambda _, value: scene_content(PAPER_CAR, [1.5, 0.1], far(value), stop=0.2, samples=2),
        "rack travel, mm",
        decades(-6),
        {expected: RIGHT},
        name="steered",
        why="It is made.",
        group="0. Made",
    )


def map_instead(monkeypatch: pytest.MonkeyPatch, change: Callable[[Solution], Solution]) -> None:
    """Put pointcoord's own solution in the place of the map's, changed."""
    stand_in(monkeypatch, lambda scene: change(replace(formulation(OURS).solve(scene), formulation=MAP)), MAP)


def test_a_wrong_number_of_the_map_is_neither_expected_nor_passed_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def off(solution: Solution) -> Solution:
        moved = {n: np.array(a) for n, a in solution.numbers["acceleration"].items()}
        moved["wheel_centre"][-1, 2] += 1e-6
        return solution.with_numbers({"acceleration": moved})

    map_instead(monkeypatch, off)
    result = examine(steered(lambda value: value))
    assert {(a.formulation, a.outcome) for _, a in result.unexpected} == {(MAP, "wrong")}
    assert len(result.wrong) == 2
    assert not as_expected([result])


def test_its_effort_is_bounded_and_what_it_refuses_is_counted_by_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(trial, "MAP_EFFORT", 0)
    result = examine(steered(lambda value: value))
    assert {a.outcome for _, a in result.answers(MAP)} == {"refused"}
    assert as_expected([result])
    assert "Refused by the map, whose effort is bounded here: 2 MotionNotMapped." in text_of(
        summary_parts([result])
    )
