"""Writes measured figures into the pages that show them: what a command printed, when, and of which commit.

    python tests/figures.py NAME [NAME ...]

Names: agreement, hard, assemblies, random, bounds, cost, effects, sizes, speed, struts, tables.

A figure stands in its page between two comments, `<!-- figure NAME -->` and `<!-- end -->`; what is between
them is replaced, and nothing else is. Long ones (see `FIGURES`) take as long as their command.
"""

from __future__ import annotations

import datetime
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
COLUMNS = ("bounce", "steer", "off-axis-strut", "double-wishbone", "five-link", "axle-opposed", "bricard")


@dataclass(frozen=True)
class Figure:
    """What a page shows of a command.

    Attributes:
        page: where it stands.
        command: as a reader types it; {folder} is an empty folder.
        shown: from what the command printed, and that folder, to Markdown.
    """

    page: str
    command: str
    shown: Callable[[str, Path], str]


def _from(first: str) -> Callable[[str, Path], str]:
    """The lines from the first that matches a pattern, as they were printed."""

    def shown(printed: str, folder: Path) -> str:
        lines = printed.splitlines()
        begin = next(k for k, line in enumerate(lines) if re.match(first, line))
        return "\n".join(["```text", *lines[begin:], "```"])

    return shown


def _as_printed(printed: str, folder: Path) -> str:
    """What is Markdown already."""
    return printed.strip()


def _agreement(printed: str, folder: Path) -> str:
    """The largest difference of each quantity: a column for some scenes, and one for all others."""
    scenes = json.loads((folder / "agreement.json").read_text(encoding="utf-8"))["scenes"]
    both = ["pointcoord", "absolute"]
    comparisons = [one for scene in scenes for one in scene["comparisons"] if one["formulations"] == both]
    rows: dict[str, dict[str, tuple[float, float]]] = {}
    units: dict[str, str] = {}
    for one in comparisons:
        column = one["scene"] if one["scene"] in COLUMNS else "the others"
        for row in one["rows"]:
            angle = row["quantity"] == "wheel"
            name = (row["name"].rpartition(".")[2] if angle else row["quantity"]).replace("_", " ")
            units[name] = row["unit"]
            before = rows.setdefault(name, {}).get(column, (0.0, 0.0))
            rows[name][column] = (max(before[0], row["difference"]), max(before[1], row["tolerance"]))
    others = f"the other {len(comparisons) - len(COLUMNS)}"
    lines = [
        f"| quantity | {' | '.join((*COLUMNS, others))} | tolerance, at most |",
        "|---" * (len(COLUMNS) + 3) + "|",
    ]
    for name, found in rows.items():
        cells = [f"{found[c][0]:.1e}" if c in found else "" for c in (*COLUMNS, "the others")]
        held = max(tolerance for _, tolerance in found.values())
        lines.append(f"| {name}, {units[name]} | {' | '.join(cells)} | {held:.1e} |")
    return "\n".join(lines)


def _speed(printed: str, folder: Path) -> str:
    """A row for each benchmark: what it takes, and its ratio to other work of the same run."""
    found = json.loads((folder / "speed.json").read_text(encoding="utf-8"))["benchmarks"]
    lines = ["| what | takes, s | ratio | of what | aimed at |", "|---|---|---|---|---|"]
    for one in found:
        extra, name = one["extra_info"], re.sub(r".*\[(.*)\]", r"\1", one["name"])
        lines.append(
            f"| {name} | {one['stats']['median']:.2g} | {extra['ratio']:.2g} "
            f"| {extra['of']} | {extra['goal']:g} |"
        )
    return "\n".join(lines)


FIGURES = {
    "agreement": Figure("README.md", "pointcoord validate --json {folder}/agreement.json", _agreement),
    "hard": Figure(
        "validate/hard/README.md",
        "pointcoord study hard --workers 2 --records {folder}/hard",
        _from(r"[\d,]+ cases, "),
    ),
    "assemblies": Figure("validate/hard/README.md", "pointcoord hard --assemblies", _from(r"scene ")),
    "random": Figure(
        "validate/studies/README.md",
        "pointcoord study random --count 2000 --workers 2 --records {folder}/random",
        _from(r""),
    ),
    "bounds": Figure(
        "validate/studies/README.md",
        "pointcoord study bounds --poses 400 --workers 2 --records {folder}/bounds",
        _from(r""),
    ),
    "cost": Figure(
        "validate/cost/README.md",
        "pointcoord cost --rows {folder}/rows.parquet",
        _from(r"Time of a pose to"),
    ),
    "speed": Figure(
        "validate/cost/README.md",
        "pytest tests/benchmarks/speed.py -n 0 -p benchmark --benchmark-json {folder}/speed.json",
        _speed,
    ),
    "tables": Figure("validate/published/README.md", "pointcoord validate --tables", _from(r"")),
    "struts": Figure("validate/formulations/README.md", "tests.support.badly_drawn_struts", _as_printed),
    "effects": Figure("pointcoord/effects/README.md", "tests.support.table_of_effects", _as_printed),
    "sizes": Figure(".github/CONTRIBUTING.md", "tests.support.table_of_sizes", _as_printed),
}


def _git(*words: str) -> str:
    return subprocess.run(
        ["git", *words], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.strip()


def write(name: str) -> None:
    """Run the command of a figure and put what it shows into its page."""
    figure = FIGURES[name]
    with tempfile.TemporaryDirectory() as folder:
        words = figure.command.format(folder=folder).split()
        ran = subprocess.run(
            [sys.executable, "-m", *words],
            cwd=ROOT,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            stdout=subprocess.PIPE,
            text=True,
        )
        if ran.returncode:
            sys.exit(f"{figure.command}: status {ran.returncode}; the page is as it was\n{ran.stdout}")
        shown = figure.shown(ran.stdout, Path(folder))
    said = figure.command.replace("{folder}/", "")
    said = f"python -m {said}" if said.startswith("tests.") else said
    when = f"By `{said}` on {datetime.date.today()}, commit {_git('rev-parse', '--short', 'HEAD')}:"
    page = ROOT / figure.page
    text = page.read_text(encoding="utf-8")
    block = re.compile(rf"(<!-- figure {name} -->\n).*?(<!-- end -->)", flags=re.S)
    if len(block.findall(text)) != 1:
        sys.exit(f"{figure.page}: has no place for the figure {name!r}, or several")
    page.write_text(block.sub(lambda m: f"{m[1]}{when}\n\n{shown}\n\n{m[2]}", text), encoding="utf-8")


if __name__ == "__main__":
    unknown = [name for name in sys.argv[1:] if name not in FIGURES]
    if unknown or len(sys.argv) == 1:
        sys.exit(f"{__doc__}\nUnknown: {', '.join(unknown) or 'no name was given'}")
    for name in sys.argv[1:]:
        write(name)
