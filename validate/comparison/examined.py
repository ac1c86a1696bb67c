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
from validate.formulations.protocol import Formulation, FormulationError, Solution, reason_of
from validate.formulations.refusals import Refusal, refusal_of
from validate.formulations.registry import formulation
from validate.plain_text import shown

NEWTON = " (--first pointcoord-newton)"
PRINTED = "printed"
REFUSED = (SceneError, FormulationError)


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
    solved: dict[str, Solution] = {}
    errors: dict[str, Exception] = {}
    # A defect of one formulation must not end the run: its error is recorded, and the status shows it.
    for one, solver in solvers.items():
        try:
            solved[one] = solved_by(solver, scene)
        except REFUSED as error:
            errors[one] = error
        except Exception as error:
            # The traceback of a MemoryError would keep the memory in use.
            errors[one] = MemoryError(str(error)) if isinstance(error, MemoryError) else error
            break  # a scene that fills the memory would do so again with the next formulation, and take long
    outcomes: list[Outcome] = []
    for first, second in pairs:
        if first not in solved or second not in solved:
            continue
        try:
            outcomes.append(
                compare_solutions(scene, solved[first], solved[second], shown(name), None, factor)
            )
        except FormulationError as error:
            errors[error.formulation] = error
        except Exception as error:
            errors[f"the comparison of {first} with {second}"] = error
    against, unprinted, held = None, None, solved.get(pairs[0][0])
    if printed and PRINTED not in solvers and held is not None:
        try:
            formulas = solved_by(formulation(PRINTED), scene)
            against = compare_solutions(scene, held, formulas, shown(name), factor=factor)
        except Exception as error:
            unprinted = _refusal(PRINTED, error, name, scene)
    refused = {one: error for one, error in errors.items() if isinstance(error, REFUSED)}
    moved = closing_of(scene)
    return Examined(
        name=shown(name),
        title=shown(scene.title),
        outcomes=tuple(outcomes),
        printed=against,
        refusals=tuple(_refusal(one, refused[one], name, scene) for one in solvers if one in refused),
        failures=tuple(
            Failure(one, type(error).__name__, told_failure(error))
            for one, error in errors.items()
            if one not in refused
        ),
        unprinted=unprinted,
        solved=tuple(one for one in solved if one not in refused),
        # Some refusals advise the method newton; this is its name on the command line.
        advice=NEWTON if any(isinstance(reason_of(e), NotFollowed) for e in refused.values()) else "",
        warnings=warnings_of(scene, moved),
        closing=closing_data(moved),
        defaults=scene.mechanism.defaults_taken,
    )


def _refusal(who: str, error: Exception, name: str, scene: Scene) -> Refusal:
    return refusal_of(who, error.of(shown(name)) if isinstance(error, SceneError) else error, scene)


def told_failure(error: BaseException) -> str:
    """The message for an unexpected error: its text, and where it was raised."""
    if isinstance(error, MemoryError):
        said = f" ({error})" if str(error) else ""
        return f"out of memory{said}; try fewer samples, or fewer effects"
    frames = traceback.extract_tb(error.__traceback__)
    where = f" at {Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else ""
    return f"{' '.join(str(error).split()) or 'no message'}{where}; this is a defect, please report it"
