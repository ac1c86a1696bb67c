"""Curves of a file that `sweep` or `simulate` wrote: its columns over each other, a curve for each design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validate.errors import UsageError
from validate.extras import not_there
from validate.output.columns import DESIGN
from validate.output.figure import SETTINGS, panels
from validate.plain_text import shown, some_of

try:
    import matplotlib as mpl
    import pandas as pd
    from matplotlib.figure import Figure
except ImportError as error:
    raise not_there("validate.curves.of_sweep", error, "plot") from None

NAMED = 8  # columns, in a message
MOST = 400  # curves: more cover each other, and evenly as many are drawn
SHADES = "viridis"  # from dark to light, by design


def read_sweep(path: str) -> pd.DataFrame:
    """The table of a file, by its ending.

    Raises:
        UsageError: it cannot be read, or has no numbers.
    """
    read = {".csv": pd.read_csv, ".parquet": pd.read_parquet, ".npz": _of_npz}[Path(path).suffix]
    try:
        table = read(path)
    # What other bytes end with is numpy's affair, pandas' and zipfile's.
    except Exception as error:
        allowed = "a file that pointcoord sweep or simulate wrote"
        raise UsageError(f"{shown(path)} is no table ({shown(str(error))}); give {allowed}") from None
    return table.select_dtypes("number")


def _of_npz(path: str) -> pd.DataFrame:
    with np.load(path, allow_pickle=False) as archive:
        return pd.DataFrame(dict(archive))


def columns_called(table: pd.DataFrame, words: Sequence[str]) -> list[str]:
    """The columns whose names, but for the unit, are some words or have them among their parts.

    Raises:
        UsageError: there is none.
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


@mpl.rc_context(SETTINGS)
def figure_of(table: pd.DataFrame, across: str, up: Sequence[str], title: str) -> Figure:
    """A panel for each column that goes upward, a curve for each design."""
    designs = [table] if DESIGN not in table else [one for _, one in table.groupby(DESIGN)]
    chosen = np.unique(np.linspace(0, len(designs) - 1, min(len(designs), MOST)).round().astype(int))
    page, grid = panels((5.5, 2.2 * len(up) + 0.8), title, len(up), 1, sharex=True)
    for axes, column in zip(grid, up, strict=True):
        for place in chosen.tolist():
            shade = mpl.colormaps[SHADES](place / max(len(designs) - 1, 1))
            axes.plot(designs[place][across], designs[place][column], color=shade, linewidth=1.0)
        axes.set_ylabel(shown(column), parse_math=False)
    grid[-1].set_xlabel(shown(across), parse_math=False)
    return page
