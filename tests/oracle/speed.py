"""Every ratio of `tests/benchmarks/speed.py`, of this checkout and of a commit before, by turns."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

from program import ONE_CORE, ROOT

COMMIT = "babc22c"
"""The last one before a suspension became a file."""
TURNS = 4
SIZE = os.environ.get("SPEED", "small")  # or full
FACTORS = (1.3, 2.0)  # above these a line says so

Ratios = dict[str, float]


def by_turns(folder: Path) -> tuple[list[Ratios], list[Ratios]]:
    """The ratios of some runs of the commit before and of this checkout, one after the other, by figure.

    A ratio moves with the machine, its load and its processor's kind, so that two are compared that were
    taken next to each other.

    Raises:
        FileNotFoundError: the commit is not there, as in a clone without its history.
    """
    tree = folder / COMMIT
    add = ("git", "worktree", "add", "--detach", "--quiet", str(tree), COMMIT)
    if subprocess.run(add, cwd=ROOT, capture_output=True).returncode:
        raise FileNotFoundError(2, "there is no such commit in this clone", COMMIT)
    try:
        runs = [(_measured(tree, folder), _measured(ROOT, folder)) for _ in range(TURNS)]
    finally:
        subprocess.run(("git", "worktree", "remove", "--force", str(tree)), cwd=ROOT, capture_output=True)
    return [before for before, _ in runs], [now for _, now in runs]


def _measured(tree: Path, folder: Path) -> Ratios:
    """The ratios of one run of a checkout, by the name of the figure."""
    target = folder / "speed.json"
    options = ("-n", "0", "-p", "benchmark", "--benchmark-json", str(target), "-q")
    environment = {**os.environ, **ONE_CORE, "PYTHONPATH": str(tree), "SPEED": SIZE}
    command = (sys.executable, "-m", "pytest", "tests/benchmarks/speed.py", *options)
    subprocess.run(command, cwd=tree, env=environment, capture_output=True)
    content = json.loads(target.read_text(encoding="utf-8"))
    return {_figure(one["name"]): one["extra_info"]["ratio"] for one in content["benchmarks"]}


def _figure(test: str) -> str:
    """The name of a figure, from that of its test: test_...[import]."""
    return test.partition("[")[2].removesuffix("]")


def told(before: list[Ratios], now: list[Ratios]) -> tuple[list[str], float]:
    """A line for each figure with the lowest and the middle ratio of either, and the largest factor.

    A factor is that of the lowest ratios: what else the machine did only adds to a time.
    """
    lines = [f"speed: {TURNS} turns with {COMMIT}, sizes {SIZE}, load {os.getloadavg()[0]:.1f}"]
    factors = {}
    for name in before[0]:
        if not all(name in run for run in now):
            lines.append(f"speed | {name} | gone")
            continue
        old, new = ([run[name] for run in runs] for runs in (before, now))
        factors[name] = min(new) / min(old)
        middle = statistics.median(new) / statistics.median(old)
        above = [f"{limit:g}" for limit in FACTORS if factors[name] > limit]
        words = f", above {' and '.join(above)}" if above else ""
        lines.append(
            f"speed | {name} | before {min(old):.3g} | now {min(new):.3g} | {factors[name]:.2f} times "
            f"({middle:.2f} of medians){words}"
        )
    return lines, max(factors.values(), default=float("inf"))
