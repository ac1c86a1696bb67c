"""Runs hard cases, and reports their results as text and tables to print and as plain data for JSON."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, get_args

from validate.hard.answer import MAP, Answer, Outcome, Trial
from validate.hard.case import Case
from validate.output.table import Part, Table
from validate.plain_text import counted_as, gathered

OUTCOMES: tuple[Outcome, ...] = get_args(Outcome)
SHORT = 90  # characters of a reason in a table
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
    trials = tuple(map(case.examine, case.values))
    return Examined(case, trials, time.perf_counter() - began)


def counts(results: Iterable[Examined]) -> dict[str, Counter[Outcome]]:
    """Numbers of answers by formulation and outcome."""
    answers = ((a.formulation, a.outcome) for result in results for _, a in result.answers())
    return {name: Counter(outcomes) for name, outcomes in gathered(answers).items()}


def as_expected(results: Iterable[Examined]) -> bool:
    """Whether no answer is unexpected, and none is wrong without a warning."""
    return not any(result.unexpected or result.wrong for result in results)


def listing(cases: Sequence[Case]) -> str:
    """Names of cases and why they are hard, under the headings of their groups."""
    groups = gathered((case.group, f"  {case.name}: {case.why}") for case in cases)
    return "\n\n".join("\n".join((group, *lines)) for group, lines in groups.items())


def case_parts(result: Examined, every_value: bool = False) -> tuple[Part, ...]:
    """The results of a case: a row for each formulation, and on request a row for each value."""
    case, values = result.case, result.case.values
    span = f"{values[0]:g}{f' to {values[-1]:g}' * (len(values) > 1)}, {counted_as(len(values), 'value')}"
    sizes = (f"error [{case.unit}]", f"bound [{case.unit}]", "of its bound", "condition")
    rows = []
    for name, found in counts([result]).items():
        given = result.answers(name)
        verdict = (
            "NOT as expected" if any(a.formulation == name for _, a in result.unexpected) else "as expected"
        )
        refused = [f"; first refusal at {v:g}: {short(a.reason)}" for v, a in given if a.outcome == "refused"]
        cells = (*_outcomes(found), *_digits(a for _, a in given), "".join((verdict, *refused[:1])))
        rows.append((name, str(len(given)), *cells))
    parts: list[Part] = [
        f"{case.name}: {case.why}",
        f"  parameter: {case.parameter}, {span}",
        f"  expected: {case.behaviour}",
        Table(("formulation", "tried", *OUTCOMES, *sizes, "verdict"), tuple(rows), indent=2),
    ]
    if every_value:
        each = tuple(
            (f"{value:g}", a.formulation, a.outcome, *_digits([a]), short(a.reason))
            for value, a in result.answers()
        )
        parts.append(Table(("value", "formulation", "outcome", *sizes, "verdict"), each, indent=2))
        facts = ((t.value, ", ".join(f"{k}: {v}" for k, v in t.facts.items())) for t in result.trials)
        parts += [f"  at {value:g}: {words}" for value, words in facts if words]
    unlike = (f"{a.formulation} is {a.outcome} at {value:g}: {a.reason}" for value, a in result.unexpected)
    return (*parts, *(f"  NOT AS EXPECTED: {one}" for one in unlike))


def _outcomes(found: Mapping[Outcome, int]) -> list[str]:
    return [str(found.get(outcome) or ".") for outcome in OUTCOMES]


def _digits(answers: Iterable[Answer]) -> list[str]:
    """The largest error, bound, share and condition; a share just below 1 is not rounded up to 1."""
    columns = zip(*((a.error, a.bound, a.share, a.condition) for a in answers), strict=True)
    most = (max((x for x in column if x is not None), default=None) for column in columns)
    return ["-" if x is None else "0.99" if 0.99 < x < 1.0 else f"{x:.2g}" for x in most]


def short(reason: str) -> str:
    """The beginning of a reason, for a table."""
    return reason if len(reason) <= SHORT else reason[: SHORT - 3] + "..."


def summary_parts(results: Sequence[Examined]) -> tuple[Part, ...]:
    """Counts of the answers over all cases, and the verdict."""
    rows = [(name, str(found.total()), *_outcomes(found)) for name, found in counts(results).items()]
    trials = sum(len(result.trials) for result in results)
    parts: list[Part] = [
        f"{counted_as(len(results), 'case')}, {counted_as(trials, 'scene')}:",
        Table(("formulation", "answers", *OUTCOMES), tuple(rows)),
    ]
    # A reason begins with the class of the error.
    of_map = (a for r in results for _, a in r.answers(MAP) if a.outcome == "refused")
    if refused := Counter(answer.reason.partition(":")[0] for answer in of_map):
        kinds = ", ".join(f"{count} {kind}" for kind, count in refused.most_common())
        parts.append(f"Refused by the map, whose effort is bounded here: {kinds}.")
    verdict = "All as expected: no number is wrong without a warning"
    if other := [result for result in results if result.unexpected or result.wrong]:
        unlike, wrong = (
            sum(map(len, of)) for of in zip(*((r.unexpected, r.wrong) for r in other), strict=True)
        )
        names = ", ".join(result.case.name for result in other)
        verdict = (
            f"NOT as expected: {counted_as(unlike, 'answer')}, {wrong} wrong without a warning, in {names}"
        )
    if unjudged := Counter(r.case.name for r in results for _, a in r.answers() if a.outcome == "unjudged"):
        verdict += f"; {counted_as(unjudged.total(), 'answer')} not judged, in {', '.join(unjudged)}"
    return (*parts, f"{verdict}.")


def listing_data(cases: Sequence[Case]) -> dict[str, Any]:
    """Descriptions of cases and their expected outcomes as plain data, without results."""
    same = ("name", "group", "why", "parameter", "unit", "behaviour")
    found = [
        {name: getattr(case, name) for name in same}
        | {"values": list(case.values)}
        | {"expected": {name: asdict(one) for name, one in case.expected.items()}}
        for case in cases
    ]
    return {"cases": found}


def results_data(results: Sequence[Examined]) -> dict[str, Any]:
    """All cases with all answers as plain data."""
    described = listing_data([result.case for result in results])["cases"]
    cases = [
        {
            **of_case,
            "seconds": result.seconds,
            "trials": [
                {"value": t.value, "answers": [asdict(a) for a in t.answers], "facts": dict(t.facts)}
                for t in result.trials
            ],
            "unexpected": [asdict(answer) | {"value": value} for value, answer in result.unexpected],
        }
        for of_case, result in zip(described, results, strict=True)
    ]
    found = {name: dict(found) for name, found in counts(results).items()}
    return {"as_expected": as_expected(results), "counts": found, "cases": cases}
