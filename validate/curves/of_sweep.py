"""Reads a file that `sweep` or `simulate` wrote, and finds its columns by short names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from validate.errors import UsageError
from validate.plain_text import shown, some_of

NAMED = 8  # largest number of columns listed in a message


def read_sweep(path: str) -> pd.DataFrame:
    """The columns of numbers of a file; its ending gives the format.

    Raises:
        UsageError: the file cannot be read as a table.
    """
    read = {".csv": pd.read_csv, ".parquet": pd.read_parquet, ".npz": _of_npz}[Path(path).suffix]
    try:
        table = read(path)
    # For damaged files numpy, pandas and zipfile raise many kinds of errors.
    except Exception as error:
        allowed = "a file that pointcoord sweep or simulate wrote"
        raise UsageError(f"{shown(path)} is not a table ({shown(str(error))}); allowed: {allowed}") from None
    return table.select_dtypes("number")


def _of_npz(path: str) -> pd.DataFrame:
    with np.load(path, allow_pickle=False) as archive:
        return pd.DataFrame(dict(archive))


def columns_called(table: pd.DataFrame, words: Sequence[str]) -> list[str]:
    """The columns with given names. A name is compared without the unit; it may be a part between dots.

    Raises:
        UsageError: a name fits no column.
    """
    found, plain_names = [], {str(name): str(name).partition(" [")[0] for name in table}
    for word in words:
        whole = [name for name, own in plain_names.items() if word in (name, own)]
        part = [n for n, own in plain_names.items() if f".{word}." in f".{own}."]
        if not (whole or part):
            there = some_of([*plain_names.values()], NAMED)
            raise UsageError(f"{shown(word)} names no column of the file; allowed: {there}")
        found += whole or part
    return list(dict.fromkeys(found))
