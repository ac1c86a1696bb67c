"""The assertion of a test: a solver's numbers lie within what its stated accuracy makes of each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pointcoord import Scene
from validate.comparison.compare import Comparison, Outcome, compare, compare_solutions
from validate.diagnosis import explain_outcome
from validate.formulations.protocol import Formulation, Solution
from validate.output.report import about
from validate.solvers.check import ACCURACY, AGAINST, required_accuracy
from validate.solvers.plain import PlainSolver

WHO = "the states"
MOST_ROWS, MOST_EXPLANATIONS = 8, 3  # in a message; how many more rows there are is said


class NotTested(AssertionError):
    """Nothing disagrees, but the stated accuracy says nothing of some of the numbers that are given.

    Attributes:
        scene: its name. accuracy: as it was stated, mm. numbers: what is not tested, in words.
    """

    def __init__(self, scene: str, accuracy: float, numbers: Sequence[str], agree: int) -> None:
        self.scene = scene
        self.accuracy = accuracy
        self.numbers = tuple(numbers)
        super().__init__(
            f"not tested in {scene!r}: {', '.join(numbers)}; an accuracy of {accuracy:g} mm says nothing of "
            f"them, for the scene is too near a singular pose for it ({agree} others agree); state a finer "
            "accuracy, or leave this scene out"
        )


def assert_agrees(
    states: Mapping[str, Any],
    scene: Scene | str,
    accuracy: float = ACCURACY,
    against: str | Formulation | Solution = AGAINST,
) -> Outcome:
    """Hold numbers to a formulation, within what the stated accuracy makes of each of them.

    Args:
        states: what a solver answers with, any part of what the scene asks for, by quantity and name (see
            `solvers.plain`).
        scene: that was solved, or its name or path.
        accuracy: how exactly the solver places every point, mm, as it says itself.
        against: the name of a formulation, or one, or a solution of this scene, such as the reference's.
    Returns:
        All comparisons; its notes say what was given that the scene does not ask for.
    Raises:
        AssertionError: a number disagrees, or nothing that is asked for is given. The message says which
            quantity of what, the difference, the tolerance and the instant, and what would explain it.
        NotTested: this accuracy says nothing of some of them, and nothing disagrees.
        NoSolver: `accuracy` is no length above 0.
        FormulationError: the states are no mapping, or the other formulation refuses the scene.
        SceneError: there is no such scene, or it is wrong.

    >>> assert_agrees({"camber": [0.0] * 131}, "bounce")
    Traceback (most recent call last):
    AssertionError: the states disagree with pointcoord in 'bounce' ...
    """
    __tracebackhide__ = True
    exact = required_accuracy(accuracy)
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    name = taken.title or (scene if isinstance(scene, str) else "the scene")
    one = PlainSolver(WHO, lambda _: states, exact)
    if isinstance(against, Solution):
        outcome = compare_solutions(taken, one.solve(taken), against, name)
    else:
        outcome = compare(taken, one, against, name)
    if outcome.disagreements:
        raise AssertionError(_disagreement(taken, outcome, exact))
    untested = [about(row.quantity, row.name) for row in outcome.rows if row.verdict == "not tested"]
    agree = sum(row.verdict == "agrees" for row in outcome.rows)
    if untested:
        raise NotTested(outcome.scene, exact, untested, agree)
    if not agree:
        raise AssertionError(_nothing(outcome))
    return outcome


def _disagreement(scene: Scene, outcome: Outcome, accuracy: float) -> str:
    other = outcome.solutions[1].formulation
    wrong = sorted(outcome.disagreements, key=lambda row: -row.share)
    agree = sum(row.verdict == "agrees" for row in outcome.rows)
    lines = [
        f"{WHO} disagree with {other} in {outcome.scene!r}: {len(wrong)} of {len(wrong) + agree} numbers "
        f"that are tested are off by more than an accuracy of {accuracy:g} mm makes of them",
        *(_row(row) for row in wrong[:MOST_ROWS]),
    ]
    if len(wrong) > MOST_ROWS:
        lines.append(f"  and {len(wrong) - MOST_ROWS} more")
    explained = explain_outcome(scene, outcome)[:MOST_EXPLANATIONS]
    lines += [f"  what would explain it: {one.words}" for one in explained]
    lines += [f"  note: {note}" for note in outcome.notes]
    return "\n".join(lines)


def _row(row: Comparison) -> str:
    return (
        f"  {about(row.quantity, row.name)}: difference {row.difference:.3g} {row.unit}, tolerance "
        f"{row.tolerance:.3g} {row.unit} at t = {row.instant:.9g} s; "
        f"up to {row.share:.3g} times what is allowed"
    )


def _nothing(outcome: Outcome) -> str:
    asked = ", ".join(dict.fromkeys(row.quantity for row in outcome.rows))
    lines = [f"{WHO} hold nothing that {outcome.scene!r} asks for: {asked}"]
    return "\n".join([*lines, *(f"  note: {note}" for note in outcome.notes)])
