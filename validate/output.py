"""Writing results: JSON, CSV and NPZ, to a file or to standard output."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion

Array = NDArray[np.float64]


class OutputError(Exception):
    """A result cannot be written where it was asked for."""

    def __init__(self, target: str, problem: str) -> None:
        self.target = target
        super().__init__(f"{target}: {problem}")


def write_json(target: str, data: Any) -> None:
    """Write JSON to a file, or to standard output for `-`.

    Raises:
        OutputError: the file cannot be written.
    """
    text = json.dumps(data, indent=1, allow_nan=False) + "\n"
    if target == "-":
        sys.stdout.write(text)
        return
    try:
        Path(target).write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(target, f"cannot be written ({error.strerror})") from None


def columns(motion: Motion) -> Iterator[tuple[str, Array]]:
    """Every computed number of a motion as a named column with its unit."""
    yield "time [s]", motion.times
    vectors = (
        (motion.position, "position", "mm"),
        (motion.velocity, "velocity", "mm/s"),
        (motion.acceleration, "acceleration", "mm/s^2"),
        (motion.angular_velocity, "angular_velocity", "rad/s"),
        (motion.angular_acceleration, "angular_acceleration", "rad/s^2"),
    )
    for channel, quantity, unit in vectors:
        for name in channel:
            for i, axis in enumerate("xyz"):
                yield f"{quantity}.{name}.{axis} [{unit}]", channel[name][:, i]
    for name in motion.wheel:
        yield f"wheel.{name} [deg]", np.degrees(motion.wheel[name])


def write_motion(target: str | None, motion: Motion) -> None:
    """Write a motion as .csv or .npz by the ending of the target, or as CSV to standard output for None.

    Numbers are written so that reading them gives the same bits.

    Raises:
        OutputError: the ending is another one, or the file cannot be written.
    """
    if target is None:
        _write_csv(sys.stdout, motion)
        return
    try:
        if target.endswith(".npz"):
            with open(target, "wb") as binary:
                arrays: dict[str, Any] = dict(columns(motion))
                np.savez(binary, **arrays)
        elif target.endswith(".csv"):
            with open(target, "w", newline="", encoding="utf-8") as stream:
                _write_csv(stream, motion)
        else:
            raise OutputError(target, "has no known ending; allowed: .csv, .npz")
    except OSError as error:
        raise OutputError(target, f"cannot be written ({error.strerror})") from None


def _write_csv(stream: TextIO, motion: Motion) -> None:
    named = dict(columns(motion))
    writer = csv.writer(stream)
    writer.writerow(named)
    writer.writerows(zip(*(map(repr, column.tolist()) for column in named.values()), strict=True))
