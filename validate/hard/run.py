"""Running cases: every value of the parameter is tried, whatever the ones before came to."""

from __future__ import annotations

import multiprocessing
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace

from validate.extras import MissingPackage
from validate.formulations.registry import formulation
from validate.hard.case import (
    OURS,
    REFUSED,
    RIGHT_OR_REFUSED,
    Answer,
    Case,
    Expected,
    Trial,
    unexpected,
    wrong_without_warning,
)

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
        return tuple(
            (trial.value, answer) for trial in self.trials for answer in unexpected(self.case, trial)
        )

    @property
    def wrong(self) -> tuple[tuple[float, Answer], ...]:
        """Wrong numbers without a warning, but for the printed formulas, each with its value."""
        return tuple(
            (trial.value, answer) for trial in self.trials for answer in wrong_without_warning(trial)
        )


def examine(case: Case) -> Examined:
    """Try all values of a case; a few of them by a map of the inputs too, whatever the case itself tries.

    Raises:
        MissingPackage: a formulation of the case is not installed.
    """
    began = time.perf_counter()
    chosen = _few(case.values)
    trials = tuple(_also_by_map(case, _tried(case, value), value in chosen) for value in case.values)
    if any(answer.formulation == MAP for trial in trials for answer in trial.answers):
        case = replace(case, expected={**case.expected, MAP: _of_map(case)})
    return Examined(case, trials, time.perf_counter() - began)


def _few(values: Sequence[float]) -> tuple[float, ...]:
    """The one amid them and the last: each map takes longer than all else that a scene is tried by."""
    return (values[len(values) // 2], values[-1])


def _of_map(case: Case) -> Expected:
    """A map may be refused, its effort being bounded; it answers only where the other method may."""
    return RIGHT_OR_REFUSED if "right" in case.expected[OURS].outcomes else REFUSED


def _also_by_map(case: Case, trial: Trial, chosen: bool) -> Trial:
    """The trial with what a map of the inputs answers, where that is to be tried and can be judged."""
    if not chosen or trial.judge is None or OURS not in case.expected or MAP in case.expected:
        return trial
    return replace(trial, answers=(*trial.answers, trial.judge(MAP)))


def _tried(case: Case, value: float) -> Trial:
    try:
        return case.examine(value)
    except MissingPackage:
        raise
    # A trial that fails says nothing of the formulations; it is counted, and the run goes on.
    except Exception as error:
        reason = f"the trial fails: {type(error).__name__}: {' '.join(str(error).split())}"
        return Trial(value, tuple(Answer(name, "unjudged", reason) for name in case.expected))


def run(cases: Sequence[Case], done: Callable[[Examined], None], workers: int = 1) -> tuple[Examined, ...]:
    """Examine cases one after the other; each is handed over as soon as it and all before it are done.

    Args:
        workers: processes; a case is examined in one of them.
    """
    results = []
    for result in map(examine, cases) if workers == 1 else _examined_elsewhere(cases, workers):
        done(result)
        results.append(result)
    return tuple(results)


def _examined_elsewhere(cases: Sequence[Case], workers: int) -> Iterator[Examined]:
    """Cases of the catalogue, examined by other processes, which find them by their names.

    Raises:
        MissingPackage: a formulation of the cases is not installed.
    """
    # Found out here, where it can be said in a line.
    for name in dict.fromkeys(name for case in cases for name in case.expected):
        formulation(name)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        waiting = [pool.submit(_examine_named, case.name) for case in cases]
        try:
            for case, future in zip(cases, waiting, strict=True):
                found = future.result()
                yield Examined(replace(case, expected=found.expected), found.trials, found.seconds)
        finally:
            pool.shutdown(cancel_futures=True)


@dataclass(frozen=True)
class _Found:
    """What a process sends back: all of `Examined` but functions."""

    expected: Mapping[str, Expected]
    trials: tuple[Trial, ...]
    seconds: float


def _examine_named(name: str) -> _Found:
    # Imported here: the catalogue's cases are made of what this module runs.
    from validate.hard.catalogue import chosen

    result = examine(*chosen([name]))
    trials = tuple(replace(trial, judge=None) for trial in result.trials)
    return _Found(result.case.expected, trials, result.seconds)


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
