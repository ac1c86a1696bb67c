"""Curves of a file that `sweep`, `simulate` or `table` wrote: its columns are numbers, its designs curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import number_called
from validate.curves.numbers import TIME, Number
from validate.measured.reading import name_and_unit, read_columns
from validate.output.columns import DESIGN, STATUS
from validate.plain_text import shown
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Table = Mapping[tuple[str, str], Array]
"""By name and unit of a column its rows, (N,)."""

MOST = 400  # curves of designs: more cover each other, and evenly as many are drawn
CLOSING = "closing"


@dataclass(frozen=True)
class Written:
    """The numbers of a file.

    Attributes:
        numbers: its columns. values: by their paths, (N,), or (N, D) of the designs of a sweep.
        varied: what designs differ by, as columns of the file; empty of one motion.
        designs: how many there are; more than curves where some are left out.
    """

    numbers: tuple[Number, ...]
    values: Mapping[tuple[str, ...], Array]
    varied: tuple[Number, ...] = ()
    designs: int = 1

    @property
    def curves(self) -> int:
        """How many designs have a curve."""
        return max((array.shape[1] for array in self.values.values() if array.ndim == 2), default=1)

    @property
    def across(self) -> Number:
        """What its numbers are usually drawn over: time, or what designs of one instant differ by."""
        time = [number for number in self.numbers if number.path == (TIME,)]
        one_instant = self.values[self.numbers[0].path].ndim == 1
        return (*(self.varied if one_instant else ()), *time, *self.numbers)[0]

    @property
    def angles(self) -> tuple[Number, ...]:
        """The wheel's angles, or those of a table."""
        of_a_wheel = [number for number in self.numbers if number.path[0] == "wheel"]
        every = of_a_wheel or [number for number in self.numbers if number.unit == "deg"]
        return tuple(number for number in every if number != self.across)


def read_written(path: str) -> Written:
    """The numbers of a file by its ending: CSV, NPZ or Parquet.

    Raises:
        FileError: it cannot be read, or is no table of numbers.
    """
    table = _of_npz(path) if Path(path).suffix == ".npz" else _of_columns(path)
    heads = [head for head in table if head[0] not in (DESIGN, STATUS)]
    found = {head: _number(*head) for head in heads}
    design = next((rows for (name, _), rows in table.items() if name == DESIGN), np.zeros(0))
    each, counts = np.unique(design, return_counts=True)
    if not len(each):
        return Written(tuple(found.values()), {found[head].path: table[head] for head in heads})
    names = [head[0] for head in heads]
    before = names.index(TIME) if TIME in names else 0
    varied = tuple(found[head] for head in heads[:before] if head[0] != CLOSING)
    if (counts == counts[0]).all() and counts[0] > 1:
        # A column of a matrix for each design that is drawn.
        drawn = np.unique(np.linspace(0, len(each) - 1, min(len(each), MOST)).astype(np.intp))
        rows = np.argsort(design, kind="stable").reshape(len(each), -1)[drawn].T
    else:
        rows = np.arange(len(design))
    values = {found[head].path: table[head][rows] for head in heads}
    return Written(tuple(found.values()), values, varied, len(each))


def _number(name: str, unit: str) -> Number:
    path = tuple(name.split("."))
    known = number_called(path[-1])
    words, sign = (name, "") if known is None else (known.words, known.sign)
    return Number(path, words, unit, sign, _unread)


def _of_columns(path: str) -> Table:
    columns = read_columns(path)
    return dict(zip(zip(columns.names, columns.units, strict=True), columns.values, strict=True))


def _of_npz(path: str) -> Table:
    """Arrays by design and instant as rows; what belongs to a design is there at each instant."""
    try:
        with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as archive:
            found = {name_and_unit(name): np.asarray(array) for name, array in archive.items()}
    except OSError as error:
        raise FileError(
            shown(path), "", f"cannot be read ({error.strerror})", "the path of a table"
        ) from None
    except Exception:  # what reading other bytes ends with is numpy's affair, and zipfile's
        problem = "is no npz file, or a damaged one"
        raise FileError(shown(path), "", problem, "a file of simulate or sweep") from None
    shape = max((array.shape for array in found.values()), key=len, default=())
    rows = {}
    for head, array in found.items():
        of_a_design = len(shape) == 2 and array.ndim == 1 and head[0] != TIME
        try:
            whole = np.broadcast_to(array[:, None] if of_a_design else array, shape)
        except ValueError:
            whole = np.zeros(())
        if whole.ndim not in (1, 2):
            raise FileError(shown(path), "", "holds no columns of numbers", "a file of simulate or sweep")
        if array.dtype.kind in "iuf":
            rows[head] = np.ravel(whole).astype(float)
    return rows


def _unread(*_: object) -> Array:
    raise AssertionError("the numbers of a file are in `values`")
