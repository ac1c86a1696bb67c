"""The hard cases worked out value by value: `pointcoord study hard`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from validate.exit_status import ExitStatus
from validate.hard.case import Answer, Trial
from validate.hard.catalogue import chosen
from validate.hard.report import results_data, summary_parts
from validate.hard.run import Examined, as_expected, examined, tried
from validate.long_studies.study import Findings, Kind, Number, Row

TEXTS = ("formulation", "outcome", "reason")
SIZES = ("error", "bound", "share", "condition")


@dataclass(frozen=True)
class HardStudy:
    """Hard cases, each value of each one's parameter a number of its own.

    A row of its records is what one formulation answers at one value. Part is the case. Its columns: value of
    the parameter, those of an `Answer`, and facts, what else was measured there, as JSON.

    Attributes:
        cases: by name; all, if none is named.
    """

    cases: tuple[str, ...] = ()

    name = "hard"
    noun = "scene"
    chunk = 1
    columns: ClassVar[Mapping[str, Kind]] = {
        **dict.fromkeys((*TEXTS, "facts"), "string"),
        **dict.fromkeys(("value", *SIZES), "float64"),
    }

    @property
    def settings(self) -> Mapping[str, str | int]:
        """None: the catalogue is part of the program."""
        return {}

    @property
    def numbers(self) -> Sequence[Number]:
        """One for each value.

        Raises:
            UnknownCase: there is no such case.
        """
        return [Number(case.name, i) for case in chosen(self.cases) for i in range(len(case.values))]

    def examine(self, number: Number) -> list[Row]:
        """Try one value by every formulation of its case."""
        (case,) = chosen([number.part])
        trial = tried(case, number.number)
        every = {"value": trial.value, "facts": json.dumps(dict(trial.facts))}
        return [{**every, **{name: getattr(a, name) for name in (*TEXTS, *SIZES)}} for a in trial.answers]

    def findings(self, rows: Sequence[Row]) -> Findings:
        """What `pointcoord hard` says of the same cases."""
        results = examined_in(rows)
        unlike = [part for result in results for part in _told(result)]
        status = ExitStatus.AGREE if as_expected(results) else ExitStatus.DISAGREE
        return Findings((*unlike, *summary_parts(results)), results_data(results), status)


def examined_in(rows: Sequence[Row]) -> list[Examined]:
    """The cases that rows are of, with the values that were tried."""
    found: dict[str, dict[int, list[Row]]] = {}
    for row in rows:
        found.setdefault(row["part"], {}).setdefault(row["number"], []).append(row)
    results = []
    for case in chosen(list(found)):
        numbers = found[case.name]
        # Values that are not worked out yet are left out.
        values = tuple(case.values[i] for i in numbers)
        trials = [_trial(value, of) for value, of in zip(values, numbers.values(), strict=True)]
        seconds = sum(of[0]["seconds"] for of in numbers.values())
        results.append(examined(replace(case, values=values), trials, seconds))
    return results


def _trial(value: float, rows: Sequence[Row]) -> Trial:
    answers = tuple(Answer(**{name: row[name] for name in (*TEXTS, *SIZES)}) for row in rows)
    return Trial(value, answers, json.loads(rows[0]["facts"]))


def _told(result: Examined) -> list[str]:
    """What of a case is not as it has to be, a line each."""
    unlike = dict.fromkeys((*result.unexpected, *result.wrong))
    return [
        f"NOT AS EXPECTED: {result.case.name}: {a.formulation} is {a.outcome} at {value:g}: {a.reason}"
        for value, a in unlike
    ]
