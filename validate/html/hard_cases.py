"""Hard cases as a report has them: tried in the same run, or kept in a file by an earlier one."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.document import SCHEMA_VERSION
from validate.plain_text import shown

ALLOWED = "a file that `pointcoord hard --json FILE` wrote"
# What reading other data than those of hard cases ends with.
DAMAGED = (LookupError, TypeError, ValueError, AttributeError, RecursionError)


@dataclass(frozen=True)
class Answer:
    """What a formulation made of one value of a case's parameter; error and bound are NaN without numbers."""

    value: float
    formulation: str
    outcome: str
    reason: str
    error: float
    bound: float

    @property
    def refused(self) -> bool:
        """Whether there is no answer, with a reason."""
        return self.outcome == "refused"


@dataclass(frozen=True)
class Case:
    """A hard case, tried.

    Attributes:
        parameter: what tends to the singular place, with its unit. unit: of error and bound.
        unexpected: answers that it does not allow, in words.
    """

    name: str
    group: str
    why: str
    parameter: str
    unit: str
    behaviour: str
    answers: tuple[Answer, ...]
    unexpected: tuple[str, ...]

    @property
    def formulations(self) -> tuple[str, ...]:
        """That were tried, in their order."""
        return tuple(dict.fromkeys(answer.formulation for answer in self.answers))


@dataclass(frozen=True)
class HardCases:
    """All cases of a run.

    Attributes:
        document: the run, in the form of `pointcoord hard --json`. cases: its cases.
        counts: how often each formulation came to each outcome. as_expected: whether every case allows what
            came of it.
    """

    document: Mapping[str, Any]
    cases: tuple[Case, ...]
    counts: Mapping[str, Mapping[str, int]]
    as_expected: bool

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> HardCases:
        """The cases of a document.

        Raises:
            LookupError, TypeError, ValueError, AttributeError: it is none of hard cases.
        """
        counts = {
            str(name): {str(o): int(n) for o, n in of.items()} for name, of in document["counts"].items()
        }
        return cls(document, tuple(map(_case, document["cases"])), counts, document["as_expected"] is True)

    @property
    def results(self) -> Mapping[str, Any]:
        """What was found, as plain data."""
        return {name: self.document[name] for name in ("as_expected", "counts", "cases")}

    @property
    def status(self) -> ExitStatus:
        """What the cases alone would end a run with."""
        return ExitStatus.AGREE if self.as_expected else ExitStatus.DISAGREE

    @property
    def sentence(self) -> str:
        """What came of them in a few words."""
        count, scenes = len(self.cases), sum(len({a.value for a in one.answers}) for one in self.cases)
        noun = "case" if count == 1 else "cases"
        told = f"{count} hard {noun} at {scenes} values compared with the many-digit reference: "
        unjudged = [one.name for one in self.cases if any(a.outcome == "unjudged" for a in one.answers)]
        end = f"; some answers not judged: {', '.join(unjudged[:10])}" if unjudged else ""
        if self.status is ExitStatus.AGREE:
            return f"{told}all as expected{end}"
        other = [one.name for one in self.cases if one.unexpected]
        return f"{told}disagrees, not as expected{': ' if other else ''}{', '.join(other[:10])}{end}"


def _case(data: Mapping[str, Any]) -> Case:
    answers = tuple(
        _answer(trial["value"], answer) for trial in data["trials"] for answer in trial["answers"]
    )
    return Case(
        name=str(data["name"]),
        group=str(data["group"]),
        why=str(data["why"]),
        parameter=str(data["parameter"]),
        unit=str(data["unit"]),
        behaviour=str(data["behaviour"]),
        answers=answers,
        unexpected=tuple(map(_other, data["unexpected"])),
    )


def _answer(value: float, data: Mapping[str, Any]) -> Answer:
    error, bound = (math.nan if data[key] is None else float(data[key]) for key in ("error", "bound"))
    formulation, outcome, reason = (str(data[key]) for key in ("formulation", "outcome", "reason"))
    return Answer(float(value), formulation, outcome, reason, error, bound)


def _other(data: Mapping[str, Any]) -> str:
    return f"{data['formulation']} is {data['outcome']} at {data['value']:g}: {data['reason']}"


def read_hard_cases(file: str) -> HardCases:
    """Read what a run of hard cases kept.

    Raises:
        UsageError: it holds none.
    """
    try:
        document = json.loads(Path(file).read_bytes())
    except OSError as error:
        raise _unusable(file, f"cannot be read ({error.strerror})") from None
    except (ValueError, RecursionError):
        raise _unusable(file, "is no JSON") from None
    if not isinstance(document, dict) or document.get("kind") != "hard":
        raise _unusable(file, "holds no hard cases")
    if document.get("schema_version") != SCHEMA_VERSION:
        version = shown(str(document.get("schema_version")))
        raise _unusable(file, f"is of schema version {version}, and this program reads {SCHEMA_VERSION}")
    if document.get("complete") is not True:
        raise _unusable(file, "is of a run that did not come to its end")
    try:
        return HardCases.of(document)
    except DAMAGED as error:
        raise _unusable(file, f"is damaged ({type(error).__name__}: {shown(str(error))})") from None


def _unusable(file: str, problem: str) -> UsageError:
    return UsageError(f"--hard {shown(file)}: {problem}; allowed: {ALLOWED}")
