"""A sweep as a table: CSV, NPZ and Parquet, written block by block.

CSV and Parquet have a row for each design and instant: the design's number and what varies in it, the time,
every number that the scene asks for, and whether the design was solved. NPZ has arrays instead, (designs,
instants) of numbers and (designs,) of what belongs to a design. The numbers of a design that could not be
solved are NaN.
"""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from pointcoord import Sweep
from pointcoord.results.named_columns import number_columns
from validate.output.files import require_known_ending, write_whole
from validate.output.motion_tables import (
    AsText,
    Writable,
    csv_lines,
    npz_member,
    pieces,
    require_writer,
)

Array = NDArray[np.float64]
Blocks = Iterable[Sweep]

SOLVED = "solved"
DESIGN, TIME, CLOSING, STATUS = "design", "time [s]", "closing [mm]", "status"
# Rows of text that are made at a time, whose numbers as objects of Python take some 10 MB, and numbers of a
# table that are copied at a time.
ROWS, PIECE = 2048, 2**20


def status_of(block: Sweep, number: int) -> str:
    """What a table says of a design: that it was solved, or the reason why not."""
    failure = block.failures.get(number)
    return SOLVED if failure is None else failure.reason


def write_csv(stream: Writable, blocks: Blocks) -> None:
    """Write a sweep as CSV; reading a number gives the same bits."""
    named = False
    for block in blocks:
        each = dict(number_columns(block))
        varied = {f"{name} [mm]": values for name, values in block.varied.items()}
        if not named:
            stream.write(",".join((DESIGN, *varied, TIME, *each, STATUS)) + "\r\n")
            named = True
        for place, number in enumerate(block.numbers_of_designs.tolist()):
            before = ",".join((str(number), *(repr(float(values[place])) for values in varied.values())))
            after = status_of(block, number)
            after = f'"{after}"' if "," in after else after
            for low in range(0, len(block.times), ROWS):
                some = slice(low, low + ROWS)
                rows = (block.times[some], *(column[place, some] for column in each.values()))
                lines = csv_lines(np.stack(rows, axis=-1)).removesuffix("\r\n")
                text = lines.replace("\r\n", f",{after}\r\n{before},")
                stream.write(f"{before},{text},{after}\r\n")


def _csv_file(stream: BinaryIO, blocks: Blocks, count: int) -> None:
    write_csv(AsText(stream), blocks)


def _npz_file(stream: BinaryIO, blocks: Blocks, count: int) -> None:
    """One array for each column; those of numbers are gathered on disk, because they come by design."""
    with (
        zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED, allowZip64=True) as archive,
        tempfile.TemporaryFile() as gathered,
    ):
        names: tuple[str, ...] = ()
        times = np.empty(0)
        of_designs: dict[str, list[Array]] = {}
        reasons: dict[str, int] = {SOLVED: 0}
        codes: list[NDArray[np.uint16]] = []
        for block in blocks:
            each, times = dict(number_columns(block)), block.times
            names, own = tuple(each), 8 * len(times)
            for i, column in enumerate(each.values()):
                gathered.seek(own * (i * count + block.first))
                for array in column:
                    gathered.write(array.tobytes())
            varied = {f"{name} [mm]": values for name, values in block.varied.items()}
            for name, values in {**varied, CLOSING: block.closing}.items():
                of_designs.setdefault(name, []).append(values)
            said = (status_of(block, number) for number in block.numbers_of_designs.tolist())
            codes.append(np.array([reasons.setdefault(one, len(reasons)) for one in said], dtype=np.uint16))
        npz_member(archive, DESIGN, (count,), "<i8", [np.arange(count)])
        for name, values_of_blocks in of_designs.items():
            npz_member(archive, name, (count,), "<f8", values_of_blocks)
        words = np.array(list(reasons))
        npz_member(archive, STATUS, (count,), words.dtype.str, (words[code] for code in codes))
        npz_member(archive, TIME, times.shape, "<f8", [times])
        gathered.seek(0)
        for name in names:
            npz_member(archive, name, (count, len(times)), "<f8", pieces(gathered, count * len(times)))


def _parquet_file(stream: BinaryIO, blocks: Blocks, count: int) -> None:
    """Columns with the names of the CSV: doubles, and a word for each design."""
    import pyarrow
    import pyarrow.parquet

    writer = None
    try:
        for block in blocks:
            for columns in _long(block):
                table = pyarrow.table(
                    {
                        name: pyarrow.array(column).dictionary_encode() if name == STATUS else column
                        for name, column in columns.items()
                    }
                )
                if writer is None:
                    writer = pyarrow.parquet.ParquetWriter(stream, table.schema, use_dictionary=[STATUS])
                writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()


def _long(block: Sweep) -> Iterator[dict[str, NDArray[Any]]]:
    """Some designs of a block at a time as columns of a table, a row for each design and instant."""
    instants, each = len(block.times), dict(number_columns(block))
    numbers = block.numbers_of_designs
    said = np.array([status_of(block, number) for number in numbers.tolist()])
    some = max(PIECE // (instants * max(len(each), 1)), 1)
    for low in range(0, len(block), some):
        here = slice(low, low + some)
        of_designs = {DESIGN: numbers, **{f"{name} [mm]": values for name, values in block.varied.items()}}
        yield {
            **{name: np.repeat(values[here], instants) for name, values in of_designs.items()},
            TIME: np.tile(block.times, len(numbers[here])),
            **{name: column[here].ravel() for name, column in each.items()},
            STATUS: np.repeat(said[here], instants),
        }


ENDINGS: Mapping[str, Callable[[BinaryIO, Blocks, int], None]] = {
    ".csv": _csv_file,
    ".npz": _npz_file,
    ".parquet": _parquet_file,
}


def write_sweep(target: str, blocks: Blocks, count: int) -> None:
    """Write a sweep by the ending of the target.

    Args:
        count: how many designs there are in all blocks.
    Raises:
        UsageError: the ending is none of `ENDINGS`.
        MissingPackage: Parquet needs pyarrow.
        OutputError: the file cannot be written; what was there is whole.
        PointcoordError: as the blocks raise it.
    """
    require_known_ending(target, ENDINGS)
    require_writer(target)
    write = ENDINGS[Path(target).suffix]
    write_whole(target, lambda stream: write(stream, blocks, count))
