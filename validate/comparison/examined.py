"""Examines one scene: several formulations solve it once each, and are compared in pairs."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pointcoord import NotFollowed, Scene, SceneError
from validate.closed_drawing import closing_data, closing_of, warnings_of
from validate.comparison.compare import Outcome, compare_solutions, solved_by
from validate.exit_status import ExitStatus, combined
from validate.formulations.protocol import Formulation, FormulationError, Solution
from validate.formulations.refusals import Refusal, refusal_of
from validate.formulations.registry import formulation
from validate.plain_text import shown

NEWTON = " (--first pointcoord-newton)"
PRINTED = "printed"


@dataclass(frozen=True)
class Failure:
    """A formulation or a comparison that failed unexpectedly: out of memory, or a defect.

    Attributes:
        formulation: name of the formulation, or both names of a pair.
        error: class of the error.
        message: message of the error, and where it was raised.
    """

    formulation: str
    error: str
    message: str


@dataclass(frozen=True)
class Examined:
    """The results of a scene.

    Attributes:
        name: as the user gave it, in printable characters.
        outcomes: comparison of each pair of formulations that both solved the scene.
        printed: comparison with the paper's printed formulas, which does not count for the verdict.
        refusals, failures: refusals and failures of the formulations in the pairs.
        unprinted: refusal of the printed formulas.
        solved: names of the formulations that solved the scene.
        problem: what is wrong with the file of the scene, if the scene could not be read.
        advice: the command line option that follows a hint of a refusal.
        warnings: warnings on a scene that is solved.
        closing: how far each point of the drawing moves when the drawing is closed, as plain data.
        defaults: the default values that the scene uses, in words.
    """

    name: str
    title: str = ""
    outcomes: tuple[Outcome, ...] = ()
    printed: Outcome | None = None
    refusals: tuple[Refusal, ...] = ()
    failures: tuple[Failure, ...] = ()
    unprinted: Refusal | None = None
    solved: tuple[str, ...] = ()
    problem: str | None = None
    advice: str = ""
    warnings: tuple[str, ...] = ()
    closing: Mapping[str, Any] | None = None
    defaults: tuple[str, ...] = ()

    @property
    def status(self) -> ExitStatus:
        """The exit status of a run of this scene alone."""
        found = [outcome.status for outcome in self.outcomes] or [ExitStatus.NO_VERDICT]
        found += [ExitStatus.NOT_FINISHED for _ in self.failures]
        if self.problem is not None:
            found.append(ExitStatus.WRONG_INPUT)
        if self.refusals:
            # A file is wrong if its hardpoints form no mechanism, or close to a different car than drawn.
            # But the printed formulas refuse sound hardpoints as well.
            wrong = any(r.error == SceneError.__name__ and r.formulation != PRINTED for r in self.refusals)
            found.append(ExitStatus.WRONG_INPUT if wrong else ExitStatus.NO_VERDICT)
        return combined(found)

    @property
    def complaint(self) -> str:
        """Why the scene has no verdict, in one line; empty if it has one."""
        if self.problem is not None:
            return self.problem
        parts = []
        if self.refusals:
            first = self.refusals[0]
            # The message of a SceneError starts with the name of the scene.
            where = f"{self.name}: " if first.error != SceneError.__name__ else ""
            who = _listed([f"{r.formulation} ({r.error})" for r in self.refusals])
            parts.append(f"{where}{first.message}{self.advice}; refused by {who}")
        for failure in self.failures:
            parts.append(f"{self.name}: {failure.formulation} fails: {failure.error}: {failure.message}")
        if parts and self.solved:
            parts.append(f"solved by {_listed(self.solved)}")
        return "; ".join(parts)


def _listed(names: Sequence[str]) -> str:
    return " and ".join((", ".join(names[:-1]), names[-1])) if len(names) > 1 else names[0]


def examine(
    name: str,
    scene: Scene,
    pairs: Sequence[tuple[str, str]],
    printed: bool,
    factor: float = 1.0,
    others: Mapping[str, Formulation] | None = None,
) -> Examined:
    """Compare pairs of formulations on a scene; each formulation solves the scene once.

    Args:
        name: the user's name for the scene.
        pairs: names of formulations.
        printed: whether to compare the first formulation with the paper's printed formulas too.
        factor: factor on the derived tolerances.
        others: further formulations by name, such as the user's solver.
    """
    solvers = {one: (others or {}).get(one) or formulation(one) for pair in pairs for one in pair}
    answers: dict[str, Solution | Exception] = {}
    for one, solver in solvers.items():
        answers[one] = _answer(solver, scene)
        if _failed(answers[one]):
            break  # a scene that fills the memory would do so again with the next formulation, and take long
    refusals = {one: r for one, answer in answers.items() if (r := _refusal(one, answer, name, scene))}
    failures = [failure_of(one, e) for one, e in answers.items() if isinstance(e, Exception) and _failed(e)]
    outcomes: list[Outcome] = []
    for first, second in pairs:
        found = _compared(scene, name, answers.get(first), answers.get(second), factor)
        if isinstance(found, Outcome):
            outcomes.append(found)
        elif isinstance(found, FormulationError):
            refusals[found.formulation] = refusal_of(found.formulation, found, scene)
        elif found:
            failures.insert(0, failure_of(f"the comparison of {first} with {second}", found))
    held, against, unprinted = answers[pairs[0][0]], None, None
    if printed and PRINTED not in solvers and isinstance(held, Solution):
        formulas = _answer(formulation(PRINTED), scene)
        compared = _compared(scene, name, held, formulas, factor)
        against = compared if isinstance(compared, Outcome) else None
        unprinted = _refusal(PRINTED, formulas, name, scene)
    moved, reasons = closing_of(scene), [getattr(answer, "reason", None) for answer in answers.values()]
    return Examined(
        name=shown(name),
        title=shown(scene.title),
        outcomes=tuple(outcomes),
        printed=against,
        refusals=tuple(refusals[one] for one in solvers if one in refusals),
        failures=tuple(failures),
        unprinted=unprinted,
        solved=tuple(n for n, one in answers.items() if isinstance(one, Solution) and n not in refusals),
        # Some refusals advise the method newton; this is its name on the command line.
        advice=NEWTON if any(isinstance(one, NotFollowed) for one in reasons) else "",
        warnings=warnings_of(scene, moved),
        closing=closing_data(moved),
        defaults=scene.mechanism.defaults_taken,
    )


def _answer(solver: Formulation, scene: Scene) -> Solution | Exception:
    try:
        return solved_by(solver, scene)
    except MemoryError as error:
        # A new error: the traceback of the old one would keep the memory in use.
        return MemoryError(str(error))
    # A defect of one formulation must not end the run: the error is recorded, and the status shows it.
    except Exception as error:
        return error


def _compared(
    scene: Scene,
    name: str,
    first: Solution | Exception | None,
    second: Solution | Exception | None,
    factor: float,
) -> Outcome | Exception | None:
    """The comparison of a pair, or the error that it raises; None if one of them has no solution."""
    if not isinstance(first, Solution) or not isinstance(second, Solution):
        return None
    try:
        return compare_solutions(scene, first, second, shown(name), factor=factor)
    except Exception as error:
        return error


def _refusal(who: str, answer: Solution | Exception, name: str, scene: Scene) -> Refusal | None:
    if isinstance(answer, SceneError):
        answer = answer.of(shown(name))
    return refusal_of(who, answer, scene) if isinstance(answer, SceneError | FormulationError) else None


def _failed(answer: Solution | Exception) -> bool:
    return isinstance(answer, Exception) and not isinstance(answer, SceneError | FormulationError)


def failure_of(what: str, error: Exception) -> Failure:
    """The data of an unexpected error."""
    return Failure(what, type(error).__name__, told_failure(error))


def told_failure(error: BaseException) -> str:
    """The message for an unexpected error: its text, and where it was raised."""
    if isinstance(error, MemoryError):
        said = f" ({error})" if str(error) else ""
        return f"out of memory{said}; try fewer samples, or fewer effects"
    frames = traceback.extract_tb(error.__traceback__)
    where = f" at {Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else ""
    return f"{' '.join(str(error).split()) or 'no message'}{where}; this is a defect, please report it"
