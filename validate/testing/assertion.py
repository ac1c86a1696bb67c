"""What a test asserts of a solver: its numbers lie within what its stated accuracy makes of each of them, and
it gives none where there is no pose.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pointcoord import PointcoordError, Scene
from pointcoord.wording import meant
from validate.comparison.compare import Outcome, compare, compare_solutions
from validate.comparison.given import given
from validate.diagnosis import explain_outcome
from validate.errors import UsageError
from validate.formulations.protocol import Formulation, FormulationError, Solution
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.output.report import about, told_row
from validate.reference import InfeasibleError, NoReferenceError
from validate.solvers.check import ACCURACY, AGAINST, required_accuracy
from validate.solvers.plain import PlainSolver, as_function, given_to_solver

WHO = "the states"
# What is said of a test's own arguments; anything else that is raised is a defect of this package.
TOLD = (AssertionError, PointcoordError, FormulationError, NoReferenceError, UsageError)
MOST_ROWS, MOST_EXPLANATIONS = 8, 3  # in a message; how many more rows there are is said


class NotTested(AssertionError):
    """Nothing disagrees, but the stated accuracy says nothing of some of the numbers that are given.

    Attributes:
        scene: its name. accuracy: as it was stated, mm. numbers: what is not tested, in words.
        agree: how many others do.
    """

    def __init__(self, scene: str, accuracy: float, numbers: Sequence[str], agree: int) -> None:
        self.scene = scene
        self.accuracy = accuracy
        self.numbers = tuple(numbers)
        self.agree = agree
        super().__init__(
            f"not tested in {scene!r}: {', '.join(numbers)}; an accuracy of {accuracy:g} mm says nothing of "
            f"them, for the scene is too near a singular pose for it ({agree} others agree); state a finer "
            "accuracy, or leave this scene out"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.scene, self.accuracy, self.numbers, self.agree)


def assert_agrees(
    states: Mapping[str, Any],
    scene: Scene | str,
    accuracy: float = ACCURACY,
    against: str | Formulation | Solution = AGAINST,
    needed: Collection[str] = (),
) -> Outcome:
    """Hold numbers to a formulation, within what the stated accuracy makes of each of them.

    Args:
        states: what a solver answers with, any part of what the scene asks for, by quantity and name (see
            `solvers.plain`).
        scene: that was solved, or its name or path.
        accuracy: how exactly the solver places every point, mm, as it says itself.
        against: the name of a formulation, or one, or a solution of this scene, such as the reference's.
        needed: what must be given, all that the scene asks for of it: quantities, such as "velocity", or
            numbers of the car, such as "camber". Anything else may be missing.
    Returns:
        All comparisons; its notes say what was given that the scene does not ask for.
    Raises:
        AssertionError: a number disagrees, or nothing that is asked for is given but points that stay where
            they are drawn. The message says which quantity of what, the difference, the tolerance and the
            instant, and what would explain it. Or a number has another shape than its kind, or a misspelt
            name, or what is needed is missing: a comparison would leave it out and judge the rest.
        NotTested: this accuracy says nothing of some of them, and nothing disagrees.
        UsageError: `accuracy` is no length above 0.
        FormulationError: the states are no mapping, or the other formulation refuses the scene.
        SceneError: there is no such scene, or it is wrong.

    >>> assert_agrees({"camber": [0.0] * 131}, "bounce")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    AssertionError: the states disagree with pointcoord in 'bounce': ...
    """
    __tracebackhide__ = True
    exact = required_accuracy(accuracy)
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    name = scene if isinstance(scene, str) else taken.title or "the scene"
    one = PlainSolver(WHO, lambda _: states, exact)
    if isinstance(against, Solution):
        outcome = compare_solutions(taken, one.solve(taken), against, name)
    else:
        outcome = compare(taken, one, against, name)
    if faults := (*outcome.faults, *_lacking(outcome, needed)):
        raise AssertionError("; ".join(faults))
    if outcome.disagreements:
        raise AssertionError(_disagreement(taken, outcome, exact))
    untested = [about(row.quantity, row.name) for row in outcome.rows if row.verdict == "not tested"]
    agree = sum(row.verdict == "agrees" for row in outcome.rows)
    if untested:
        raise NotTested(outcome.scene, exact, untested, agree)
    if not outcome.passed:
        raise AssertionError(_nothing(outcome))
    return outcome


def assert_refuses(
    solver: object, scene: Scene | str, raises: type[Exception] | tuple[type[Exception], ...] = Exception
) -> None:
    """See that a solver does not answer where a scene has no pose.

    It may raise an error, leave out these instants, or have a NaN among its numbers at each of them. That
    there is no pose is proven by the reference.

    Args:
        solver: a function of one mapping, or an object or class with a method `solve` (see `solvers.plain`).
        scene: with instants that have no pose, or its name or path.
        raises: what it raises to refuse; another error is none, and comes through.
    Raises:
        AssertionError: all that it gives at such an instant are numbers; or it gives nothing.
        UsageError: `solver` is none. SceneError: there is no such scene, or every instant has a pose.
    """
    __tracebackhide__ = True
    function = as_function(solver, "the solver")
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    name = scene if isinstance(scene, str) else taken.title or "the scene"
    without = _without_pose(taken)
    if not without:
        raise AssertionError(f"every instant of {name!r} has a pose; hold the numbers there by assert_agrees")
    plain = given_to_solver(taken)
    try:
        answer = function(plain)
    except raises:
        return
    try:
        solution = PlainSolver("the solver", lambda _: answer, ACCURACY).solve(taken)
    except FormulationError as error:
        raise AssertionError(str(error)) from None
    side = given(solution, taken.instants)
    if side.solution.faults:
        raise AssertionError("; ".join(side.solution.faults))
    arrays = [array for part in side.solution.numbers.values() for array in part.values()]
    if not arrays:
        raise AssertionError(f"the solver gives nothing that {name!r} asks for")
    finite = np.all([np.isfinite(a.reshape(len(a), -1)).all(axis=-1) for a in arrays], axis=0)
    answered = [time for time in taken.instants[side.found][finite].tolist() if time in without]
    if answered:
        raise AssertionError(
            f"the solver answers {name!r} at t = {answered[0]:.9g} s, where there is no pose: "
            f"{without[answered[0]]}; let it raise an error there, or give NaN"
        )


def _lacking(outcome: Outcome, needed: Collection[str]) -> Iterator[str]:
    """What is needed of states and not there, a line each."""
    for need in needed:
        rows = [row for row in outcome.rows if need in (row.quantity, row.name)]
        if not rows:
            known = dict.fromkeys(word for row in outcome.rows for word in (row.quantity, row.name))
            yield f"{need!r} is needed, and the scene does not ask for it{meant(str(need), known)}"
        elif names := [row.name for row in rows if row.verdict == "not given"]:
            of = "" if names == [need] else f" of {', '.join(names)}"
            yield f"{need} is needed and missing{of}"


def _without_pose(scene: Scene) -> dict[float, str]:
    """The instants of a scene that have none, each with the reason."""
    found = {}
    for time in scene.instants.tolist():
        try:
            reference_instant(scene, inputs_at(scene, time))
        except InfeasibleError as error:
            found[time] = str(error)
    return found


def _disagreement(scene: Scene, outcome: Outcome, accuracy: float) -> str:
    other = outcome.solutions[1].formulation
    wrong = sorted(outcome.disagreements, key=lambda row: -row.share)
    agree = sum(row.verdict == "agrees" for row in outcome.rows)
    lines = [
        f"{WHO} disagree with {other} in {outcome.scene!r}: {len(wrong)} of {len(wrong) + agree} numbers "
        f"that are tested are off by more than an accuracy of {accuracy:g} mm makes of them",
        *(f"  {told_row(row)}" for row in wrong[:MOST_ROWS]),
    ]
    if len(wrong) > MOST_ROWS:
        lines.append(f"  and {len(wrong) - MOST_ROWS} more")
    explained = explain_outcome(scene, outcome)[:MOST_EXPLANATIONS]
    lines += [f"  what would explain it: {one.words}" for one in explained]
    lines += [f"  note: {note}" for note in outcome.notes]
    return "\n".join(lines)


def _nothing(outcome: Outcome) -> str:
    asked = ", ".join(dict.fromkeys(row.quantity for row in outcome.rows))
    lines = [f"{WHO} hold nothing that {outcome.scene!r} asks for: {asked}"]
    if any(row.verdict == "agrees" for row in outcome.rows) or outcome.faults:
        lines = [f"{WHO} say nothing of {outcome.scene!r}: {outcome.why_no_verdict}"]
    return "\n".join([*lines, *(f"  note: {note}" for note in outcome.notes)])
