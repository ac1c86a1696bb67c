"""Named columns as files: CSV, NPZ and Parquet, written block by block.

A block has some rows of every column. CSV and Parquet need the memory of one block, however many rows there
are. A motion has a row for each instant. A sweep has a row for each design and instant, with the design's
number, its varied coordinates, how far its drawing moves to close, and its status. The numbers of a design
that could not be solved are NaN.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from pointcoord import Motion, Sweep
from pointcoord.results.named_columns import columns, number_columns
from validate.output.console import Console
from validate.output.files import write_whole

Block = Mapping[str, NDArray[Any]]
"""Some rows of each column, by name; the rows are along the first axis."""

ENDINGS = (".csv", ".npz", ".parquet")
DESIGN, TIME, CLOSING, STATUS = "design", "time [s]", "closing [mm]", "status"
SOLVED = "solved"
# Rows that are computed or converted to text together. The size is the same for every file format, so that
# the numbers have the same bits in each; as Python objects they take some 10 MB.
ROWS = 2048
PLAIN = re.compile(r'"([^",\\]*)"')  # words that need no quotes in CSV
# Numbers of a sweep's table that are copied at a time.
PIECE = 2**20
# Blocks of a motion in a row group of Parquet. A row group is compressed alone: larger ones save space.
GROUP = 16


def put_table(target: str, blocks: Iterator[Block], what: str, console: Console, group: int = 1) -> None:
    """Write the rows of a motion or of a sweep: as CSV on standard output for `-`, otherwise as a file.

    Args:
        what: the rows in words, such as `the motion`.
        group: number of blocks in a row group of Parquet, `GROUP` for a motion.
    Raises:
        NotFinished: the rows cannot be written; an old file is kept unchanged.
        PointcoordError: raised by the blocks as they are solved.
    """
    if target == "-":
        for text in csv_lines(blocks):
            console.write(text)
    else:
        write_table(target, blocks, group)
        console.written[target] = what


def write_table(target: str, blocks: Iterator[Block], group: int = 1) -> None:
    """Write a file of rows, one of `ENDINGS`; see `put_table`."""
    ending = Path(target).suffix

    def write(stream: BinaryIO) -> None:
        if ending == ".csv":
            stream.writelines(text.encode() for text in csv_lines(blocks))
        elif ending == ".npz":
            _npz(stream, blocks)
        else:
            _parquet(stream, blocks, group)

    write_whole(target, write)


def rows_of_motion(motion: Motion, instants: int | None = None) -> Iterator[Block]:
    """A row for each instant.

    Args:
        instants: number of evenly spaced instants; the motion's own instants if not given.
    Raises:
        NotComputed: instants are given, but the method has solved the motion at its own instants only.
    """
    return (dict(columns(block)) for block in motion.blocks(instants, ROWS))


def rows_of_sweep(blocks: Iterable[Sweep]) -> Iterator[Block]:
    """A row for each design and instant; each block has some designs."""
    for block in blocks:
        instants, each, numbers = len(block.times), dict(number_columns(block)), block.numbers_of_designs
        varied = {f"{name} [mm]": values for name, values in block.varied.items()}
        before = {DESIGN: numbers, **varied, CLOSING: block.closing}
        failed = (block.failures.get(number) for number in numbers.tolist())
        status = np.array([SOLVED if failure is None else failure.reason for failure in failed])
        some = max(PIECE // (instants * max(len(each), 1)), 1)
        for low in range(0, len(block), some):
            here = slice(low, low + some)
            yield {
                **{name: np.repeat(values[here], instants) for name, values in before.items()},
                TIME: np.tile(block.times, len(status[here])),
                **{name: column[here].ravel() for name, column in each.items()},
                STATUS: np.repeat(status[here], instants),
            }


def csv_lines(blocks: Iterable[Block]) -> Iterator[str]:
    """CSV text, some rows at a time, the header first; a number read back has the same bits."""
    for i, block in enumerate(blocks):
        if not i:
            yield f"{','.join(block)}\r\n"
        for low in range(0, len(next(iter(block.values()))), ROWS):
            yield _lines([column[low : low + ROWS] for column in block.values()])


def _lines(block: list[NDArray[Any]]) -> str:
    """CSV lines; each number has the fewest digits that give its bits when read back."""
    if words := any(column.dtype.kind != "f" for column in block):
        rows = list(zip(*(column.tolist() for column in block), strict=True))
    else:
        rows = np.stack(block, axis=-1).tolist()
    # Python's `repr` of the numbers would take four times as long.
    text = to_json(rows, inf_nan_mode="constants").decode()
    text = text.removeprefix("[[").removesuffix("]]").replace("],[", "\r\n")
    if words:
        text = PLAIN.sub(r"\1", text)
    if not all(np.isfinite(column).all() for column in block if column.dtype.kind == "f"):
        text = text.replace("NaN", "nan").replace("Infinity", "inf")
    return f"{text}\r\n"


def _npz(stream: BinaryIO, blocks: Iterable[Block]) -> None:
    """One array for each column; all rows are in memory until they are written."""
    every = [*blocks]
    whole: dict[str, Any] = {name: np.concatenate([block[name] for block in every]) for name in every[0]}
    np.savez(stream, **whole)


def _parquet(stream: BinaryIO, blocks: Iterator[Block], group: int) -> None:
    """Columns with the names of the CSV; `group` blocks make a row group."""
    import pyarrow
    import pyarrow.parquet

    writer = None
    try:
        while some := tuple(islice(blocks, group)):
            whole = {name: np.concatenate([block[name] for block in some]) for name in some[0]}
            words = [name for name, column in whole.items() if column.dtype.kind == "U"]
            table = pyarrow.table(
                whole | {name: pyarrow.array(whole[name]).dictionary_encode() for name in words}
            )
            writer = writer or pyarrow.parquet.ParquetWriter(stream, table.schema, use_dictionary=words)
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()
