"""A motion as a table of named columns: CSV and NPZ."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from pointcoord.effects.registry import QUANTITIES
from validate.output.files import require_known_ending, write_whole

Array = NDArray[np.float64]


class Writable(Protocol):
    """Whatever takes text."""

    def write(self, text: str, /) -> object:
        """Take it."""
        ...


def columns(motion: Motion) -> Iterator[tuple[str, Array]]:
    """Every computed number of a motion as a named column with its unit."""
    yield "time [s]", motion.times
    for quantity, channel in motion.numbers.items():
        unit = QUANTITIES[quantity].unit
        for name, array in channel.items():
            if unit == "rad":
                # Users read angles in degrees.
                yield f"{quantity}.{name} [deg]", np.degrees(array)
            elif array.ndim == 1:
                yield f"{quantity}.{name} [{unit}]", array
            else:
                for i, axis in enumerate("xyz"):
                    yield f"{quantity}.{name}.{axis} [{unit}]", array[:, i]


def write_csv(stream: Writable, motion: Motion) -> None:
    """Write a motion as CSV; reading a number gives the same bits."""
    named = dict(columns(motion))
    writer = csv.writer(stream)
    writer.writerow(named)
    writer.writerows(zip(*(map(repr, column.tolist()) for column in named.values()), strict=True))


def _csv_file(stream: BinaryIO, motion: Motion) -> None:
    text = io.TextIOWrapper(stream, encoding="ascii", newline="")
    write_csv(text, motion)
    # The stream stays open for the one who opened it.
    text.detach()


def _npz_file(stream: BinaryIO, motion: Motion) -> None:
    arrays: dict[str, Any] = dict(columns(motion))
    np.savez(stream, **arrays)


ENDINGS: dict[str, Callable[[BinaryIO, Motion], None]] = {".csv": _csv_file, ".npz": _npz_file}


def write_motion(target: str, motion: Motion) -> None:
    """Write a motion by the ending of the target.

    Raises:
        UnknownEnding: the ending is another one than .csv or .npz.
        OutputError: the file cannot be written; what was there is whole.
    """
    require_known_ending(target, ENDINGS)
    write_whole(target, lambda stream: ENDINGS[Path(target).suffix.lower()](stream, motion))
