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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
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
        run: who writes, so that two runs never write the same file.
    """

    folder: Path
    study: Study
    run: str = field(default_factory=lambda: os.urandom(4).hex())

    @property
    def head(self) -> Mapping[str, str | int]:
        """What the rows depend on beside their task."""
        return {"study": self.study.name, **self.study.settings, **made_by()}

    def files(self) -> list[Path]:
        """What holds rows."""
        return sorted(path for path in self.folder.glob("*.parquet") if path.name[0] not in "_.")

    def rows(self) -> dict[Task, list[Row]]:
        """The rows of every task that is recorded.

        Raises:
            UsageError: a file cannot be read.
        """
        found: dict[Task, list[Row]] = {}
        parquet, columns = needed("study", "pyarrow.parquet", "cluster"), [*EVERY, *self.study.columns]
        for file in self.files():
            here: dict[Task, list[Row]] = {}
            try:
                for row in parquet.read_table(file, columns=columns, partitioning=None).to_pylist():
                    here.setdefault(Task(row["part"], row["number"]), []).append(row)
            except (OSError, ValueError, KeyError) as error:
                told = " ".join(str(error).split())
                raise self.unusable(
                    f"{file.name} cannot be read as what this study records ({told}); delete this file to "
                    "work out its tasks again"
                ) from None
            # Two runs may have worked out the same task: it counts once.
            found = here | found
        return found

    def write(self, rows: Sequence[Row]) -> None:
        """Write a file: all rows of some tasks; who was interrupted writes the same again, to the same file.

        Raises:
            NotFinished: it cannot be written.
        """
        pa, parquet = (needed("study", name, "cluster") for name in ("pyarrow", "pyarrow.parquet"))
        columns = {**EVERY, **self.study.columns}
        schema = pa.schema([(name, getattr(pa, kind)()) for name, kind in columns.items()])
        table = pa.Table.from_pylist(list(rows), schema=schema)
        if not self.files():
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise unwritable(str(self.folder), error) from None
            write_content(str(self.folder / HEAD), json.dumps(self.head, indent=1) + "\n")
        name = f"{rows[0]['part']}-{rows[0]['number']}-{self.run}.parquet"
        write_whole(str(self.folder / name), lambda stream: parquet.write_table(table, stream))

    def unusable(self, problem: str) -> UsageError:
        """The error of a folder that records cannot be in."""
        return UsageError(f"--records {shown(str(self.folder))}: {problem}")


def records(folder: Path, study: Study) -> Store:
    """The records in a folder, to be gone on with, or begun: the folder is made when something is recorded.

    Raises:
        UsageError: they are of something else, or there is no room.
    """
    needed("study", "pyarrow.parquet", "cluster")
    store = Store(folder, study)
    try:
        if folder.exists() and not folder.is_dir():
            raise store.unusable("is a file, and records take a folder; give another name")
        # A run that ended before anything was recorded left nothing to be held to.
        if not store.files():
            if folder.is_dir() and set(os.listdir(folder)) - {HEAD}:
                raise store.unusable("holds something else than records of a study; give another folder")
            return store
        there = json.loads((folder / HEAD).read_text(encoding="utf-8"))
        told = differences(there, store.head)
    except (OSError, ValueError, TypeError) as error:
        raise store.unusable(f"{HEAD} does not say what the records are of ({error}); {ANOTHER}") from None
    if told:
        raise store.unusable(f"was begun with something else: {told}; {ANOTHER}")
    return store
