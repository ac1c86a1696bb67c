"""A motion as a table of named columns: CSV, NPZ and Parquet, written block by block.

However many instants there are, no more memory is taken than for a block of them.
"""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from pointcoord import Motion
from pointcoord.results.named_columns import columns
from validate.extras import MissingPackage
from validate.output.files import require_known_ending, write_whole

Array = NDArray[np.float64]

# Instants of a block, which are computed together: every kind of file has the same bits. As text, its numbers
# as objects of Python take some 10 MB.
ROWS = 2048
# Blocks of a group of rows of Parquet, which is compressed by itself: more make smaller files.
GROUP = 16
# Numbers of a column that are copied at a time.
PIECE = 2**19


class Writable(Protocol):
    """Whatever takes text."""

    def write(self, text: str, /) -> object:
        """Take it."""
        ...


def write_csv(stream: Writable, motion: Motion, instants: int | None = None) -> None:
    """Write a motion as CSV; reading a number gives the same bits.

    Args:
        instants: how many, evenly over the motion; its own if not given.
    """
    named = False
    for block in motion.blocks(instants, ROWS):
        each = dict(columns(block))
        if not named:
            stream.write(f"{','.join(each)}\r\n")
            named = True
        stream.write(csv_lines(np.stack(list(each.values()), axis=-1)))


def csv_lines(rows: Array) -> str:
    """Lines of numbers, each in as few digits as give its bits back."""
    # Python's own texts of numbers take four times as long.
    text = to_json(rows.tolist(), inf_nan_mode="constants")
    text = text.removeprefix(b"[[").removesuffix(b"]]").replace(b"],[", b"\r\n")
    if not np.isfinite(rows).all():
        text = text.replace(b"NaN", b"nan").replace(b"Infinity", b"inf")
    return f"{text.decode('ascii')}\r\n"


class AsText:
    """A binary stream that takes text of ASCII."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def write(self, text: str, /) -> None:
        self._stream.write(text.encode("ascii"))


def _csv_file(stream: BinaryIO, motion: Motion, instants: int | None) -> None:
    write_csv(AsText(stream), motion, instants)


def _npz_file(stream: BinaryIO, motion: Motion, instants: int | None) -> None:
    """One member for each column; columns of a motion that is not there as a whole are on disk first."""
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
        if instants is None:
            for name, column in columns(motion):
                npz_member(archive, name, column.shape, "<f8", [column])
            return
        with tempfile.TemporaryFile() as gathered:
            names: tuple[str, ...] = ()
            first = 0
            for block in motion.blocks(instants, ROWS):
                each = dict(columns(block))
                names = tuple(each)
                for i, column in enumerate(each.values()):
                    gathered.seek(8 * (i * instants + first))
                    gathered.write(column.tobytes())
                first += len(block.times)
            gathered.seek(0)
            for name in names:
                npz_member(archive, name, (instants,), "<f8", pieces(gathered, instants))


def npz_member(
    archive: zipfile.ZipFile, name: str, shape: tuple[int, ...], kind: str, parts: Iterable[NDArray[Any]]
) -> None:
    """Write an array part after part, as `numpy.savez` would, which wants all arrays at once."""
    with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
        header = {"descr": kind, "fortran_order": False, "shape": shape}
        np.lib.format.write_array_header_1_0(member, header)
        for part in parts:
            for low in range(0, len(part), PIECE):
                member.write(part[low : low + PIECE].astype(kind, copy=False).tobytes())


def pieces(gathered: BinaryIO, count: int) -> Iterator[Array]:
    """So many numbers of a file, some at a time."""
    left = count
    while left:
        taken = min(left, PIECE)
        yield np.frombuffer(gathered.read(8 * taken))
        left -= taken


def _parquet_file(stream: BinaryIO, motion: Motion, instants: int | None) -> None:
    """Columns of doubles with the names of the CSV."""
    import pyarrow
    import pyarrow.parquet

    writer = None
    blocks = (dict(columns(block)) for block in motion.blocks(instants, ROWS))
    try:
        while group := tuple(islice(blocks, GROUP)):
            table = pyarrow.table({n: np.concatenate([block[n] for block in group]) for n in group[0]})
            if writer is None:
                writer = pyarrow.parquet.ParquetWriter(stream, table.schema, use_dictionary=False)
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()


ENDINGS: Mapping[str, Callable[[BinaryIO, Motion, int | None], None]] = {
    ".csv": _csv_file,
    ".npz": _npz_file,
    ".parquet": _parquet_file,
}


def require_writer(target: str) -> None:
    """Refuse a file that needs a package which is not there, before anything is solved.

    Raises:
        MissingPackage: Parquet needs pyarrow.
    """
    if Path(target).suffix == ".parquet":
        try:
            import_module("pyarrow.parquet")
        except ImportError as error:
            raise MissingPackage(".parquet", error, "parquet") from None


def write_motion(target: str, motion: Motion, instants: int | None = None) -> None:
    """Write a motion by the ending of the target.

    Args:
        instants: how many, evenly over the motion; its own if not given.
    Raises:
        UsageError: the ending is none of `ENDINGS`.
        MissingPackage: Parquet needs pyarrow.
        OutputError: the file cannot be written; what was there is whole.
        NotComputed: instants are given, and the method knows the motion at its own only.
    """
    require_known_ending(target, ENDINGS)
    require_writer(target)
    write = ENDINGS[Path(target).suffix]
    write_whole(target, lambda stream: write(stream, motion, instants))
