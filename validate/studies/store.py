"""The records of a study: a folder of Parquet files; files are added and never changed.

`_study.json` has the study, its settings and the versions. Each other file has all rows of some tasks. Files
appear only when they are complete, so the folder can be read at any time, also while the study runs:

    import pandas
    pandas.read_parquet("pointcoord-random")

pandas skips names that begin with `_` or `.`, such as those of unfinished files. Every study has the columns
part and number, which are the task; seconds, the run time of the task (equal in all its rows); and worker,
the address of its worker. Each study documents its other columns.
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
ANOTHER = "give another folder with --records, or delete this folder to begin again"


@dataclass(frozen=True)
class Store:
    """A folder of records.

    Attributes:
        run: random part of file names, so that two runs never write the same file.
    """

    folder: Path
    study: Study
    run: str = field(default_factory=lambda: os.urandom(4).hex())

    @property
    def head(self) -> Mapping[str, str | int]:
        """The study, settings and versions on which the rows depend, in addition to their task."""
        return {"study": self.study.name, **self.study.settings, **made_by()}

    def files(self) -> list[Path]:
        """The files of rows."""
        return sorted(path for path in self.folder.glob("*.parquet") if path.name[0] not in "_.")

    def rows(self) -> dict[Task, list[Row]]:
        """The rows of every recorded task.

        Raises:
            UsageError: a file cannot be read.
        """
        found: dict[Task, list[Row]] = {}
        parquet, columns = needed("study", "pyarrow.parquet"), [*EVERY, *self.study.columns]
        for file in self.files():
            here: dict[Task, list[Row]] = {}
            try:
                for row in parquet.read_table(file, columns=columns, partitioning=None).to_pylist():
                    here.setdefault(Task(row["part"], row["number"]), []).append(row)
            except (OSError, ValueError, KeyError) as error:
                problem = " ".join(str(error).split())
                raise self.unusable(
                    f"{file.name} cannot be read as a record of this study ({problem}); delete this file to "
                    "run its tasks again"
                ) from None
            # Two runs may have recorded the same task: it counts once.
            found = here | found
        return found

    def write(self, rows: Sequence[Row]) -> None:
        """Write a file with all rows of some tasks. Writing the same rows again replaces the same file.

        Raises:
            NotFinished: the file cannot be written.
        """
        pa, parquet = (needed("study", name) for name in ("pyarrow", "pyarrow.parquet"))
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
        """The error for a folder that cannot be used for records."""
        return UsageError(f"--records {shown(str(self.folder))}: {problem}")


def records(folder: Path, study: Study) -> Store:
    """The records in a folder, old ones to be continued or new ones. A new folder is made at the first
    record.

    Raises:
        UsageError: the records are of another study or version, or the folder cannot be used.
    """
    needed("study", "pyarrow.parquet")
    store = Store(folder, study)
    try:
        if folder.exists() and not folder.is_dir():
            raise store.unusable("is a file; allowed: a folder; give another name")
        # Without files of rows, an old head requires nothing of the new run.
        if not store.files():
            if folder.is_dir() and set(os.listdir(folder)) - {HEAD}:
                raise store.unusable("contains files that are no records of a study; give another folder")
            return store
        there = json.loads((folder / HEAD).read_text(encoding="utf-8"))
        found = differences(there, store.head)
    except (OSError, ValueError, TypeError) as error:
        raise store.unusable(f"{HEAD} cannot be read as a study's head ({error}); {ANOTHER}") from None
    if found:
        raise store.unusable(f"has records of another study or version: {found}; {ANOTHER}")
    return store
