"""The records of a study: a folder of Parquet files to which files are added and nothing else is done.

`_study.json` says what the records are of. Each other file holds all rows of some tasks, and is there whole
or not at all, so that the folder can be read at any time, also while the study runs:

    import pandas
    pandas.read_parquet("pointcoord-random")

Names that begin with `_` or `.` are left out there, as what is being written does. The columns that every
study has: part and number are the task, seconds how long it took (the same in all of its rows), worker who
did it. What the others are stands with the study.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from validate.errors import UsageError
from validate.extras import needed
from validate.output.files import unwritable, write_content, write_whole
from validate.plain_text import shown
from validate.studies.study import Row, Study, Task, differences, made_by

HEAD = "_study.json"
EVERY = {"part": "string", "number": "int64", "seconds": "float64", "worker": "string"}
ANOTHER = "give another folder by --records, or delete this one to begin again"


@dataclass(frozen=True)
class Store:
    """A folder of records.

    Attributes:
        study: its name. settings: all that a row depends on beside its task.
        columns: of every row, with their types. made_by: what made the rows.
    """

    folder: Path
    study: str
    settings: Mapping[str, str | int]
    columns: Mapping[str, str]
    made_by: Mapping[str, str]

    def files(self) -> list[Path]:
        """What holds rows, in the order in which it was written."""
        return sorted(path for path in self.folder.glob("*.parquet") if path.name[0] not in "_.")

    def tasks(self) -> set[Task]:
        """Those that need not be worked out again.

        Raises:
            UsageError: a file cannot be read.
        """
        return {task for task, _ in self._read(Task._fields)}

    def rows(self, tasks: Sequence[Task] | None = None) -> list[Row]:
        """The rows of tasks in their order, whenever they were worked out; of all tasks if none are given.

        Raises:
            UsageError: a file cannot be read.
        """
        found: dict[Task, list[Row]] = {}
        for task, row in self._read(tuple(self.columns)):
            found.setdefault(task, []).append(row)
        return [row for task in (sorted(found) if tasks is None else tasks) for row in found.get(task, ())]

    def _read(self, columns: Sequence[str]) -> Iterator[tuple[Task, Row]]:
        # Two runs may have worked out the same task: it counts once.
        known: set[Task] = set()
        parquet = needed("study", "pyarrow.parquet", "cluster")
        for file in self.files():
            try:
                rows = parquet.read_table(file, columns=list(columns), partitioning=None).to_pylist()
                here = [(Task(row["part"], row["number"]), row) for row in rows]
            except (OSError, ValueError, KeyError) as error:
                told = " ".join(str(error).split())
                raise _unusable(
                    self.folder,
                    f"{file.name} cannot be read as what this study records ({told}); delete this file to "
                    "work out its tasks again",
                ) from None
            yield from ((task, row) for task, row in here if task not in known)
            known.update(task for task, _ in here)

    def next_file(self) -> Path:
        """A file for what is worked out next, which no other run has."""
        return self.folder / f"{time.time_ns():020d}-{os.getpid()}.parquet"

    def write(self, file: Path, rows: Sequence[Row]) -> None:
        """Write a file: all rows of some tasks. Whoever was interrupted may write the same one again.

        Raises:
            OutputError: it cannot be written.
        """
        pa, parquet = (needed("study", name, "cluster") for name in ("pyarrow", "pyarrow.parquet"))
        schema = pa.schema([(name, getattr(pa, kind)()) for name, kind in self.columns.items()])
        table = pa.Table.from_pylist(list(rows), schema=schema)
        if not self.files():
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise unwritable(str(self.folder), error) from None
            head = {name: value for name, value in vars(self).items() if name != "folder"}
            write_content(str(self.folder / HEAD), json.dumps(head, indent=1) + "\n")
        write_whole(str(file), lambda stream: parquet.write_table(table, stream))


def look(folder: Path) -> Store:
    """The records that are in a folder, whoever made them, to be read only.

    Raises:
        UsageError: there are none.
    """
    if (store := _found(folder)) is None:
        raise _unusable(folder, "holds no records of a study; run the study first")
    return store


def adding_to(folder: Path, study: Study) -> Store:
    """The records in a folder, to be gone on with, or begun: the folder is made when something is recorded.

    Raises:
        UsageError: they are of something else, or there is no room.
    """
    needed("study", "pyarrow.parquet", "cluster")
    here = Store(folder, study.name, study.settings, {**EVERY, **study.columns}, made_by())
    there = _found(folder)
    if folder.exists() and not folder.is_dir():
        raise _unusable(folder, "is a file, and records take a folder; give another name")
    # A run that ended before anything was recorded left nothing to be held to.
    if there is None or not there.files():
        if folder.is_dir() and set(os.listdir(folder)) - {HEAD}:
            raise _unusable(folder, "holds something else than records of a study; give another folder")
    elif there.study != study.name:
        raise _unusable(folder, f"holds the study {there.study!r}, not {study.name!r}; {ANOTHER}")
    elif told := differences({**there.settings, **there.made_by}, {**here.settings, **here.made_by}):
        raise _unusable(folder, f"was begun with something else: {told}; {ANOTHER}")
    return here


def _found(folder: Path) -> Store | None:
    """What a folder says that it holds; None if it says nothing.

    Raises:
        UsageError: it says something that this program does not know.
    """
    try:
        return Store(folder=folder, **json.loads((folder / HEAD).read_text(encoding="utf-8")))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError, TypeError) as error:
        raise _unusable(folder, f"{HEAD} does not say what the records are of ({error}); {ANOTHER}") from None


def _unusable(folder: Path, problem: str) -> UsageError:
    return UsageError(f"--records {shown(str(folder))}: {problem}")
