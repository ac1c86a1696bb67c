"""The report of the built-in scenes: what its data say, beside the page."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

from hard import case_facts
from program import comparison_facts, document, pointcoord, scene_facts
from record import Fact, Facts, Record

# Numbers of the report come without bounds. Points are placed within the scenes' tolerance, 1e-9 mm; over the
# shortest axis, 60 mm, and at rates below 60 / s that is at most as much in rad and in rad / s.
SOLVED = 1e-9


def record(folder: Path) -> Record:
    """Verdicts, the paper's and other programs' tables, a few hard cases, and which ways were raced.

    Of the report in the folder REPORT where there is one; it is made otherwise.
    """
    made = os.environ.get("REPORT")
    target = Path(made) if made else folder / "report"
    status = None if made else pointcoord("report", target, "-q")
    results = document(target / "results.json")
    status = results.get("exit_status") if status is None else status
    facts: Facts = {"all": {"exit status": status, "page": (target / "index.html").exists()}}
    facts["all"] |= {key: results.get(key) for key in ("exit_status", "verdict", "complete")}
    facts |= {f"scene {scene}": found for scene, found in scene_facts(results).items()}
    for table in results.get("published_tables", []):
        facts.setdefault(f"table {table['title']}", {}).update(comparison_facts(table))
    for finding in results.get("printed_formulas", []):
        facts[f"printed formula of {finding['quantity']} in {finding['scene']}"] = _worst(finding["worst"])
    if results.get("printed_tables"):
        facts |= _paper(results["printed_tables"])
    facts["published numbers"] = _published(target / "published.csv")
    cases = case_facts(document(target / "hard.json"))
    facts |= {f"hard case {case}": found for case, found in cases.items()}
    facts["races"] = _races(document(target / "cost.json"))
    return Record(facts)


def _worst(row: dict[str, Any]) -> dict[str, Fact]:
    """By how much a printed formula is wrong, to what was tolerated there.

    Where a quotient of zeros is no number, which instant that is hangs on the last digit of a cosine.
    """
    none = row["difference"] is None
    return {
        "verdict": row["verdict"],
        "name": row["name"],
        "difference": "no number" if none else [row["difference"], row["tolerance"] or SOLVED],
    }


def _paper(tables: dict[str, Any]) -> Facts:
    """The paper's tables 2 and 3 with ours beside them."""
    facts: Facts = {"the paper's tables": {"r.m.s., mm": [tables["wheel_centre_rms_mm"], SOLVED]}}
    for row in tables["rows"]:
        printed = row["printed"]
        found: dict[str, Fact] = {}
        for name in ("wheel_centre", "omega", "alpha"):
            found |= {f"{name}[{i}]": [value, SOLVED] for i, value in enumerate(row[name])}
        facts[f"the paper's table {printed['table']} at {printed['time']:g} s"] = found
    return facts


def _published(path: Path) -> dict[str, Fact]:
    """What we compute where another program printed a number."""
    if not path.exists():
        return {}
    with path.open(encoding="utf-8", newline="") as stream:
        return {
            f"{row['table']}, {row['over']} {row['at']}: {row['name']}": [float(row["pointcoord"]), SOLVED]
            for row in csv.DictReader(stream)
            if row["pointcoord"]
        }


def _races(cost: dict[str, Any]) -> dict[str, Fact]:
    """Which races were run, between which ways; who won is the machine's affair."""
    return {
        f"{race['scene']}, {race['quantity']}, {race['accuracy']:g}": sorted(
            {one["way"] for one in race["reached"]}
        )
        for race in cost.get("races", [])
    }
