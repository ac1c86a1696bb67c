"""Cases of the catalogue are described as it promises, and their judge catches a wrong number.

That all of them come to what they say, at all their values, is tried by `pointcoord study hard`, which ends
with status 1 where one does not.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import groupby

import numpy as np
import pytest
from stand_in import stand_in

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.answer import Answer
from validate.hard.case import Case
from validate.hard.catalogue import CASES

NAMES = [case.name for case in CASES]


def test_cases_are_called_and_described_as_the_catalogue_promises() -> None:
    assert len(set(NAMES)) == len(NAMES)
    for case in CASES:
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", case.name)
        assert all((case.group, case.why, case.parameter, case.behaviour, case.expected))
        assert len(set(case.values)) == len(case.values) > 0
    groups = [group for group, _ in groupby(case.group for case in CASES)]
    assert len(groups) < 2 * len(set(groups))


# Cases whose judge asks for more than numbers: that is planted in their families' own tests.
OWN_JUDGE = ("Reachable range", "Links and numbers that make no mechanism")


def families() -> list[Case]:
    """Of every group the first case that is right at its first value, and judged there."""
    found: dict[str, Case] = {}
    for case in CASES:
        expected = case.expected.get("pointcoord")
        if case.group in OWN_JUDGE or expected is None or expected.met(case.values[0], "unjudged"):
            continue
        if expected.met(case.values[0], "right"):
            found.setdefault(case.group, case)
    return list(found.values())


@pytest.mark.parametrize("case", families(), ids=lambda case: case.name)
def test_a_wrong_number_is_found_in_every_group(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """A number of a quantity is moved by a millionth of the largest of its kind."""
    given: list[str] = []
    ours = replace(case, expected={"pointcoord": case.expected["pointcoord"]})

    def answer_of(quantity: str) -> Answer:
        def moved(scene: Scene) -> Solution:
            solution = formulation("pointcoord").solve(scene)
            given[:] = [name for name, numbers in solution.numbers.items() if numbers]
            if not quantity:
                return solution
            arrays = {n: np.array(a) for n, a in solution.numbers[quantity].items()}
            largest = max(float(np.abs(a).max()) for a in arrays.values())
            last = list(arrays)[-1]
            arrays[last][(0,) * arrays[last].ndim] += 1e-6 * largest + 1e-9
            return solution.with_numbers({quantity: arrays})

        stand_in(monkeypatch, moved, "pointcoord")
        (answer,) = ours.examine(case.values[0]).answers
        return answer

    assert answer_of("").outcome == "right"
    for quantity in dict.fromkeys((given[0], given[-1])):
        answer = answer_of(quantity)
        assert answer.outcome == "wrong"
        assert quantity.replace("_", " ") in answer.reason
