"""Named columns as files: CSV, NPZ and Parquet, written block by block.

A block has some rows of every column; however many rows there are, CSV and Parquet take no more memory
than a block.
Motions have a row for each instant. Sweeps have one for each design and instant, with the design's number,
what varies in it, how far its drawing moves to close, and whether it was solved. The numbers of a design that
could not be solved are NaN.
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
from validate.extras import needed
from validate.output.files import require_known_ending, write_whole

Array = NDArray[np.float64]
Block = Mapping[str, NDArray[Any]]
"""By name some rows of each column, along the first axis."""

ENDINGS = (".csv", ".npz", ".parquet")
DESIGN, TIME, CLOSING, STATUS = "design", "time [s]", "closing [mm]", "status"
SOLVED = "solved"
# Rows that are computed or made text of together: every kind of file has the same bits, and as objects of
# Python their numbers take some 10 MB.
ROWS = 2048
PLAIN = re.compile(r'"([^",\\]*)"')  # words that need no quotes in CSV
# Numbers of a sweep's table that are copied at a time.
PIECE = 2**20
# Blocks of a motion in a group of rows of Parquet, which is compressed by itself: more make smaller files.
GROUP = 16


def require_table(target: str) -> None:
    """Refuse a file that cannot be written by its ending, before anything is solved.

    Raises:
        UsageError: it is none of `ENDINGS`. MissingLibrary: Parquet needs pyarrow.
    """
    require_known_ending(target, ENDINGS)
    if Path(target).suffix == ".parquet":
        needed(".parquet", "pyarrow.parquet", "parquet")


def write_table(target: str, blocks: Iterator[Block], group: int = 1) -> None:
    """Write the rows of a motion or of a sweep by the ending of the target.

    Args:
        group: how many blocks make a group of rows of Parquet, `GROUP` for a motion.
    Raises:
        UsageError, MissingLibrary: see `require_table`.
        NotFinished: the file cannot be written; what was there is whole.
        PointcoordError: as the blocks raise it.
    """
    require_table(target)
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
        instants: how many, evenly over the motion; its own if not given.
    Raises:
        NotComputed: instants are given, and the method knows the motion at its own only.
    """
    return (dict(columns(block)) for block in motion.blocks(instants, ROWS))


def rows_of_sweep(blocks: Iterable[Sweep]) -> Iterator[Block]:
    """A row for each design and instant, of some designs at a time."""
    for block in blocks:
        instants, each, numbers = len(block.times), dict(number_columns(block)), block.numbers_of_designs
        varied = {f"{name} [mm]": values for name, values in block.varied.items()}
        before = {DESIGN: numbers, **varied, CLOSING: block.closing}
        failed = (block.failures.get(number) for number in numbers.tolist())
        said = np.array([SOLVED if failure is None else failure.reason for failure in failed])
        some = max(PIECE // (instants * max(len(each), 1)), 1)
        for low in range(0, len(block), some):
            here = slice(low, low + some)
            yield {
                **{name: np.repeat(values[here], instants) for name, values in before.items()},
                TIME: np.tile(block.times, len(said[here])),
                **{name: column[here].ravel() for name, column in each.items()},
                STATUS: np.repeat(said[here], instants),
            }


def csv_lines(blocks: Iterable[Block]) -> Iterator[str]:
    """Rows as CSV, some at a time, the names of the columns first; reading a number gives the same bits."""
    for i, block in enumerate(blocks):
        if not i:
            yield f"{','.join(block)}\r\n"
        for low in range(0, len(next(iter(block.values()))), ROWS):
            yield _lines([column[low : low + ROWS] for column in block.values()])


def _lines(block: list[NDArray[Any]]) -> str:
    """Lines, each number in as few digits as give its bits back."""
    if words := any(column.dtype.kind != "f" for column in block):
        rows = list(zip(*(column.tolist() for column in block), strict=True))
    else:
        rows = np.stack(block, axis=-1).tolist()
    # Python's own texts of numbers take four times as long.
    text = to_json(rows, inf_nan_mode="constants").decode()
    text = text.removeprefix("[[").removesuffix("]]").replace("],[", "\r\n")
    if words:
        text = PLAIN.sub(r"\1", text)
    if not all(np.isfinite(column).all() for column in block if column.dtype.kind == "f"):
        text = text.replace("NaN", "nan").replace("Infinity", "inf")
    return f"{text}\r\n"


def _npz(stream: BinaryIO, blocks: Iterable[Block]) -> None:
    """One member for each column, all of them in memory until they are written."""
    every = [*blocks]
    whole: dict[str, Any] = {name: np.concatenate([block[name] for block in every]) for name in every[0]}
    np.savez(stream, **whole)


def _parquet(stream: BinaryIO, blocks: Iterator[Block], group: int) -> None:
    """Columns with the names of the CSV; so many blocks make a group of rows."""
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
