"""One scene, solved by several formulations, each once, and compared in pairs."""

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
    """A formulation or a comparison that ended in a way it should not: no memory left, or a defect.

    Attributes:
        formulation: its name, or both names of a pair.
        error: class of the error. message: in its own words, and where it was raised.
    """

    formulation: str
    error: str
    message: str


@dataclass(frozen=True)
class Examined:
    """What came of a scene.

    Attributes:
        name: as the user gave it, in characters that can be shown.
        outcomes: of each pair that both solved.
        printed: the comparison with the formulas as printed, which counts for nothing.
        refusals, failures: of the formulations that the pairs need.
        unprinted: the refusal of the formulas as printed.
        solved: names of the formulations that answered.
        problem: what is wrong with the scene's file, if it was never solved.
        advice: how to follow a hint of a refusal on the command line.
        warnings: what the user should know of the scene, though it is solved.
        closing: how far the points of the drawing move until it closes, as plain data.
        defaults: what the scene leaves to the program, in words.
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
        """What the scene alone would end the run with."""
        found = [outcome.status for outcome in self.outcomes] or [ExitStatus.NO_VERDICT]
        found += [ExitStatus.NOT_FINISHED for _ in self.failures]
        if self.problem is not None:
            found.append(ExitStatus.WRONG_INPUT)
        if self.refusals:
            # Hardpoints that make no mechanism, or another car than is drawn, are the file's fault; but the
            # formulas as printed find fault with sound ones too.
            wrong = any(r.error == SceneError.__name__ and r.formulation != PRINTED for r in self.refusals)
            found.append(ExitStatus.WRONG_INPUT if wrong else ExitStatus.NO_VERDICT)
        return combined(found)

    @property
    def complaint(self) -> str:
        """Why there is no verdict, in one line; empty if there is one."""
        if self.problem is not None:
            return self.problem
        parts = []
        if self.refusals:
            first = self.refusals[0]
            # Such a message begins with what the scene calls itself.
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
    """Compare a scene in pairs of formulations, each of which solves it once.

    Args:
        name: what the user calls the scene.
        pairs: names of formulations.
        printed: whether the first formulation is compared with the paper's printed formulas too.
        factor: how many times the derived tolerance to hold differences to.
        others: formulations by names of their own, beside those that there are.
    """
    solvers = {one: (others or {}).get(one) or formulation(one) for pair in pairs for one in pair}
    answers: dict[str, Solution | Exception] = {}
    for one, solver in solvers.items():
        answers[one] = _answer(solver, scene)
        if _failed(answers[one]):
            break  # a scene that fills the memory once would do so again, after a long time
    refusals = {one: r for one, answer in answers.items() if (r := _refusal(one, answer, name, scene))}
    failures = [failure_of(one, e) for one, e in answers.items() if isinstance(e, Exception) and _failed(e)]
    outcomes: list[Outcome] = []
    for first, second in pairs:
        found = _compared(scene, name, answers.get(first), answers.get(second), factor)
        if isinstance(found, Outcome):
            outcomes.append(found)
        elif isinstance(found, FormulationError):
            refusals[found.formulation] = refusal_of(found.formulation, found.reason, scene)
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
        # The method newton, which some refusals advise, under its name here.
        advice=NEWTON if any(isinstance(one, NotFollowed) for one in reasons) else "",
        warnings=warnings_of(scene, moved),
        closing=closing_data(moved),
        defaults=scene.mechanism.defaults_taken,
    )


def _answer(solver: Formulation, scene: Scene) -> Solution | Exception:
    try:
        return solved_by(solver, scene)
    except MemoryError as error:
        # Its traceback holds on to what filled the memory.
        return MemoryError(str(error))
    # A defect of one formulation must not end the run: it is recorded, and the status says so.
    except Exception as error:
        return error


def _compared(
    scene: Scene,
    name: str,
    first: Solution | Exception | None,
    second: Solution | Exception | None,
    factor: float,
) -> Outcome | Exception | None:
    """The comparison of a pair, or why it fails; None where one of them gives no solution."""
    if not isinstance(first, Solution) or not isinstance(second, Solution):
        return None
    try:
        return compare_solutions(scene, first, second, shown(name), factor=factor)
    except Exception as error:
        return error


def _refusal(who: str, answer: Solution | Exception, name: str, scene: Scene) -> Refusal | None:
    if isinstance(answer, SceneError):
        answer = SceneError(shown(name), answer.key, answer.problem, answer.allowed)
        return refusal_of(who, answer, scene)
    return refusal_of(who, answer.reason, scene) if isinstance(answer, FormulationError) else None


def _failed(answer: Solution | Exception) -> bool:
    return isinstance(answer, Exception) and not isinstance(answer, SceneError | FormulationError)


def failure_of(what: str, error: Exception) -> Failure:
    """The data of an error that nobody planned."""
    return Failure(what, type(error).__name__, told_failure(error))


def told_failure(error: BaseException) -> str:
    """What to say of an error that nobody planned: its words, and where it was raised."""
    if isinstance(error, MemoryError):
        said = f" ({error})" if str(error) else ""
        return f"out of memory{said}; try fewer samples, or fewer effects"
    frames = traceback.extract_tb(error.__traceback__)
    where = f" at {Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else ""
    return f"{' '.join(str(error).split()) or 'no message'}{where}; this is a defect, please report it"
