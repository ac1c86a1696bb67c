"""Running cases: every value of the parameter is tried, whatever the ones before came to."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from validate.extras import MissingPackage
from validate.formulations.protocol import Solution
from validate.hard.answer import Answer
from validate.hard.case import MAP, Case
from validate.hard.trial import NOT_ASKED, Trial, asked_reference, compared, said, solved
from validate.reference import InfeasibleError


@dataclass(frozen=True)
class Examined:
    """A case with its trials, in the order of its values, and how long they took, s."""

    case: Case
    trials: tuple[Trial, ...]
    seconds: float

    def answers(self, formulation: str) -> tuple[tuple[float, Answer], ...]:
        """What a formulation answered, each with the value of the parameter."""
        return tuple((t.value, a) for t in self.trials for a in t.answers if a.formulation == formulation)

    @property
    def unexpected(self) -> tuple[tuple[float, Answer], ...]:
        """Answers that the case does not allow, each with its value."""
        return tuple((trial.value, one) for trial in self.trials for one in self.case.unexpected(trial))

    @property
    def wrong(self) -> tuple[tuple[float, Answer], ...]:
        """Wrong numbers without a warning, but for the printed formulas, each with its value."""
        return tuple((trial.value, one) for trial in self.trials for one in trial.wrong)


def examine(case: Case) -> Examined:
    """Try all values of a case; a few of them by a map of the inputs too.

    Raises:
        MissingPackage: a formulation of the case is not installed.
    """
    began = time.perf_counter()
    trials = tuple(tried(case, value) for value in case.values)
    return Examined(case, trials, time.perf_counter() - began)


def tried(case: Case, value: float) -> Trial:
    """A value tried, by a map too if it is one of the few.

    Raises:
        MissingPackage: a formulation of the case is not installed.
    """
    try:
        trial = case.examine(value)
    except MissingPackage:
        raise
    # A trial that fails says nothing of the formulations; it is counted, and the run goes on.
    except Exception as error:
        reason = f"the trial fails: {said(error)}"
        return Trial(value, tuple(Answer(name, "unjudged", reason) for name in case.expected))
    if trial.scene is None or value not in case.mapped:
        return trial
    came, reference = solved(MAP, trial.scene), trial.reference
    if isinstance(came, Solution) and reference is NOT_ASKED:
        reference = asked_reference(trial.scene)
    # Without a reference, or a proof that there is no pose, nothing can be compared.
    if reference is not NOT_ASKED and not isinstance(reference, Solution | InfeasibleError):
        return trial
    by_map = compared(trial.scene, MAP, came, reference)
    return replace(trial, answers=(*trial.answers, by_map))


def run(cases: Sequence[Case], done: Callable[[Examined], None]) -> tuple[Examined, ...]:
    """Examine cases one after the other; each is handed over as soon as it is done."""
    results = []
    for case in cases:
        results.append(examine(case))
        done(results[-1])
    return tuple(results)


def counts(results: Iterable[Examined]) -> dict[str, Counter[str]]:
    """How often each formulation came to each outcome."""
    found: dict[str, Counter[str]] = {}
    for result in results:
        for answer in (answer for trial in result.trials for answer in trial.answers):
            found.setdefault(answer.formulation, Counter())[answer.outcome] += 1
    return found


def as_expected(results: Iterable[Examined]) -> bool:
    """Whether no answer is unexpected, and none is wrong without a warning."""
    return not any(result.unexpected or result.wrong for result in results)
