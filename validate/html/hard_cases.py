"""Hard cases for a report: the document of this run, or of an earlier run, read from a file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.document import SCHEMA_VERSION
from validate.plain_text import counted_as, shown, some_of

NAMED = 10  # cases that a sentence names
Case = Mapping[str, Any]
"""A case with its results, as in the JSON."""
REQUIRED = {"kind": "hard", "schema_version": SCHEMA_VERSION, "complete": True}


@dataclass(frozen=True)
class HardCases:
    """All cases of a run: the document that `pointcoord hard --json` writes."""

    document: Mapping[str, Any]

    @property
    def cases(self) -> Sequence[Case]:
        """The cases, those with unexpected answers first."""
        return sorted(self.document["cases"], key=lambda case: not case["unexpected"])

    @property
    def status(self) -> ExitStatus:
        """The exit status of the cases alone."""
        return ExitStatus.AGREE if self.document["as_expected"] else ExitStatus.DISAGREE

    @property
    def sentence(self) -> str:
        """The results of the cases in one sentence."""
        count = counted_as(len(self.cases), "hard case")
        other = some_of([case["name"] for case in self.cases if case["unexpected"]], NAMED)
        came = "all as expected" if self.document["as_expected"] else f"disagrees, not as expected: {other}"
        left = [c["name"] for c in self.cases if any(a["outcome"] == "unjudged" for a in answers_of(c))]
        unjudged = f"; some answers not judged: {some_of(left, NAMED)}" if left else ""
        return f"{count} compared with the many-digit reference: {came}{unjudged}"


def answers_of(case: Case) -> list[Mapping[str, Any]]:
    """Every answer of a case, with the value of the parameter."""
    return [{**answer, "value": trial["value"]} for trial in case["trials"] for answer in trial["answers"]]


def read_hard_cases(file: str) -> HardCases:
    """Read a file that `pointcoord hard --json` wrote.

    Raises:
        UsageError: the file contains no hard cases.
    """
    try:
        document = json.loads(Path(file).read_bytes())
        problem = "; ".join(
            f"{key}: {document.get(key)}, not {value}"
            for key, value in REQUIRED.items()
            if document.get(key) != value
        )
        found = HardCases(document)
        if not problem and found.sentence:
            return found
        problem = f"contains no hard cases ({problem})"
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
    except (ValueError, RecursionError):
        problem = "is not JSON"
    except (AttributeError, KeyError, TypeError) as error:
        problem = f"contains no hard cases ({error})"
    allowed = "a file that `pointcoord hard --json FILE` wrote"
    raise UsageError(f"--hard {shown(file)}: {shown(problem)}; allowed: {allowed}")
