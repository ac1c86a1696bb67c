"""The program of this checkout, run as a user runs it: by its command line, in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from record import COLUMNS, Facts
from refusals import kind_of

ROOT = Path(__file__).resolve().parents[2]
ONE_CORE = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
AXES = "xyz"


def pointcoord(*words: str | Path, **environment: str) -> int:
    """Run `pointcoord WORDS` with this checkout's code, on one core: its exit status.

    In the checkout's folder; this one is there to import from, too.
    """
    paths = os.pathsep.join(map(str, (ROOT, Path(__file__).parent)))
    return subprocess.run(
        [sys.executable, "-m", "pointcoord", *map(str, words)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": paths, **ONE_CORE, **environment},
        capture_output=True,
    ).returncode


def validated(target: Path, *words: str | Path, **environment: str) -> dict[str, Any]:
    """What `validate WORDS --json TARGET` makes of one scene: its exit status and `scene_facts`."""
    status = pointcoord("validate", *words, "-q", "--json", target, **environment)
    found: dict[str, Any] = {"exit status of the program": status}
    for facts in scene_facts(document(target)).values():
        found |= facts
    return found


def document(path: Path) -> dict[str, Any]:
    """What --json wrote; nothing if the command came to no document."""
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def scene_facts(content: dict[str, Any]) -> Facts:
    """Of each scene of a document of `validate`: exit status, every verdict, refusals, explanations."""
    facts: Facts = {}
    for scene in content.get("scenes", []):
        name = Path(scene["scene"]).stem
        found = facts.setdefault(name, {"exit status": scene["exit_status"], "verdict": scene["verdict"]})
        found["problem"] = scene["problem"] is not None
        for refusal in scene["refusals"]:
            found[f"{refusal['formulation']} refuses"] = kind_of(refusal["reason"])
        for failure in scene["failures"]:
            found[f"{failure['formulation']} fails"] = True
        for comparison in scene["comparisons"]:
            found |= comparison_facts(comparison)
    return facts


def comparison_facts(comparison: dict[str, Any]) -> dict[str, Any]:
    """The verdict of every row, and the kinds of causes in alphabetical order.

    An explanation of the kind `part` names a place, not a cause.
    """
    pair = " and ".join(Path(name).name for name in comparison["formulations"])
    found: dict[str, Any] = {
        f"{pair}: {row['quantity']} {row['name']}": row["verdict"] for row in comparison["rows"]
    }
    if kinds := {one["kind"] for one in comparison["explanations"]} - {"part"}:
        found[f"{pair}: explained by"] = sorted(kinds)
    return found


def numbers_of(baseline: Path, every: int = 1, leave_out: tuple[str, ...] = ()) -> pd.DataFrame:
    """The numbers and claims of a file of --save-baseline, a row for each component.

    Args:
        every: of so many instants one is taken, and the last.
        leave_out: formulations that are not wanted.
    Returns:
        A table with the columns of a record; empty if the program came to no file.
    """
    if not baseline.exists():
        return pd.DataFrame(columns=COLUMNS)
    with np.load(baseline, allow_pickle=False) as file:
        head = json.loads(str(file["head"]))
        rows = [
            _rows(Path(scene["scene"]).stem, solution, quantity, name, file, every)
            for scene in head["scenes"]
            for solution in scene["solutions"]
            if solution["formulation"] not in leave_out
            for quantity, names in solution["numbers"].items()
            for name in names
        ]
    if not rows:
        return pd.DataFrame(columns=COLUMNS)
    table = {column: np.concatenate([row[column] for row in rows]) for column in COLUMNS}
    return pd.DataFrame(table)


def _rows(
    case: str, solution: dict[str, Any], quantity: str, name: str, file: Any, every: int
) -> dict[str, Any]:
    """All components of one quantity of one point, body or angle."""
    values = file[f"a{solution['numbers'][quantity][name]}"]
    claimed = solution["claims"].get(quantity, {}).get(name)
    bounds = np.full(values.shape, np.nan) if claimed is None else file[f"a{claimed}"]
    count = len(values)
    taken = np.unique(np.append(np.arange(0, count, every), count - 1))
    values, bounds = (array[taken].reshape(len(taken), -1) for array in (values, bounds))
    shape = values.shape
    axes = np.array(list(AXES) if shape[1] == 3 else [""] * shape[1], dtype=object)
    said = {"case": case, "formulation": solution["formulation"], "quantity": quantity, "name": name}
    return {
        **{key: np.full(values.size, text, dtype=object) for key, text in said.items()},
        "instant": np.repeat(taken, shape[1]),
        "axis": np.tile(axes, shape[0]),
        "value": values.ravel(),
        "bound": bounds.ravel(),
    }
