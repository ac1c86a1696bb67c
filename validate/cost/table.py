"""The table of measurements, a Parquet file: a row is one quantity of one method with one setting.

Every row has the error, the time, the program and the machine, so that tables can be concatenated.
"""

from __future__ import annotations

import os
import platform
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import TypeAdapter, ValidationError

from validate.errors import UsageError
from validate.output.document import machine, program_version

# pandas is imported where a table is made: it takes half a second, and most pages have no costs.
if TYPE_CHECKING:
    import pandas as pd

Verdict = Literal["measured", "failed", "left out"]
PACKAGES = ("numpy", "scipy", "pin", "mujoco", "exudyn")
WHERE = ("program", "machine", "python", "packages")
"""Columns that must be equal in rows whose times are compared."""


@dataclass(frozen=True)
class Row:
    """A row of measurements; None where there is no number.

    Attributes:
        scene: name of the scene. way: name of the method.
        setting: in words, such as `1e-9 mm`. value: the number in the setting.
        dense: whether one solve serves any instant.
        poses: number of poses of one run.
        quantity: see `pointcoord.effects.registry.QUANTITIES`.
        error: largest error of a component against the reference, in the unit of the quantity. radius: proven
            error of the reference.
        time: from instants to arrays, s per pose, median of the repeats. lower, upper: quartiles.
        set_up: time of the work before the instants are known, s per run, median.
        reason: why there are no numbers.
        quick: whether it was measured with `--quick`.
        program, machine, python, packages, command: where and how it was measured.
    """

    scene: str
    way: str
    setting: str = ""
    value: float | None = None
    dense: bool = False
    poses: int = 0
    quantity: str = ""
    error: float | None = None
    radius: float | None = None
    time: float | None = None
    lower: float | None = None
    upper: float | None = None
    repeats: int | None = None
    set_up: float | None = None
    verdict: Verdict = "measured"
    reason: str = ""
    quick: bool = False
    program: str = ""
    machine: str = ""
    python: str = ""
    packages: str = ""
    command: str = ""


_KINDS = {"float": "float64", "int": "Int64", "bool": "bool"}
COLUMNS = {one.name: _KINDS.get(str(one.type).removesuffix(" | None"), "str") for one in fields(Row)}
"""Every column with its type in pandas."""


def frame(rows: Iterable[Row]) -> pd.DataFrame:
    """Rows as a data frame."""
    import pandas as pd

    return pd.DataFrame([asdict(row) for row in rows], columns=list(COLUMNS)).astype(COLUMNS)


def read_rows(path: str) -> list[Row]:
    """The rows of a file, at least one, from any machine.

    Raises:
        UsageError: the file cannot be read, is not such a table, or has no rows.
        ImportError: pyarrow is not installed.
    """
    from pyarrow import parquet

    try:
        table = parquet.read_table(BytesIO(Path(path).read_bytes()), use_threads=False, pre_buffer=False)
        if missing := sorted(set(COLUMNS) - set(table.column_names)):
            raise ValueError(f"the columns {', '.join(missing)} are missing")
        if rows := TypeAdapter(list[Row]).validate_python(table.to_pylist()):
            return rows
        why = "it has no rows"
    except OSError as error:
        raise UsageError(f"{path}: cannot be read ({error.strerror}); give another file") from None
    except ValidationError as error:
        first = error.errors()[0]
        why = f"{first['loc'][1]} of row {first['loc'][0]}: {first['msg']}"
    # pyarrow's errors have no common base class.
    except Exception as error:
        why = " ".join(str(error).split())[:200]
    raise UsageError(f"{path}: is not a Parquet file of pointcoord cost --rows ({why}); give another file")


def measured_here(command: str) -> Mapping[str, str]:
    """The columns of program, machine and command for rows measured in this process."""
    here = machine()
    return {
        "program": f"pointcoord {program_version()}",
        "machine": f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}",
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "packages": ", ".join(f"{name} {here['packages'][name] or 'not installed'}" for name in PACKAGES),
        "command": command,
    }


def _processor() -> str:
    """The name of the processor, if the system has it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*:\s*(.+)$", text, flags=re.M)
    return found[1] if found else platform.processor() or platform.machine()
