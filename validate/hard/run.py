"""Runs hard cases one after the other, and counts their outcomes."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from pointcoord import MissingLibrary
from validate.hard.answer import Answer, Outcome, Trial, said
from validate.hard.case import Case

ValueAndAnswer = tuple[float, Answer]


@dataclass(frozen=True)
class Examined:
    """A case with its trials, in the order of its values, and their run time, s.

    Its methods return answers as pairs with the value of the parameter.
    """

    case: Case
    trials: tuple[Trial, ...]
    seconds: float

    def answers(self, formulation: str = "") -> tuple[ValueAndAnswer, ...]:
        """The answers of a formulation, or of all."""
        return tuple(
            (t.value, a) for t in self.trials for a in t.answers if formulation in ("", a.formulation)
        )

    @property
    def unexpected(self) -> tuple[ValueAndAnswer, ...]:
        """Answers that the case does not allow."""
        return tuple((trial.value, one) for trial in self.trials for one in self.case.unexpected(trial))

    @property
    def wrong(self) -> tuple[ValueAndAnswer, ...]:
        """Wrong numbers without a warning."""
        return tuple((value, one) for value, one in self.answers() if one.outcome == "wrong")


def examine(case: Case) -> Examined:
    """Solve a case at all its values.

    Raises:
        MissingLibrary: a formulation of the case is not installed.
    """
    began = time.perf_counter()
    trials = tuple(tried(case, value) for value in case.values)
    return Examined(case, trials, time.perf_counter() - began)


def tried(case: Case, value: float) -> Trial:
    """Solve a case at one value. An error of the trial itself makes all its answers unjudged; the run
    continues.

    Raises:
        MissingLibrary: a formulation of the case is not installed.
    """
    try:
        return case.examine(value)
    except MissingLibrary:
        raise
    except Exception as error:
        reason = f"the trial fails: {said(error)}"
        return Trial(value, tuple(Answer(name, "unjudged", reason) for name in case.expected))


def run(cases: Sequence[Case], done: Callable[[Examined], None]) -> tuple[Examined, ...]:
    """Examine cases one after the other; `done` is called with each as soon as it is finished."""
    results = []
    for case in cases:
        results.append(examine(case))
        done(results[-1])
    return tuple(results)


def counts(results: Iterable[Examined]) -> dict[str, Counter[Outcome]]:
    """Numbers of answers by formulation and outcome."""
    found: dict[str, Counter[Outcome]] = {}
    for _, answer in (one for result in results for one in result.answers()):
        found.setdefault(answer.formulation, Counter())[answer.outcome] += 1
    return found


def as_expected(results: Iterable[Examined]) -> bool:
    """Whether no answer is unexpected, and none is wrong without a warning."""
    return not any(result.unexpected or result.wrong for result in results)
