"""Running cases: every value of the parameter is tried, whatever the ones before came to."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from validate.extras import MissingPackage
from validate.hard.answer import Answer
from validate.hard.case import REFUSED, RIGHT_OR_REFUSED, Case, Expected
from validate.hard.trial import OURS, Trial, said

# Every case that pointcoord has to solve is tried by a map of the inputs too.
MAP = "pointcoord-map"


@dataclass(frozen=True)
class Examined:
    """A case with its trials, in the order of its values, and how long they took, s."""

    case: Case
    trials: tuple[Trial, ...]
    seconds: float

    def answers(self, formulation: str) -> tuple[tuple[float, Answer], ...]:
        """What a formulation answered, each with the value of the parameter."""
        return tuple((t.value, a) for t in self.trials for a in t.answers if a.formulation == formulation)

    def gives_up(self, formulation: str) -> tuple[int, Answer] | None:
        """The first refusal going in, with its place among the values; None if there is none."""
        given = enumerate(answer for _, answer in self.answers(formulation))
        return next(((i, answer) for i, answer in given if answer.outcome == "refused"), None)

    @property
    def unexpected(self) -> tuple[tuple[float, Answer], ...]:
        """Answers that the case does not allow, each with its value."""
        return tuple((trial.value, one) for trial in self.trials for one in self.case.unexpected(trial))

    @property
    def wrong(self) -> tuple[tuple[float, Answer], ...]:
        """Wrong numbers without a warning, but for the printed formulas, each with its value."""
        return tuple((trial.value, one) for trial in self.trials for one in trial.wrong)


def examine(case: Case) -> Examined:
    """Try all values of a case; a few of them by a map of the inputs too, whatever the case itself tries.

    Raises:
        MissingPackage: a formulation of the case is not installed.
    """
    began = time.perf_counter()
    trials = [tried(case, number) for number in range(len(case.values))]
    return examined(case, trials, time.perf_counter() - began)


def tried(case: Case, number: int) -> Trial:
    """The value of a number tried, by a map too if it is one of the few.

    Raises:
        MissingPackage: a formulation of the case is not installed.
    """
    value = case.values[number]
    try:
        trial = case.examine(value)
    except MissingPackage:
        raise
    # A trial that fails says nothing of the formulations; it is counted, and the run goes on.
    except Exception as error:
        reason = f"the trial fails: {said(error)}"
        return Trial(value, tuple(Answer(name, "unjudged", reason) for name in case.expected))
    # The value amid them and the last: each map takes longer than all else that a scene is tried by.
    few = (case.values[len(case.values) // 2], case.values[-1])
    by_map = OURS in case.expected and MAP not in case.expected and value in few
    if trial.tried is None or not trial.tried.judges or not by_map:
        return trial
    return replace(trial, answers=(*trial.answers, trial.tried.answer(MAP)))


def examined(case: Case, trials: Sequence[Trial], seconds: float) -> Examined:
    """A case with its trials.

    A map may be refused, its effort being bounded; it answers only where the other method may.
    """
    if any(answer.formulation == MAP for trial in trials for answer in trial.answers):
        of_map: Expected = RIGHT_OR_REFUSED if "right" in case.expected[OURS].outcomes else REFUSED
        case = replace(case, expected={**case.expected, MAP: of_map})
    return Examined(case, tuple(trials), seconds)


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
        for trial in result.trials:
            for answer in trial.answers:
                found.setdefault(answer.formulation, Counter())[answer.outcome] += 1
    return found


def refusals(results: Iterable[Examined], formulation: str) -> Counter[str]:
    """How often a formulation refused, by the kind of error that its reason begins with."""
    given = (answer for result in results for _, answer in result.answers(formulation))
    return Counter(answer.reason.partition(":")[0] for answer in given if answer.outcome == "refused")


def as_expected(results: Iterable[Examined]) -> bool:
    """Whether no answer is unexpected, and none is wrong without a warning."""
    return not any(result.unexpected or result.wrong for result in results)
