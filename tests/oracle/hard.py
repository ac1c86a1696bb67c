"""The hard cases: what each formulation made of each value, right, refused or wrong, and why refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from program import document, pointcoord
from record import Facts, Record
from refusals import kind_of


def record(folder: Path) -> Record:
    """All cases, by `pointcoord hard`."""
    target = folder / "hard.json"
    status = pointcoord("hard", "-q", "--json", target)
    return Record({"all": {"exit status": status}} | case_facts(document(target)))


def case_facts(content: dict[str, Any]) -> Facts:
    """By case: of each value and formulation the outcome, and of a refusal its kind."""
    facts: Facts = {"all cases": {"as expected": content.get("as_expected")}}
    for case in content.get("cases", []):
        facts[case["name"]] = {
            f"{answer['formulation']} at {trial['value']:g}": _outcome(answer)
            for trial in case["trials"]
            for answer in trial["answers"]
        }
    return facts


def _outcome(answer: dict[str, Any]) -> str:
    if answer["outcome"] != "refused":
        return str(answer["outcome"])
    return f"refused for {kind_of(answer['reason'])}"
