"""What comes of a scene of which each formulation answers, refuses or fails as it likes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from pointcoord import Scene, SceneError
from validate.comparison.examined import Examined, examine
from validate.exit_status import ExitStatus
from validate.formulations.protocol import Solution
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


def examined(answers: Mapping[str, Solution | Exception], *pairs: str, printed: bool = False) -> Examined:
    """Pairs such as "a b"."""
    others = {name: Fixed(name, answer) for name, answer in answers.items()}
    two = [(first, second) for first, second in (pair.split() for pair in pairs)]
    found = examine("my scene", SCENE, two, printed, others=others)
    assert all(one.asked == 1 for one in others.values())
    return found


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
