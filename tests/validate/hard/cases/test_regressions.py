"""What searches found stays found: each case shows what it is in the catalogue for."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pointcoord.solve.taylor
from validate.hard.answer import Answer
from validate.hard.cases.regressions import CASES

BY_NAME = {case.name: case for case in CASES}


def answers(name: str, *values: float) -> list[Answer]:
    """What pointcoord answers in a case at some values, by default all."""
    case = BY_NAME[name]
    ours = replace(case, expected={"pointcoord": case.expected["pointcoord"]})
    return [answer for value in values or case.values for answer in ours.examine(value).answers]


def test_the_searched_bound_is_all_but_met_and_never_broken() -> None:
    values = BY_NAME["error-all-but-its-bound"].values[::2]
    shares = [answer.share or np.inf for answer in answers("error-all-but-its-bound", *values)]
    assert 0.99 < max(shares) <= 1.0


def test_a_turn_leads_to_another_branch_where_the_branch_is_not_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name, near = "turn-at-a-coarse-tolerance", (1e-10, 1e-11, 1e-12, 1e-13, 1e-14)
    assert "wrong" not in {answer.outcome for answer in answers(name, *near)}

    def blind(system: Any, side: Any, series: Any, s: float, reached: Any) -> Any:
        return np.ones(reached.y.shape[:-1], dtype=bool)

    monkeypatch.setattr(pointcoord.solve.taylor, "on_branch", blind)
    assert "wrong" in {answer.outcome for answer in answers(name, *near)}
