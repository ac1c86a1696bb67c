"""A formulation of somebody else: a class of a few lines that gives arrays by name, right or wrong."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene
from validate import Accuracy, FormulationError, Outcome, Solution, compare
from validate.formulations.protocol import AccuracyError

SCENE = Scene.load("double-wishbone")
COUNT = len(SCENE.instants)
WHEEL = compare(SCENE, "pointcoord", "absolute").solutions[1].numbers["position"]["wheel_centre"]


def with_solution(make: Callable[[Scene], Any]) -> Outcome:
    class Other:
        name = "mine"

        def solve(self, scene: Scene) -> Any:
            return make(scene)

    return compare(SCENE, "pointcoord", Other())


def test_what_it_gives_is_compared_and_the_rest_is_told() -> None:
    numbers = {"position": {"wheel_centre": np.round(WHEEL, 6)}}
    claims = {"position": {"wheel_centre": np.full((COUNT, 3), 0.51e-6)}}
    outcome = with_solution(
        lambda scene: Solution("mine", scene.instants, numbers, Accuracy(np.ones(COUNT), claims))
    )
    rows = {row.name: row for row in outcome.rows if row.quantity == "position"}
    # A millionth of a millimetre is a thousand times what pointcoord claims: it tests nothing of pointcoord.
    assert rows["wheel_centre"].verdict == "not tested"
    assert rows["wheel_centre"].share <= 1.0
    assert rows["wheel_centre"].rests_on == "mine"
    assert {row.verdict for name, row in rows.items() if name != "wheel_centre"} == {"not given"}
    assert "mine gives no velocity" in outcome.missing
    assert any(told.startswith("mine gives no position of lower_arm_front, ") for told in outcome.missing)


@pytest.mark.parametrize(("more", "same"), [(0.0, True), (1.9e-9, True), (2.1e-9, False), (1.0, False)])
def test_instants_may_come_in_any_order_and_twice_but_not_beyond_both_bounds(more: float, same: bool) -> None:
    # Backwards, and then all once more; every other instant is missing.
    kept = np.arange(COUNT)[::-2]
    places = np.concatenate([WHEEL[kept], WHEEL[kept] + more])
    times = np.tile(SCENE.instants[kept], 2)

    def mine(scene: Scene) -> Solution:
        claims = {"position": {"wheel_centre": np.full(places.shape, 1e-9)}}
        return Solution(
            "mine", times, {"position": {"wheel_centre": places}}, Accuracy(np.ones(len(times)), claims)
        )

    outcome = with_solution(mine)
    (row,) = (r for r in outcome.rows if (r.quantity, r.name) == ("position", "wheel_centre"))
    said = f"mine gives {len(kept)} of {COUNT} instants; the others are not compared"
    assert [note for note in outcome.notes if "instants; the others" in note] == [said]
    assert outcome.compared == len(kept)
    if not same:
        fault = "mine: position of wheel_centre has different numbers at one instant, 2 s; it is ignored"
        assert (row.verdict, outcome.faults, outcome.passed) == ("not given", (fault,), False)
    else:
        assert row.share <= 1.0
        assert row.instant in SCENE.instants[kept]


ONES = np.ones(COUNT)
SURE = Accuracy(ONES)


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"speed": {"wheel_centre": WHEEL}}, "mine: 'speed' is not a quantity and is ignored; there are: "),
        ({"position": [WHEEL]}, "mine: position given as list; needed: arrays by name"),
        ([WHEEL], "mine: its numbers given as list; needed: arrays by name"),
        (
            {"wheel": {"camber": WHEEL}},
            f"wheel angle of camber has the shape ({COUNT}, 3); needed: ({COUNT},)",
        ),
    ],
)
def test_numbers_that_cannot_be_read_are_told_with_what_is_needed(numbers: Any, said: str) -> None:
    outcome = with_solution(lambda scene: Solution("mine", scene.instants, numbers, SURE))
    assert any(said in told for told in (*outcome.notes, *outcome.missing))
    assert not outcome.agreed


def claiming(claims: Any) -> Solution:
    return Solution("mine", SCENE.instants, {"position": {"wheel_centre": WHEEL}}, Accuracy(ONES, claims))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: replace(claiming({}), accuracy=None), "its accuracy is a NoneType; needed: an Accuracy"),
        (lambda: claiming({"speed": {}}), "'speed' is of no known quantity; allowed: position"),
        (lambda: claiming({"position": [1e-9]}), "position is a list; allowed: arrays by"),
        (lambda: claiming([1e-9]), "claims is a list; allowed: arrays by quantity and name"),
        (
            lambda: claiming({"velocity": {"wheel_centre": np.full((COUNT, 3), -1e-9)}}),
            "velocity of wheel_centre is -1e-09 at instant number 0",
        ),
        (lambda: claiming({"velocity": {"wheel_centre": np.full((COUNT, 3), np.nan)}}), "is nan"),
        (lambda: claiming({"velocity": {"wheel_centre": np.ones((COUNT, 3), int)}}), "is of type int64"),
        (lambda: claiming({"velocity": {"wheel_centre": np.ones(COUNT)}}), "has the shape"),
        (lambda: replace(claiming({}), times=SCENE.instants[:, None]), "times"),
        (lambda: {"position": {"wheel_centre": WHEEL}}, ""),
        (lambda: replace(claiming({}), accuracy=Accuracy(-ONES)), ""),
    ],
)
def test_what_is_no_solution_and_a_claim_that_is_no_bound_are_refusals(
    make: Callable[[], Any], said: str
) -> None:
    with pytest.raises(FormulationError, match=r"^mine: ") as caught:
        with_solution(lambda scene: make())
    assert said in str(caught.value)


def test_a_claim_that_is_no_bound_says_what_is_allowed() -> None:
    with pytest.raises(AccuracyError, match="; allowed: finite numbers from 0 up"):
        Accuracy(-ONES)
