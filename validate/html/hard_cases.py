"""Hard cases as a report has them: the document of a run, just made, or kept in a file by an earlier one."""

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
    """What formulations made of one value of a case's parameter."""

    value: float
    answers: tuple[Answer, ...]


class Unexpected(BaseModel):
    """An answer that its case does not allow."""

    value: float
    formulation: str
    outcome: str
    reason: str


class Case(BaseModel):
    """A hard case, tried; its texts are those of `validate.hard.case.Case`."""

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
        document: all of it, as it was written. started: UTC, if the run noted it.
        counts: how often each formulation came to each outcome. as_expected: whether every case allows what
            came of it.
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
            ValidationError: it is none of hard cases.
        """
        return cls.model_validate({**document, "document": document})

    @property
    def status(self) -> ExitStatus:
        """What the cases alone would end a run with."""
        return ExitStatus.AGREE if self.as_expected else ExitStatus.DISAGREE

    @property
    def sentence(self) -> str:
        """What came of them in a few words."""
        count = counted_as(len(self.cases), "hard case")
        other = some_of([one.name for one in self.cases if one.unexpected], NAMED)
        came = "all as expected" if self.as_expected else f"disagrees, not as expected: {other}"
        left = [one.name for one in self.cases if any(a.outcome == "unjudged" for _, a in one.answers)]
        unjudged = f"; some answers not judged: {some_of(left, NAMED)}" if left else ""
        return f"{count} compared with the many-digit reference: {came}{unjudged}"


def read_hard_cases(file: str) -> HardCases:
    """Read what a run of hard cases kept.

    Raises:
        UsageError: it holds none.
    """
    try:
        return HardCases.of(json.loads(Path(file).read_bytes()))
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
    except ValidationError as error:
        first = error.errors()[0]
        problem = f"holds no hard cases ({'.'.join(map(str, first['loc']))}: {first['msg']})"
    except TypeError:
        problem = "holds no hard cases"
    except (ValueError, RecursionError):
        problem = "is no JSON"
    allowed = "a file that `pointcoord hard --json FILE` wrote"
    raise UsageError(f"--hard {shown(file)}: {shown(problem)}; allowed: {allowed}")
