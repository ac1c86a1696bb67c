"""What comes of a scene of which each formulation answers, refuses or fails as it likes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import pytest

from pointcoord import MotionTooLong, MotionTooRough, Scene, SceneError
from validate.comparison.examined import Examined, examine
from validate.exit_status import ExitStatus
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import formulation

SCENE = Scene.load("steer")


@cache
def solved() -> Solution:
    return formulation("pointcoord").solve(SCENE)


class Fixed:
    """A formulation that answers what it was made with, or raises it; and counts how often."""

    def __init__(self, name: str, answer: Solution | Exception) -> None:
        self.name, self.answer, self.asked = name, answer, 0

    def solve(self, scene: Scene) -> Solution:
        self.asked += 1
        if isinstance(self.answer, Exception):
            raise self.answer
        return replace(self.answer, formulation=self.name)


def refuses(name: str, reason: Exception) -> FormulationError:
    return FormulationError(name, reason)


def examined(answers: Mapping[str, Solution | Exception], *pairs: str, printed: bool = False) -> Examined:
    """Pairs such as "a b"."""
    others = {name: Fixed(name, answer) for name, answer in answers.items()}
    two = [(first, second) for first, second in (pair.split() for pair in pairs)]
    found = examine("my scene", SCENE, two, printed, others=others)
    assert all(one.asked == 1 for one in others.values())
    return found


def test_who_agrees_ends_with_0_and_has_nothing_to_complain_of() -> None:
    found = examined({"a": solved(), "b": solved(), "c": solved()}, "a b", "c b")
    assert found.status is ExitStatus.AGREE
    assert (found.complaint, found.refusals, found.failures, found.printed) == ("", (), (), None)
    assert found.solved == ("a", "b", "c")
    assert [(o.rows[0].first, o.rows[0].second) for o in found.outcomes] == [("a", "b"), ("c", "b")]


def test_a_refusal_is_no_verdict_and_says_by_whom_and_who_solved_it() -> None:
    answers = {"a": solved(), "b": refuses("b", ValueError("too bumpy")), "c": solved()}
    found = examined(answers, "a b", "c b")
    assert found.status is ExitStatus.NO_VERDICT
    assert [(r.formulation, r.error) for r in found.refusals] == [("b", "ValueError")]
    assert found.failures == ()
    assert found.complaint == "my scene: too bumpy; refused by b (ValueError); solved by a and c"
    every = examined({name: refuses(name, ValueError("too bumpy")) for name in "abc"}, "a b", "c b")
    assert every.complaint == (
        "my scene: too bumpy; refused by a (ValueError), b (ValueError) and c (ValueError)"
    )
    assert every.solved == ()


def test_hardpoints_that_make_no_mechanism_are_a_wrong_input_under_the_users_name() -> None:
    wrong = SceneError("file.toml", "points.strut_top", "lies in the ball joint", "a point apart")
    found = examined({"a": solved(), "b": wrong}, "a b")
    assert found.status is ExitStatus.WRONG_INPUT
    assert found.complaint == (
        "my scene: points.strut_top: lies in the ball joint; allowed: a point apart; "
        "refused by b (SceneError); solved by a"
    )


def test_a_failure_is_no_refusal_and_says_where_it_was_raised() -> None:
    found = examined({"a": solved(), "b": RuntimeError("no luck")}, "a b")
    assert found.status is ExitStatus.NOT_FINISHED
    assert (found.refusals, found.outcomes, found.solved) == ((), (), ("a",))
    ((who, error, said),) = [(f.formulation, f.error, f.message) for f in found.failures]
    assert (who, error) == ("b", "RuntimeError")
    assert said.startswith("no luck at test_examine_in_pairs.py:")
    assert said.endswith("; this is a defect, please report it")
    silent = examined({"a": solved(), "b": RuntimeError()}, "a b")
    assert silent.failures[0].message.startswith("no message at test_examine_in_pairs.py:")


def test_after_a_failure_no_other_pair_is_tried() -> None:
    others = {"a": Fixed("a", solved()), "b": Fixed("b", MemoryError()), "c": Fixed("c", solved())}
    found = examine("my scene", SCENE, [("a", "b"), ("c", "a")], False, others=others)
    assert [one.asked for one in others.values()] == [1, 1, 0]
    assert found.status is ExitStatus.NOT_FINISHED
    assert found.solved == ("a",)


@pytest.mark.parametrize(
    ("reason", "advised"),
    [
        (MotionTooLong(10, 0.5, 0.0, 1.0), True),
        (MotionTooRough("rack", 0.5), True),
        (ValueError("too bumpy"), False),
    ],
    ids=["long", "rough", "bumpy"],
)
def test_only_who_is_advised_the_method_newton_is_told_how_to_ask_for_it(
    reason: Exception, advised: bool
) -> None:
    found = examined({"a": solved(), "b": refuses("b", reason)}, "a b")
    assert ("(--first pointcoord-newton)" in found.complaint) == advised


def test_the_printed_formulas_are_compared_if_asked_for_and_count_for_nothing() -> None:
    answers = {"a": solved(), "b": solved()}
    plain, both = (examined(answers, "a b", printed=printed) for printed in (False, True))
    assert plain.printed is None
    assert both.printed is not None
    assert both.printed.disagreements  # the knuckle's turn of the printed formulas is 0/0
    assert both.status is plain.status is ExitStatus.AGREE
    assert len(both.outcomes) == 1
    without = examined({"a": refuses("a", ValueError("no")), "b": solved()}, "a b", printed=True)
    assert (without.printed, without.unprinted) == (None, None)
