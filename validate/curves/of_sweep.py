"""Reads a file that `sweep` or `simulate` wrote, and finds its columns by short names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from validate.curves.numbers import fitting
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
        return read(path).select_dtypes("number")
    # For damaged files numpy, pandas and zipfile raise many kinds of errors.
    except Exception as error:
        allowed = "a file that pointcoord sweep or simulate wrote"
        raise UsageError(f"{shown(path)} is not a table ({shown(str(error))}); allowed: {allowed}") from None


def _of_npz(path: str) -> pd.DataFrame:
    with np.load(path, allow_pickle=False) as archive:
        return pd.DataFrame(dict(archive))


def columns_called(table: pd.DataFrame, words: Sequence[str]) -> list[str]:
    """The columns with given names, each once, see `fitting`; a name may lack the unit.

    Raises:
        UsageError: a name fits no column.
    """
    found, plain = list[str](), {str(name): str(name).partition(" [")[0] for name in table}
    for word in words:
        names = fitting(word.partition(" [")[0], plain.values())
        if not names:
            there = some_of([*plain.values()], NAMED)
            raise UsageError(f"{shown(word)} names no column of the file; allowed: {there}")
        found += [name for name, own in plain.items() if own in names]
    return list(dict.fromkeys(found))
