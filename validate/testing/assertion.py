"""Assertions for tests of a solver: its numbers agree within tolerances that follow from its stated accuracy,
and it gives no numbers at instants without a pose.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pointcoord import PointcoordError, Scene
from pointcoord.wording import meant
from validate.comparison.compare import Outcome, compare
from validate.comparison.given import given
from validate.diagnosis import explain_outcome
from validate.errors import UsageError
from validate.formulations.protocol import Formulation, FormulationError, Solution
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.output.report import about, told_row
from validate.reference import InfeasibleError, NoReferenceError
from validate.solvers.check import ACCURACY, AGAINST, required_accuracy
from validate.solvers.plain import PlainSolver, as_function, given_to_solver

WHO = "the answer"
# Errors that concern the arguments of a test; any other error is a defect of this package.
TOLD = (AssertionError, PointcoordError, FormulationError, NoReferenceError, UsageError)
MOST_ROWS, MOST_EXPLANATIONS = 8, 3  # in a message; the number of further rows is stated


class NotTested(AssertionError):
    """No number disagrees, but for some of the given numbers the stated accuracy gives no tolerance.

    Attributes:
        scene: name of the scene.
        accuracy: stated accuracy, mm.
        numbers: the numbers that are not tested, in words.
        agree: number of rows that agree.
    """

    def __init__(self, scene: str, accuracy: float, numbers: Sequence[str], agree: int) -> None:
        self.scene = scene
        self.accuracy = accuracy
        self.numbers = tuple(numbers)
        self.agree = agree
        super().__init__(
            f"not tested in {scene!r}: {', '.join(numbers)}; an accuracy of {accuracy:g} mm gives no "
            f"tolerance, because the scene is too near a singular pose ({agree} others agree); state a finer "
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
    """Compare numbers with a formulation; the tolerance of each follows from the stated accuracy.

    Args:
        states: the answer of a solver, any part of what the scene asks for, by quantity and name (see
            `solvers.plain`).
        scene: the scene that was solved, or its name or path.
        accuracy: accuracy of every point as the solver states it, mm.
        against: a formulation or its name, or a solution of this scene, such as the reference's.
        needed: names of quantities, such as "velocity", or of numbers of the car, such as "camber", that must
            be given completely, as far as the scene asks for them. All others may be missing.
    Returns:
        All comparisons; its notes name the numbers that are given but that the scene does not ask for.
    Raises:
        AssertionError: a number disagrees, or only points that stay where they are drawn are given. The
            message states the number, the difference, the tolerance, the instant and possible explanations.
            Also raised for a wrong shape, a misspelt name or a missing number that is `needed`, which a
            comparison would ignore.
        NotTested: the accuracy gives no tolerance for some of the numbers, and none disagrees.
        UsageError: `accuracy` is not a length above 0.
        FormulationError: `states` is not a mapping, or the other formulation refuses the scene.
        SceneError: the scene does not exist or is wrong.

    >>> assert_agrees({"camber": [0.0] * 131}, "bounce")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    AssertionError: the answer disagrees with pointcoord in 'bounce': ...
    """
    __tracebackhide__ = True
    exact = required_accuracy(accuracy)
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    name = scene if isinstance(scene, str) else taken.title or "the scene"
    outcome = compare(taken, PlainSolver(WHO, lambda _: states, exact), against, name)
    if faults := (*outcome.faults, *_missing(outcome, needed)):
        raise AssertionError("; ".join(faults))
    if outcome.disagreements:
        raise AssertionError(_disagreement(taken, outcome, exact))
    untested = [about(row.quantity, row.name) for row in outcome.rows if row.verdict == "not tested"]
    agree = sum(row.verdict == "agrees" for row in outcome.rows)
    if untested:
        raise NotTested(outcome.scene, exact, untested, agree)
    if not outcome.passed:
        asked = ", ".join(dict.fromkeys(row.quantity for row in outcome.rows))
        line = f"{WHO} gives no verdict for {name!r}: {outcome.why_no_verdict}; asked for: {asked}"
        raise AssertionError("\n".join([line, *(f"  note: {note}" for note in outcome.notes)]))
    return outcome


def assert_refuses(
    solver: object, scene: Scene | str, raises: type[Exception] | tuple[type[Exception], ...] = Exception
) -> None:
    """Check that a solver gives no answer at the instants at which a scene has no pose.

    The solver may raise an error, leave these instants out, or give NaN for at least one number at each of
    them. The reference proves that there is no pose.

    Args:
        solver: a function of one mapping, or an object or class with a method `solve` (see `solvers.plain`).
        scene: a scene with instants that have no pose, or its name or path.
        raises: the errors that count as a refusal; other errors are not caught.
    Raises:
        AssertionError: all numbers at such an instant are finite, the answer cannot be used or contains no
            requested number, or every instant of the scene has a pose.
        UsageError: `solver` is not a solver.
        SceneError: the scene does not exist or is wrong.
    """
    __tracebackhide__ = True
    function = as_function(solver, "the solver")
    taken = Scene.load(scene) if isinstance(scene, str) else scene
    name = scene if isinstance(scene, str) else taken.title or "the scene"
    without = _without_pose(taken)
    if not without:
        raise AssertionError(f"every instant of {name!r} has a pose; compare the numbers by assert_agrees")
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
    if side.faults:
        raise AssertionError("; ".join(side.faults))
    arrays = [array for part in side.numbers.values() for array in part.values()]
    if not arrays:
        raise AssertionError(f"the solver gives nothing that {name!r} asks for")
    finite = np.all([np.isfinite(a.reshape(len(a), -1)).all(axis=-1) for a in arrays], axis=0)
    answered = [time for time in side.times[finite].tolist() if time in without]
    if answered:
        raise AssertionError(
            f"the solver answers {name!r} at t = {answered[0]:.9g} s, where there is no pose: "
            f"{without[answered[0]]}; it should raise an error there, or give NaN"
        )


def _missing(outcome: Outcome, needed: Collection[str]) -> Iterator[str]:
    """One line for each name in `needed` of which numbers are missing."""
    for need in needed:
        rows = [row for row in outcome.rows if need in (row.quantity, row.name)]
        if not rows:
            known = dict.fromkeys(word for row in outcome.rows for word in (row.quantity, row.name))
            yield f"{need!r} is needed, but the scene does not ask for it{meant(str(need), known)}"
        elif names := [row.name for row in rows if row.verdict == "not given"]:
            of = "" if names == [need] else f" of {', '.join(names)}"
            yield f"{need} is needed, but {WHO} gives none{of}"


def _without_pose(scene: Scene) -> dict[float, str]:
    """The instants of a scene that have no pose, each with the reason."""
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
        f"{WHO} disagrees with {other} in {outcome.scene!r}: {len(wrong)} of {len(wrong) + agree} tested "
        f"numbers are off by more than the tolerances that follow from an accuracy of {accuracy:g} mm",
        *(f"  {told_row(row)}" for row in wrong[:MOST_ROWS]),
    ]
    if len(wrong) > MOST_ROWS:
        lines.append(f"  and {len(wrong) - MOST_ROWS} more")
    explained = explain_outcome(scene, outcome)[:MOST_EXPLANATIONS]
    lines += [f"  possible explanation: {one.words}" for one in explained]
    lines += [f"  note: {note}" for note in outcome.notes]
    return "\n".join(lines)
