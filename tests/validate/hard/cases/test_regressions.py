"""What searches found stays found: each case shows what it is in the catalogue for."""

from typing import Any

import numpy as np
import pytest

import pointcoord.solve.taylor
from validate.hard.case import Case
from validate.hard.cases.regressions import CASES

BY_NAME = {case.name: case for case in CASES}


def outcomes(case: Case, values: tuple[float, ...], name: str = "pointcoord") -> list[str]:
    return [a.outcome for v in values for a in case.examine(v).answers if a.formulation == name]


def test_the_searched_bound_is_all_but_met_and_never_broken() -> None:
    case = BY_NAME["error-all-but-its-bound"]
    shares = [case.examine(value).answers[0].share for value in case.values[::2]]
    assert all(share is not None and share <= 1.0 for share in shares)
    assert max(share for share in shares if share is not None) > 0.99


def test_a_turn_leads_to_another_branch_where_the_branch_is_not_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case = BY_NAME["turn-at-a-coarse-tolerance"]
    near = (1e-10, 1e-11, 1e-12, 1e-13, 1e-14)
    assert "wrong" not in outcomes(case, near)

    def blind(system: Any, side: Any, series: Any, s: float, reached: Any) -> Any:
        return np.ones(reached.y.shape[:-1], dtype=bool)

    monkeypatch.setattr(pointcoord.solve.taylor, "on_branch", blind)
    assert "wrong" in outcomes(case, near)
