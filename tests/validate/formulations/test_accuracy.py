"""What a formulation claims of its accuracy is checked, and so is everything else that it gives."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene
from validate.comparison.compare import Outcome, compare
from validate.formulations.protocol import Accuracy, AccuracyError, FormulationError, Solution
from validate.formulations.registry import formulation

SCENE = Scene.load("steer")
COUNT = len(SCENE.instants)
ONES = np.ones(COUNT)


@pytest.mark.parametrize(
    ("claim", "said"),
    [
        (np.full((COUNT, 3), -1e-9), "velocity of wheel_centre is -1e-09 at instant number 0"),
        (np.full((COUNT, 3), np.nan), "is nan"),
        (np.ones((COUNT, 3), dtype=int), "is of type int64"),
        (np.ones(COUNT), "has the shape"),
        (np.ones((COUNT + 1, 3)), "has the shape"),
    ],
)
def test_a_claim_that_is_no_bound_is_refused_with_what_is_allowed(claim: Any, said: str) -> None:
    with pytest.raises(AccuracyError, match="allowed: ") as caught:
        Accuracy(ONES, {"velocity": {"wheel_centre": claim}})
    assert said in str(caught.value)


class Changed:
    """The absolute model with its solution changed, under a name of its own."""

    name = "changed"

    def __init__(self, change: Callable[[Solution], object]) -> None:
        self.change = change

    def solve(self, scene: Scene) -> Any:
        return self.change(replace(formulation("absolute").solve(scene), formulation="changed"))


def with_claims(solution: Solution, **claims: Any) -> Solution:
    """The solution with other claims of some quantities."""
    return replace(solution, accuracy=solution.accuracy.with_claims(claims))


def compared(change: Callable[[Solution], object]) -> Outcome:
    return compare(SCENE, "pointcoord", Changed(change))


@pytest.mark.parametrize(
    "change",
    [
        lambda s: replace(s, times=None),
        lambda s: replace(s, times=s.times[:, None]),
        lambda s: {"position": s.numbers["position"]},
        lambda s: replace(s, accuracy=Accuracy(-s.accuracy.condition)),
    ],
)
def test_what_is_no_solution_is_a_refusal(change: Callable[[Solution], object]) -> None:
    with pytest.raises(FormulationError, match=r"^changed: "):
        compared(change)


@pytest.mark.parametrize("quantity", ["position", "velocity", "angular_acceleration", "wheel"])
def test_a_tolerance_that_rests_on_one_sides_claim_alone_tests_nothing(quantity: str) -> None:
    def wide(solution: Solution) -> Solution:
        claims = {name: claim + 1e-3 for name, claim in solution.accuracy.claims[quantity].items()}
        return with_claims(solution, **{quantity: claims})

    outcome = compared(wide)
    loose = [row for row in outcome.rows if row.quantity == quantity and row.difference > 0.0]
    assert loose
    for row in loose:
        assert row.verdict == "not tested"
        assert row.rests_on == "changed"
        assert row.part > 0.999
    assert not outcome.agreed
    assert all(row.verdict == "agrees" for row in outcome.rows if row.quantity != quantity)
