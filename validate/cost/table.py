"""The long table of the study, kept as a Parquet file: a row is one quantity of one way with one setting.

Every row says what was measured, how exact it was, how long it took, and by what program on what machine. So
tables can be concatenated. The file is written anew, and replaced at once, whenever something was measured: a
run that is stopped goes on with what there is.
"""

from __future__ import annotations

import os
import platform
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from pydantic import TypeAdapter, ValidationError

from validate.output.document import code_digest, machine, program_version
from validate.output.files import write_content

# Imported where a table is made: it takes half a second, and most pages show no costs.
if TYPE_CHECKING:
    import pandas as pd

Part = Literal["accuracy", "growth"]
Verdict = Literal["measured", "failed", "left out"]
PARTS: tuple[Part, ...] = get_args(Part)
# What is measured, of this distribution; how it is reported may change and the rows stay what they are.
MEASURED = (
    *("pointcoord", "absolute"),
    *(f"validate/{room}" for room in ("formulations", "paper", "peers", "spanning_tree")),
    "validate/cost/ways",
    *(f"validate/cost/{n}.py" for n in ("apart", "chain", "errors", "growth", "race", "scenes", "study")),
)
PACKAGES = ("numpy", "scipy", "pin", "mujoco", "exudyn")
WHERE = ("program", "machine", "python", "packages")
"""Columns that are the same in all rows whose times compare."""


class StoreError(Exception):
    """The file cannot be used; says why, and what to do."""


@dataclass(frozen=True)
class Row:
    """What was measured; None where there is no number.

    Attributes:
        part: of the study. scene: its name. way: its name.
        setting: in words, such as `1e-9 mm`. value: the number in it.
        dense: whether one solve serves any instant.
        against: what a row of growth varies: `instants`, `designs` or `unknowns`. size: how many of them.
        poses: that one run gives.
        quantity: see `pointcoord.effects.registry.QUANTITIES`.
        error, rms: against the reference, largest and root mean square of the components, in the quantity's
            unit. radius: the reference's own proven error. numbers: how many components there are.
        time: from instants to arrays, s a pose, median of the repeats; lower, upper: their quartiles.
        set_up: s a run, median: what is done before the instants are known. first: the first run with its
            set-up, s.
        peak_bytes: memory at its peak above what was held before.
        work: what one run did, such as `residuals 120, jacobians 40`.
        reason: why there are no numbers.
        digest: of the scene's content. quick: whether less was measured, as `--quick` asks.
        program, machine, python, packages, command: by what it was measured.
    """

    part: Part
    scene: str
    way: str
    setting: str = ""
    value: float | None = None
    dense: bool = False
    against: str = ""
    size: int | None = None
    poses: int = 0
    quantity: str = ""
    error: float | None = None
    rms: float | None = None
    radius: float | None = None
    numbers: int | None = None
    time: float | None = None
    lower: float | None = None
    upper: float | None = None
    repeats: int | None = None
    set_up: float | None = None
    first: float | None = None
    peak_bytes: int | None = None
    work: str = ""
    verdict: Verdict = "measured"
    reason: str = ""
    digest: str = ""
    quick: bool = False
    program: str = ""
    machine: str = ""
    python: str = ""
    packages: str = ""
    command: str = ""

    @property
    def key(self) -> tuple[object, ...]:
        """Identifies a run: what has one is not measured again."""
        return (*self.line, self.size)

    @property
    def line(self) -> tuple[object, ...]:
        """Identifies a run, whatever its size."""
        return (self.part, self.scene, self.digest, self.way, self.setting, self.against, self.quick)


_KINDS = {"float": "float64", "int": "Int64", "bool": "bool"}
COLUMNS = {one.name: _KINDS.get(str(one.type).removesuffix(" | None"), "str") for one in fields(Row)}
"""Every column with its type in pandas."""


def frame(rows: Iterable[Row]) -> pd.DataFrame:
    """Rows as a data frame."""
    import pandas as pd

    return pd.DataFrame([asdict(row) for row in rows], columns=list(COLUMNS)).astype(COLUMNS)


def read_rows(path: Path) -> list[Row]:
    """The rows of a file, wherever they were measured.

    Raises:
        StoreError: it cannot be read, or is no such table.
        ImportError: pyarrow is not there.
    """
    from pyarrow import parquet

    try:
        table = parquet.read_table(BytesIO(path.read_bytes()))
        if odd := set(table.column_names) ^ set(COLUMNS):
            raise ValueError(f"the columns {', '.join(sorted(odd))} are missing or unknown")
        return TypeAdapter(list[Row]).validate_python(table.to_pylist())
    except OSError as error:
        raise StoreError(f"{path}: cannot be read ({error.strerror}); give another file") from None
    except ValidationError as error:
        first = error.errors()[0]
        why = f"{first['loc'][1]} of row {first['loc'][0]}: {first['msg']}"
    # pyarrow's errors have no family of their own.
    except Exception as error:
        why = " ".join(str(error).split())[:200]
    raise StoreError(f"{path}: is no Parquet file of what accuracy costs ({why}); give another file")


class Store:
    """A table in a file, or in memory; what is there is not measured again."""

    def __init__(self, path: Path | None, here: Row) -> None:
        """Open a file; it is made when the first row is written.

        Args:
            path: None keeps the rows in memory. here: see `measured_here`.
        Raises:
            StoreError: it cannot be read, or holds something else, or rows of another program or machine.
        """
        self.path, self.here = path, here
        self.rows = read_rows(path) if path is not None and path.exists() else []
        for row in self.rows:
            pairs = [(getattr(row, what), getattr(here, what)) for what in WHERE]
            other = [f"{there}; here: {mine}" for there, mine in pairs if there != mine]
            if other:
                raise StoreError(
                    f"{path}: was measured elsewhere or with something else, and such times do not compare: "
                    f"{'; '.join(other)}; give another file, or delete this one to measure all again"
                )

    def has(self, row: Row) -> bool:
        """Whether the run of a row has been measured, whatever came of it."""
        return any(row.key == known.key for known in self.rows)

    def write(self, rows: Iterable[Row]) -> None:
        """Keep rows, now.

        Raises:
            OutputError: the file cannot be written.
        """
        where = {what: getattr(self.here, what) for what in (*WHERE, "command")}
        self.rows += [replace(row, **where) for row in rows]
        if self.path is not None:
            write_content(str(self.path), frame(self.rows).to_parquet())


def latest(rows: Sequence[Row], quick: bool) -> list[Row]:
    """Quick rows or the others; of a scene that was changed between two runs, those of the last one."""
    rows = [row for row in rows if row.quick == quick]
    last = {(row.part, row.scene): row.digest for row in rows}
    return [row for row in rows if last[row.part, row.scene] == row.digest]


def measured_here(command: str = "") -> Row:
    """A row that says where this process measures, and nothing else."""
    here = machine()
    return Row(
        *("accuracy", "", ""),
        program=f"pointcoord {program_version()}, code {code_digest(MEASURED)}",
        machine=f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}",
        python=f"{platform.python_implementation()} {platform.python_version()}",
        packages=", ".join(f"{name} {here['packages'][name] or 'not installed'}" for name in PACKAGES),
        command=command,
    )


def _processor() -> str:
    """The processor's name, as far as the system tells it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*:\s*(.+)$", text, flags=re.M)
    return found[1] if found else platform.processor() or platform.machine()
