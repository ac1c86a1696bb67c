"""The records of a long study: a folder of Parquet files to which files are added and nothing else is done.

`_study.json` says what the records are of. Each other file holds all rows of some numbers, and is there whole
or not at all, so that the folder can be read at any time, also while the study runs:

    import pyarrow.dataset
    pyarrow.dataset.dataset("pointcoord-random").to_table()

    import pandas
    pandas.read_parquet("pointcoord-random")

Both leave out names that begin with `_` or `.`, as what is being written does. The columns that every study
has: part and number say what was worked out, seconds how long that took (the same in all of its rows), worker
by whom. What the others are stands with the study.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

from validate.extras import MissingPackage
from validate.long_studies.errors import RecordsError
from validate.long_studies.maker import Maker
from validate.long_studies.study import Kind, Number, Row, Study
from validate.output.files import unwritable, write_whole

FORMAT = 1
HEAD = "_study.json"
LOCK = "_lock"
EVERY: Mapping[str, Kind] = {"part": "string", "number": "int64", "seconds": "float64", "worker": "string"}
ANOTHER = "give another folder by --records, or delete this one to begin again"


@dataclass(frozen=True)
class Head:
    """What the records of a folder are of.

    Attributes:
        study: its name. settings: all that a row depends on beside its number.
        columns: of every row, with what they hold.
        maker: who makes all of the rows.
    """

    study: str
    settings: Mapping[str, str | int]
    columns: Mapping[str, Kind]
    maker: Maker

    @classmethod
    def of(cls, study: Study) -> Head:
        """Of a study that this program makes."""
        return cls(study.name, study.settings, {**EVERY, **study.columns}, Maker.here())


class Records:
    """A folder of records."""

    def __init__(self, folder: Path, head: Head) -> None:
        self.folder = folder
        self.head = head

    def files(self) -> list[Path]:
        """What holds rows, in the order in which it was written."""
        return sorted(path for path in self.folder.glob("*.parquet") if path.name[0] not in "_.")

    def recorded(self) -> set[Number]:
        """The numbers that need not be worked out again.

        Raises:
            RecordsError: a file cannot be read.
        """
        return {Number(row["part"], row["number"]) for row in self._read(list(Number._fields))}

    def rows(self) -> list[Row]:
        """All rows, those of a number beside each other.

        Raises:
            RecordsError: a file cannot be read.
        """
        return list(self._read(list(self.head.columns)))

    def _read(self, columns: list[str]) -> Iterator[Row]:
        # Two runs on a disk that knows no locks may have worked out the same number: it counts once.
        known: set[Number] = set()
        parquet = arrow("parquet")
        for file in self.files():
            try:
                rows = parquet.read_table(file, columns=columns, partitioning=None).to_pylist()
                here = {Number(row["part"], row["number"]) for row in rows}
            except (OSError, ValueError, KeyError) as error:
                told = " ".join(str(error).split())
                raise RecordsError(
                    self.folder,
                    f"{file.name} cannot be read as what this study records ({told}); delete this file to "
                    "work out its numbers again",
                ) from None
            yield from (row for row in rows if Number(row["part"], row["number"]) not in known)
            known |= here

    def next_file(self) -> Path:
        """The file that what is worked out next goes into."""
        last = max((int(file.stem) for file in self.files() if file.stem.isdigit()), default=-1)
        return self.folder / f"{last + 1:06d}.parquet"

    def write(self, file: Path, rows: Sequence[Row]) -> None:
        """Write a file: all rows of some numbers. Whoever was interrupted may write the same one again.

        Raises:
            OutputError: it cannot be written.
        """
        pa, parquet = arrow(), arrow("parquet")
        schema = pa.schema([(name, getattr(pa, kind)()) for name, kind in self.head.columns.items()])
        table = pa.Table.from_pylist(list(rows), schema=schema)

        def put(stream: BinaryIO) -> None:
            parquet.write_table(table, stream)

        write_whole(str(file), put)


def look(folder: Path) -> Records:
    """The records that are in a folder, whoever made them, to be read only.

    Raises:
        RecordsError: there are none.
    """
    head = _head(folder)
    if head is None:
        raise RecordsError(folder, "holds no records of a study; run the study first")
    return Records(folder, head)


@contextmanager
def adding_to(folder: Path, head: Head) -> Iterator[Records]:
    """The records in a folder, to be gone on with, or begun; one run at a time.

    Raises:
        RecordsError: they are of another study, of other settings or made by another program; another run
            adds to them now; or it is a folder of something else.
        OutputError: the folder takes no files.
    """
    arrow("parquet")
    there = _head(folder)
    if there is not None and not Records(folder, there).files():
        # A run that ended before anything was recorded left nothing to be held to.
        there = None
    elif there is not None:
        _require_same(folder, there, head)
    elif folder.exists() and not folder.is_dir():
        raise RecordsError(folder, "is a file, and records take a folder; give another name")
    elif folder.is_dir() and set(os.listdir(folder)) - {HEAD, LOCK}:
        raise RecordsError(folder, "holds something else than records of a study; give another folder")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(str(folder), error) from None
    with _locked(folder):
        if there is None:
            text = json.dumps({"format": FORMAT, **asdict(head)}, indent=1) + "\n"

            def put(stream: BinaryIO) -> None:
                stream.write(text.encode())

            write_whole(str(folder / HEAD), put)
        yield Records(folder, head)


def _require_same(folder: Path, there: Head, head: Head) -> None:
    if there.study != head.study:
        raise RecordsError(folder, f"holds the study {there.study!r}, not {head.study!r}; {ANOTHER}")
    differences = [
        f"{name} {there.settings.get(name, 'not known')}, here {head.settings.get(name, 'not known')}"
        for name in dict.fromkeys((*there.settings, *head.settings))
        if there.settings.get(name) != head.settings.get(name)
    ]
    differences += there.maker.differences(head.maker)
    if differences:
        raise RecordsError(folder, f"was begun with something else: {'; '.join(differences)}; {ANOTHER}")
    if dict(there.columns) != dict(head.columns):
        raise RecordsError(folder, f"has other columns; {ANOTHER}")


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """The folder for this run alone. The lock goes with the process, however it ends.

    Raises:
        RecordsError: another run has it.
        OutputError: the folder takes no files.
    """
    import fcntl

    try:
        handle = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise unwritable(str(folder), error) from None
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise RecordsError(
                folder, "another run adds to them now; wait for it, or give another folder"
            ) from None
        except OSError:
            pass  # A disk that knows no locks: a number that two runs work out counts once.
        yield
    finally:
        os.close(handle)


def _head(folder: Path) -> Head | None:
    """What a folder says that it holds; None if it says nothing.

    Raises:
        RecordsError: it says something that this program does not know.
    """
    file = folder / HEAD
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        if data["format"] != FORMAT:
            raise RecordsError(
                folder,
                f"is written in the form {data['format']!r}, this program knows the form {FORMAT}; {ANOTHER}",
            )
        return Head(data["study"], data["settings"], data["columns"], Maker(**data["maker"]))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise RecordsError(folder, f"{HEAD} cannot be read ({error.strerror}); {ANOTHER}") from None
    except (ValueError, KeyError, TypeError):
        raise RecordsError(folder, f"{HEAD} does not say what the records are of; {ANOTHER}") from None


def in_order(rows: Iterable[Row], numbers: Sequence[Number]) -> list[Row]:
    """The rows of these numbers, in their order and not in that in which they were worked out."""
    found: dict[Number, list[Row]] = {}
    for row in rows:
        found.setdefault(Number(row["part"], row["number"]), []).append(row)
    return [row for number in numbers for row in found.get(number, ())]


def arrow(module: str = "") -> Any:
    """pyarrow, or a module of it.

    Raises:
        MissingPackage: it is not there.
    """
    try:
        return import_module(f"pyarrow.{module}" if module else "pyarrow")
    except ImportError as error:
        raise MissingPackage("study", error, "cluster") from None
