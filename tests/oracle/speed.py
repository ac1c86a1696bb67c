"""The speed table: every ratio of `tests/benchmarks/speed.py`, work against other work of the same run."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from program import ROOT, python
from record import read_text, write_text

SIZE = os.environ.get("SPEED", "small")  # or full; each has a table of its own
FILE = f"speed-{SIZE}.json"
FACTORS = (1.3, 2.0)  # what issues 17 and 18 allow


def measured(folder: Path) -> dict[str, float]:
    """The ratios of one run, by the name of the figure, at the sizes of SIZE."""
    target = folder / "speed.json"
    options = ("-n", "0", "-p", "benchmark", "--benchmark-json", target, "-q")
    python("-m", "pytest", "tests/benchmarks/speed.py", *options, OPENBLAS_NUM_THREADS="1", SPEED=SIZE)
    content = json.loads(target.read_text(encoding="utf-8"))
    return {_figure(one["name"]): one["extra_info"]["ratio"] for one in content["benchmarks"]}


def _figure(test: str) -> str:
    """The name of a figure, from that of its test: test_...[import]."""
    return test.partition("[")[2].removesuffix("]")


def freeze(frozen: Path, folder: Path, runs: int = 2) -> None:
    """Measure some runs, one after the other, and keep all of them with the lowest ratio of each figure."""
    git = ("git", "log", "-1", "--format=%h %s", "--", "pointcoord", "absolute", "validate")
    content: dict[str, Any] = {
        "commit": subprocess.run(git, cwd=ROOT, capture_output=True, text=True).stdout.strip(),
        "date": f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
        "machine": f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "size": SIZE,
        "runs": [],
        "load": [],
    }
    for number in range(runs):
        (folder / str(number)).mkdir()
        content["runs"].append(measured(folder / str(number)))
        content["load"].append(os.getloadavg()[0])
        ratios = content["runs"]
        content["lowest"] = {name: min(run[name] for run in ratios if name in run) for name in ratios[0]}
        write_text(frozen / FILE, content)


def _processor() -> str:
    names = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    return names[0].partition(":")[2].strip() if names else platform.processor()


def read(frozen: Path) -> dict[str, Any]:
    """The frozen table.

    Raises:
        FileNotFoundError: there is none of this size.
    """
    return dict(read_text(frozen / FILE))


def told(content: dict[str, Any], now: dict[str, float]) -> tuple[list[str], float]:
    """A line for each figure with now / frozen, and the largest of these."""
    lines = [f"speed: frozen on {content['date']}, {content['machine']}, sizes {content['size']}"]
    times = {name: now[name] / ratio for name, ratio in content["lowest"].items() if name in now}
    for name, factor in times.items():
        above = [f"{limit:g}" for limit in FACTORS if factor > limit]
        words = f", above {' and '.join(above)}" if above else ""
        lines.append(
            f"speed | {name} | frozen {content['lowest'][name]:.3g} | now {now[name]:.3g} | "
            f"{factor:.2f} times{words}"
        )
    lines += [f"speed | {name} | gone" for name in content["lowest"].keys() - now.keys()]
    return lines, max(times.values(), default=float("inf"))
