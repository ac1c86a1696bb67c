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
import os
import platform
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from importlib import metadata
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from pointcoord import Scene
from validate.cost.row import Row
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
ROW = TypeAdapter(Row)


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
                rows.append(ROW.validate_json(text))
        except ValidationError as error:
            # A line that was being written when a run was killed has no end.
            if not (text.startswith("{") and "EOF while parsing" in error.errors()[0]["msg"]):
                why = f"line {number} is no row of what accuracy costs: {_why(error)}"
                raise StoreError(f"{path}: {why}; give another file") from None
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


def _why(error: ValidationError) -> str:
    """What is wrong with a line, by the column that it is wrong in."""
    first = error.errors(include_url=False, include_context=False)[0]
    where = ".".join(shown(str(key))[:40] for key in first["loc"])
    value = first["input"]
    given = f", not {shown(repr(value))[:40]}" if where and not isinstance(value, dict) else ""
    return f"{where}{': ' if where else ''}{first['msg']}{given}"


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
