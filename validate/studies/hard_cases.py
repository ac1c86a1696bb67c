"""`pointcoord study hard`: the hard cases, value by value."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, replace

from validate.exit_status import ExitStatus
from validate.hard.answer import Answer, Trial
from validate.hard.case import Case
from validate.hard.catalogue import chosen
from validate.hard.report import Examined, as_expected, results_data, summary_parts
from validate.studies.study import Findings, Row, Study, Task

ANSWER = {
    **dict.fromkeys(("formulation", "outcome", "reason"), "string"),
    **dict.fromkeys(("error", "bound", "share", "condition"), "float64"),
}


def hard(cases: Sequence[str] = ()) -> Study:
    """The study of hard cases, by name or all: a task is one value of the parameter of one case.

    A row is the answer of one formulation at one value: the value, the fields of `Answer`, and facts as JSON.

    Raises:
        UsageError: there is no such case.
    """
    tasks = [Task(case.name, i) for case in chosen(cases) for i in range(len(case.values))]
    return Study(
        "hard", "scene", {}, {"value": "float64", "facts": "string", **ANSWER}, tasks, answers, found
    )


def answers(task: Task) -> list[Row]:
    """The rows of one value: the answers of every formulation of its case."""
    (case,) = chosen([task.part])
    trial = case.examine(case.values[task.number])
    every = {"value": trial.value, "facts": json.dumps(dict(trial.facts))}
    return [{**every, **asdict(answer)} for answer in trial.answers]


def found(rows: Sequence[Row]) -> Findings:
    """The findings, as `pointcoord hard` prints them for these cases."""
    by_case: dict[str, dict[int, list[Row]]] = {}
    for row in rows:
        by_case.setdefault(row["part"], {}).setdefault(row["number"], []).append(row)
    results = [_examined(case, by_case[case.name]) for case in chosen(()) if case.name in by_case]
    unlike = [
        f"NOT AS EXPECTED: {result.case.name}: {a.formulation} is {a.outcome} at {value:g}: {a.reason}"
        for result in results
        for value, a in dict.fromkeys((*result.unexpected, *result.wrong))
    ]
    status = ExitStatus.AGREE if as_expected(results) else ExitStatus.DISAGREE
    return Findings((*unlike, *summary_parts(results)), results_data(results), status)


def _examined(case: Case, rows: dict[int, list[Row]]) -> Examined:
    """A case with the values and answers that are recorded."""
    values = tuple(case.values[i] for i in rows)
    answers = ([Answer(**{name: row[name] for name in ANSWER}) for row in of] for of in rows.values())
    facts = (json.loads(of[0]["facts"]) for of in rows.values())
    trials = [Trial(value, tuple(of), also) for value, of, also in zip(values, answers, facts, strict=True)]
    seconds = sum(of[0]["seconds"] for of in rows.values())
    return Examined(replace(case, values=values), tuple(trials), seconds)
