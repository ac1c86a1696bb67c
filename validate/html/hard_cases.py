"""Hard cases for a report: the document of this run, or of an earlier run, read from a file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ValidationError

from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.hard.answer import Answer
from validate.output.report import counted_as
from validate.plain_text import shown, some_of

NAMED = 10  # cases that a sentence names


class Trial(BaseModel):
    """The answers of all formulations at one value of a case's parameter."""

    value: float
    answers: tuple[Answer, ...]


class Unexpected(BaseModel):
    """An answer that its case does not allow."""

    value: float
    formulation: str
    outcome: str
    reason: str


class Case(BaseModel):
    """A hard case with its results; its texts are those of `validate.hard.case.Case`."""

    name: str
    group: str
    why: str
    parameter: str
    unit: str
    trials: tuple[Trial, ...]
    unexpected: tuple[Unexpected, ...]

    @property
    def answers(self) -> Iterator[tuple[float, Answer]]:
        """Every answer, with the value of the parameter."""
        return ((trial.value, answer) for trial in self.trials for answer in trial.answers)


class HardCases(BaseModel):
    """All cases of a run, in the form of `pointcoord hard --json`.

    Attributes:
        document: the whole document, as written.
        started: UTC, if the run recorded it.
        counts: number of answers by formulation and outcome.
        as_expected: whether every answer is one that its case allows.
    """

    document: Mapping[str, Any]
    kind: Literal["hard"]
    schema_version: Literal[3]
    complete: Literal[True]
    command_line: str
    started: str | None
    cases: tuple[Case, ...]
    counts: Mapping[str, Mapping[str, int]]
    as_expected: bool

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> HardCases:
        """The cases of a document.

        Raises:
            ValidationError: the document does not contain hard cases.
        """
        return cls.model_validate({**document, "document": document})

    @property
    def status(self) -> ExitStatus:
        """The exit status of the cases alone."""
        return ExitStatus.AGREE if self.as_expected else ExitStatus.DISAGREE

    @property
    def sentence(self) -> str:
        """The results of the cases in one sentence."""
        count = counted_as(len(self.cases), "hard case")
        other = some_of([one.name for one in self.cases if one.unexpected], NAMED)
        came = "all as expected" if self.as_expected else f"disagrees, not as expected: {other}"
        left = [one.name for one in self.cases if any(a.outcome == "unjudged" for _, a in one.answers)]
        unjudged = f"; some answers not judged: {some_of(left, NAMED)}" if left else ""
        return f"{count} compared with the many-digit reference: {came}{unjudged}"


def read_hard_cases(file: str) -> HardCases:
    """Read a file that `pointcoord hard --json` wrote.

    Raises:
        UsageError: the file contains no hard cases.
    """
    try:
        return HardCases.of(json.loads(Path(file).read_bytes()))
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
    except ValidationError as error:
        first = error.errors()[0]
        problem = f"contains no hard cases ({'.'.join(map(str, first['loc']))}: {first['msg']})"
    except TypeError:
        problem = "contains no hard cases"
    except (ValueError, RecursionError):
        problem = "is not JSON"
    allowed = "a file that `pointcoord hard --json FILE` wrote"
    raise UsageError(f"--hard {shown(file)}: {shown(problem)}; allowed: {allowed}")
