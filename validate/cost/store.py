"""The long table of the study, in a file: a line of JSON is a row, and a row is one quantity of one way.

Every row says by itself what was measured, how exact it was, how long it took, and by what program on what
machine. So files can be put behind one another, and `pandas.read_json(FILE, lines=True)` reads them (to the
last digit with precise_float=True). Lines are only appended, each synchronised to the disk: Parquet cannot be
appended to, and a run that is stopped goes on with what there is. A line that was torn by a kill is not JSON,
as its brace is missing; it does not count.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import platform
from collections.abc import Iterable, Sequence
from dataclasses import asdict, fields, replace
from importlib import metadata
from pathlib import Path
from typing import Any, get_args

from pointcoord import Scene
from validate.cost.row import Part, Row, Verdict
from validate.output.document import code_digest
from validate.plain_text import shown

# What is measured, of this distribution; how it is reported may change and the rows stay what they are.
MEASURED = (
    "pointcoord",
    "absolute",
    *(f"validate/{room}" for room in ("formulations", "paper", "peers", "relative", "spanning_tree")),
    *(f"validate/cost/{name}" for name in ("ways", "growth", "parts", "errors.py", "instants.py", "race.py")),
)
PACKAGES = ("numpy", "scipy", "pin", "mujoco", "exudyn")
WHERE = ("program", "machine", "python", "packages")
"""Columns that are the same in all rows whose times compare."""
ALLOWED = {"part": get_args(Part), "verdict": get_args(Verdict)}
DIGITS = 18  # of whole numbers: those fit into 64 bits


class StoreError(Exception):
    """The file cannot be used; says why, and what to do."""


def measured_here(command: str = "") -> Row:
    """A row that says where this process measures, and nothing else."""
    return Row(
        part="accuracy",
        scene="",
        way="",
        program=f"pointcoord {_version('pointcoord')}, code {code_digest(MEASURED)}",
        machine=f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}",
        python=f"{platform.python_implementation()} {platform.python_version()}",
        packages=", ".join(f"{name} {_version(name)}" for name in PACKAGES),
        command=command,
    )


class Store:
    """A file of rows, or the same in memory; what is there is not measured again."""

    def __init__(self, path: Path | None, here: Row) -> None:
        """Open a file; it is made when the first row is written.

        Args:
            path: None keeps the rows in memory. here: see `measured_here`.
        Raises:
            StoreError: it cannot be read, holds something else, or rows of another program or machine.
        """
        self.path, self.here = path, here
        self.rows = [] if path is None or not path.exists() else read_rows(path)
        for row in self.rows:
            pairs = [(getattr(row, what), getattr(here, what)) for what in WHERE]
            other = [f"{there}; here: {mine}" for there, mine in pairs if there != mine]
            if other:
                raise StoreError(
                    f"{path}: was measured elsewhere or with something else, and such times do not compare: "
                    f"{'; '.join(other)}; give another file, or delete this one to measure all again"
                )
        self._known = {row.key for row in self.rows}

    def has(self, row: Row) -> bool:
        """Whether what a row is of has been measured, whatever came of it."""
        return row.key in self._known

    def write(self, rows: Iterable[Row]) -> None:
        """Keep rows, now.

        Raises:
            StoreError: the file cannot be written.
        """
        new = [
            replace(row, **{what: getattr(self.here, what) for what in (*WHERE, "command")}) for row in rows
        ]
        if self.path is not None and new:
            _append(self.path, "\n".join(json.dumps(asdict(row), allow_nan=False) for row in new))
        self.rows += new
        self._known |= {row.key for row in new}


def read_rows(path: Path) -> list[Row]:
    """The rows of a file, wherever they were measured.

    Raises:
        StoreError: it cannot be read, or a line is no row.
    """
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    except OSError as error:
        raise StoreError(f"{path}: cannot be read ({error.strerror}); give another file") from None
    rows = []
    for number, text in enumerate(lines, 1):
        try:
            if text:
                rows.append(_row(json.loads(text, parse_int=_whole)))
        except json.JSONDecodeError:
            # The line that was being written when a run was killed.
            if not text.startswith("{"):
                raise _no_row(path, number, "it is not JSON") from None
        except (ValueError, RecursionError) as error:
            raise _no_row(path, number, str(error)) from None
    return rows


def latest(rows: Sequence[Row], quick: bool) -> list[Row]:
    """Quick rows or the others; of a scene that was changed between two runs, those of the last one."""
    rows = [row for row in rows if row.quick == quick]
    last = {(row.part, row.scene): row.digest for row in rows}
    return [row for row in rows if last[row.part, row.scene] == row.digest]


def scene_digest(scene: Scene) -> str:
    """Of what a scene says, whatever it is called."""
    content = scene.model_dump(mode="json", exclude={"title"})
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def _no_row(path: Path, number: int, why: str) -> StoreError:
    return StoreError(f"{path}: line {number} is no row of what accuracy costs: {why}; give another file")


def _row(content: Any) -> Row:
    """The row of a line; ValueError says why it is none."""
    if not isinstance(content, dict):
        raise ValueError("it is no object")
    known = {field.name: str(field.type) for field in fields(Row)}
    for name in ("part", "scene", "way"):
        if name not in content:
            raise ValueError(f"it has no {name!r}")
    for name, value in content.items():
        if name not in known:
            raise ValueError(f"it has {shown(name)[:40]!r}, which is no column")
        _require(name, value, known[name])
    return Row(**content)


def _whole(digits: str) -> float:
    """A whole number; Python refuses to read one of thousands of digits."""
    return int(digits) if len(digits) <= DIGITS else math.inf


def _require(name: str, value: Any, kind: str) -> None:
    """See that a value is one of its column: every number in the table is a size or a count."""
    base = kind.removesuffix(" | None")
    if value is None and base != kind:
        return
    if base in ("int", "float"):
        good = isinstance(value, int if base == "int" else int | float) and not isinstance(value, bool)
        good = good and 0 <= value < math.inf
        allowed = (
            f"{'a whole' if base == 'int' else 'a'} number from 0 up{', or null' if base != kind else ''}"
        )
    elif base == "bool":
        good, allowed = isinstance(value, bool), "true or false"
    else:
        choices: Sequence[str] = ALLOWED.get(name, ())
        good, allowed = (
            isinstance(value, str) and (not choices or value in choices),
            ", ".join(choices) or "text",
        )
    if not good:
        said = "too large a number" if value == math.inf else shown(repr(value))[:40]
        raise ValueError(f"{name} is {said}; allowed: {allowed}")


def _append(path: Path, lines: str) -> None:
    """Write at the end; it begins with a line break, so that a torn line before stays alone."""
    text = f"\n{lines}\n".encode()
    try:
        handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        try:
            written = os.write(handle, text)
            os.fsync(handle)
        finally:
            os.close(handle)
    except OSError as error:
        raise StoreError(f"{path}: cannot be written ({error.strerror}); give another file") from None
    if written != len(text):
        raise StoreError(f"{path}: {written} of {len(text)} bytes written; is the disk full?")


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    """The processor's name, as far as the system tells it."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
