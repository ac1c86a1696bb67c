"""Examined cases as text for people and as plain data for machines."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any, get_args

from validate.hard.answer import Outcome
from validate.hard.case import Case
from validate.hard.run import MAP, Examined, as_expected, counts, refusals
from validate.hard.trial import OURS
from validate.output.table import Part, Table

OUTCOMES: tuple[Outcome, ...] = get_args(Outcome)
SHORT = 90  # characters of a reason in a table
# Those that are held against ours where they give up.
OTHERS = ("absolute", "relative")


# What nothing has to be said of.
PLAIN = {"reference": "answers"}


def listing(cases: Sequence[Case]) -> str:
    """Names and reasons of cases, under the headings of their groups."""
    lines: list[str] = []
    for before, case in zip((None, *cases), cases, strict=False):
        if before is None or before.group != case.group:
            lines += ["", case.group] if lines else [case.group]
        lines.append(f"  {case.name}: {case.why}")
    return "\n".join(lines)


def case_parts(result: Examined, every_value: bool = False) -> tuple[Part, ...]:
    """What came of a case: a row per formulation, and per value as well if asked for."""
    case, values = result.case, result.case.values
    lines: list[Part] = [
        f"{case.name}: {case.why}",
        f"  parameter: {case.parameter}, {_span(values)}",
        f"  expected: {case.behaviour}",
        Table(_head(case), tuple(_row(result, name) for name in case.expected), indent=2),
        *(f"  {line}" for line in _who_gives_up_first(result)),
    ]
    if every_value:
        lines.append(Table(_VALUE_HEAD, tuple(_value_rows(result)), indent=2))
        lines += [f"  at {t.value:g}: {_facts(t.facts)}" for t in result.trials if t.facts != PLAIN]
    lines += [
        f"  NOT AS EXPECTED: {answer.formulation} is {answer.outcome} at {value:g}: {answer.reason}"
        for value, answer in result.unexpected
    ]
    return tuple(lines)


def _span(values: Sequence[float]) -> str:
    ends = f"{values[0]:g} to {values[-1]:g}, " if len(values) > 1 else f"{values[0]:g}, "
    return ends + numbered(len(values), "value")


def _head(case: Case) -> tuple[str, ...]:
    sizes = f"error [{case.unit}]", f"bound [{case.unit}]"
    return ("formulation", "tried", *OUTCOMES, *sizes, "of its bound", "condition", "verdict")


def _row(result: Examined, name: str) -> tuple[str, ...]:
    given = result.answers(name)
    outcomes = Counter(answer.outcome for _, answer in given)
    sizes = ("error", "bound", "share", "condition")
    largest = (_largest([getattr(a, what) for _, a in given]) for what in sizes)
    other = any(answer.formulation == name for _, answer in result.unexpected)
    verdict = "NOT as expected" if other else "as expected"
    stop = result.gives_up(name)
    if stop is not None:
        verdict += f"; gives up at {given[stop[0]][0]:g}: {short(stop[1].reason)}"
    return (name, str(len(given)), *(str(outcomes[o] or ".") for o in OUTCOMES), *largest, verdict)


def _largest(numbers: Sequence[float | None]) -> str:
    known = [number for number in numbers if number is not None]
    return _digits(max(known)) if known else "-"


def _digits(number: float) -> str:
    """Two digits; what is just below 1, as a share of a bound may be, is not rounded up to it."""
    return "0.99" if 0.99 < number < 1.0 else f"{number:.2g}"


def numbered(count: int, noun: str) -> str:
    """A count with its noun: 1 case, 2 cases."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def short(reason: str) -> str:
    """The beginning of a reason, for a table."""
    return reason if len(reason) <= SHORT else reason[: SHORT - 3] + "..."


def _who_gives_up_first(result: Examined) -> list[str]:
    return [
        line
        for other in OTHERS
        if {OURS, other} <= result.case.expected.keys()
        for line in _which_gives_up_first(result, other)
    ]


def _which_gives_up_first(result: Examined, other: str) -> list[str]:
    places = [math.inf if (stop := result.gives_up(name)) is None else stop[0] for name in (OURS, other)]
    if places[0] == places[1]:
        return []
    earlier, later = (OURS, other) if places[0] < places[1] else (other, OURS)
    first, last = int(min(places)), max(places)
    rest = "never gives up" if last == math.inf else f"gives up at {result.trials[int(last)].value:g}"
    return [f"{earlier} gives up at {result.trials[first].value:g}, before {later}, which {rest}."]


_VALUE_HEAD = ("value", "formulation", "outcome", "error", "bound", "of its bound", "condition", "verdict")


def _value_rows(result: Examined) -> Iterable[tuple[str, ...]]:
    for trial in result.trials:
        for a in trial.answers:
            numbers = ("-" if x is None else _digits(x) for x in (a.error, a.bound, a.share, a.condition))
            yield f"{trial.value:g}", a.formulation, a.outcome, *numbers, short(a.reason)


def _facts(facts: Any) -> str:
    return ", ".join(f"{k}: {v:.6g}" if isinstance(v, float) else f"{k}: {v}" for k, v in facts.items())


def times_parts(results: Sequence[Examined]) -> tuple[Part, ...]:
    """How long each case took, the longest first."""
    longest = sorted(results, key=lambda result: -result.seconds)
    rows = [(r.case.name, str(len(r.trials)), f"{r.seconds:.2f}", _most(r)) for r in longest]
    total = sum(result.seconds for result in results)
    return Table(("case", "scenes", "seconds", "s a scene"), tuple(rows)), f"{total:.1f} s in all."


def _most(result: Examined) -> str:
    return f"{result.seconds / max(len(result.trials), 1):.3f}"


def summary_parts(results: Sequence[Examined]) -> tuple[Part, ...]:
    """Counts over all cases, and the verdict."""
    rows = [
        (name, str(sum(found.values())), *(str(found[o] or ".") for o in OUTCOMES))
        for name, found in counts(results).items()
    ]
    trials = sum(len(result.trials) for result in results)
    lines: list[Part] = [
        f"{numbered(len(results), 'case')}, {numbered(trials, 'scene')}:",
        Table(("formulation", "answers", *OUTCOMES), tuple(rows)),
    ]
    refused = refusals(results, MAP)
    if refused:
        kinds = ", ".join(f"{count} {kind}" for kind, count in refused.most_common())
        lines.append(f"Refused by the map, whose effort is bounded here: {kinds}.")
    wrong = sum(len(result.wrong) for result in results)
    other = [result for result in results if result.unexpected or result.wrong]
    if as_expected(results):
        verdict = "All as expected: but for the formulas as printed, no number is wrong without a warning"
    else:
        verdict = (
            f"NOT as expected: {numbered(sum(len(r.unexpected) for r in other), 'answer')}, "
            f"{wrong} wrong without a warning, in {', '.join(result.case.name for result in other)}"
        )
    lines.append(f"{verdict}{_not_judged(results)}.")
    return tuple(lines)


def _not_judged(results: Sequence[Examined]) -> str:
    """The end of the verdict where some answers could not be held to a reference."""
    found = {
        result.case.name: sum(a.outcome == "unjudged" for trial in result.trials for a in trial.answers)
        for result in results
    }
    cases = [name for name, count in found.items() if count]
    return f"; {numbered(sum(found.values()), 'answer')} not judged, in {', '.join(cases)}" if cases else ""


def listing_data(cases: Sequence[Case]) -> dict[str, Any]:
    """What cases are and what is expected of them, as plain data; none of them tried."""
    return {"cases": [_description(case) for case in cases]}


def results_data(results: Sequence[Examined]) -> dict[str, Any]:
    """Everything, as plain data: each case with each trial."""
    return {
        "as_expected": as_expected(results),
        "counts": {name: dict(found) for name, found in counts(results).items()},
        "cases": [_case_data(result) for result in results],
    }


def _description(case: Case) -> dict[str, Any]:
    return {
        "name": case.name,
        "group": case.group,
        "why": case.why,
        "parameter": case.parameter,
        "values": list(case.values),
        "unit": case.unit,
        "behaviour": case.behaviour,
        "expected": {name: asdict(one) for name, one in case.expected.items()},
    }


def _case_data(result: Examined) -> dict[str, Any]:
    return {
        **_description(result.case),
        "seconds": result.seconds,
        "trials": [
            {
                "value": trial.value,
                "answers": [asdict(answer) for answer in trial.answers],
                "facts": dict(trial.facts),
            }
            for trial in result.trials
        ],
        "unexpected": [asdict(answer) | {"value": value} for value, answer in result.unexpected],
    }
