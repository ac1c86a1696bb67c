"""One scene, solved by several formulations, each once, and compared in pairs."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pointcoord import MotionTooLong, MotionTooRough, Scene, SceneError
from validate.closed_drawing import closing_data, closing_of, warnings_of
from validate.comparison.compare import Outcome, compare
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


class Once:
    """A formulation that solves a scene once, and gives the same answer or the same refusal again."""

    def __init__(self, inner: Formulation) -> None:
        self._inner = inner
        self.asked: Scene | None = None
        self.answer: Solution | Exception | None = None

    @property
    def name(self) -> str:
        """Name of the formulation."""
        return self._inner.name

    def solve(self, scene: Scene) -> Solution:
        """Solve the scene, or repeat what came of it.

        Raises:
            Exception: whatever the formulation raised.
        """
        self.ask(scene)
        if isinstance(self.answer, Exception):
            raise self.answer
        assert self.answer is not None  # it was asked
        return self.answer

    def ask(self, scene: Scene) -> None:
        """Solve the scene unless that was tried, and keep what came of it."""
        if self.answer is None:
            self.asked = scene
            self.answer = self._tried(scene)

    def _tried(self, scene: Scene) -> Solution | Exception:
        try:
            return self._inner.solve(scene)
        except MemoryError as error:
            # Its traceback holds on to what filled the memory.
            return MemoryError(str(error))
        # A defect of one formulation must not end the run: it is recorded, and the status says so.
        except Exception as error:
            return error


def examine(
    name: str,
    scene: Scene,
    pairs: Sequence[tuple[str, str]],
    printed: bool,
    factor: float = 1.0,
    others: Mapping[str, Formulation] | None = None,
) -> Examined:
    """Compare a scene in pairs of formulations.

    Args:
        name: what the user calls the scene.
        pairs: names of formulations.
        printed: whether the first formulation is compared with the paper's printed formulas too.
        factor: how many times the derived tolerance to hold differences to.
        others: formulations by names of their own, beside those that there are.
    """
    names = list(dict.fromkeys(name for pair in pairs for name in pair))
    own = others or {}
    once = {name: Once(own[name] if name in own else formulation(name)) for name in names}
    outcomes: list[Outcome] = []
    refusals: dict[str, Refusal] = {}
    failures: list[Failure] = []
    for first, second in pairs:
        found = _compared(scene, name, once[first], once[second], factor)
        if isinstance(found, Outcome):
            outcomes.append(found)
        elif isinstance(found, FormulationError):
            refusals[found.formulation] = refusal_of(found.formulation, found.reason, scene)
        elif not any(found is one.answer for one in once.values()):
            failures.append(failure_of(f"the comparison of {first} with {second}", found))
        if any(_failed(one) for one in once.values()):
            break  # a scene that fills the memory once would do so again, after a long time
    refusals |= {one.name: r for one in once.values() if (r := _refusal(one, name, scene)) is not None}
    against, unprinted = None, None
    if printed and PRINTED not in once and isinstance(once[names[0]].answer, Solution):
        formulas = Once(formulation(PRINTED))
        found = _compared(scene, name, once[names[0]], formulas, factor)
        against = found if isinstance(found, Outcome) else None
        unprinted = _refusal(formulas, name, scene)
    moved = closing_of(scene)
    return Examined(
        name=shown(name),
        title=shown(scene.title),
        outcomes=tuple(outcomes),
        printed=against,
        refusals=tuple(refusals[one] for one in names if one in refusals),
        failures=(
            *failures,
            *(
                failure_of(one.name, one.answer)
                for one in once.values()
                if isinstance(one.answer, Exception) and one.name not in refusals
            ),
        ),
        unprinted=unprinted,
        solved=tuple(
            one.name for one in once.values() if isinstance(one.answer, Solution) and one.name not in refusals
        ),
        advice=_advice(once.values()),
        warnings=warnings_of(scene, moved),
        closing=closing_data(moved),
        defaults=scene.mechanism.defaults_taken,
    )


def _compared(scene: Scene, name: str, first: Once, second: Once, factor: float) -> Outcome | Exception:
    """The comparison of a pair, or why there is none; where one of them refuses, both were asked."""
    try:
        return compare(scene, first, second, shown(name), factor)
    except Exception as error:
        if first.asked is not None and not _failed(first):
            second.ask(first.asked)
        return error


def _refusal(one: Once, name: str, scene: Scene) -> Refusal | None:
    error = one.answer
    if isinstance(error, SceneError):
        named = SceneError(shown(name), error.key, error.problem, error.allowed)
        return refusal_of(one.name, named, scene)
    if isinstance(error, FormulationError):
        return refusal_of(one.name, error.reason, scene)
    return None


def _failed(one: Once) -> bool:
    return isinstance(one.answer, Exception) and not isinstance(one.answer, SceneError | FormulationError)


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


def _advice(tried: Iterable[Once]) -> str:
    """The method newton, which some refusals advise, under its name here."""
    reasons = (one.answer.reason for one in tried if isinstance(one.answer, FormulationError))
    return NEWTON if any(isinstance(reason, MotionTooLong | MotionTooRough) for reason in reasons) else ""
