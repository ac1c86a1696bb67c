"""The numbers of samples as columns with names and units, for tables, files and data frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape
from importlib import import_module
from typing import Any

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from pointcoord.errors import MissingLibrary, UnknownName
from pointcoord.numerics.arrays import Array
from pointcoord.results.samples import Samples

# The first installed one is used; each is an extra of the same name.
LIBRARIES = ("pandas", "polars")


def columns(samples: Samples) -> Iterator[tuple[str, Array]]:
    """The times of samples, and every computed number as a named column with its unit."""
    yield "time [s]", samples.times
    yield from number_columns(samples)


def number_columns(samples: Samples) -> Iterator[tuple[str, Array]]:
    """Every computed number of samples as a named column with its unit, (..., N)."""
    for quantity, channel in samples.numbers.items():
        unit = QUANTITIES[quantity].unit
        for name, array in channel.items():
            if unit.startswith("rad") and QUANTITIES[quantity].of == "car":
                # Users read angles in degrees.
                yield f"{quantity}.{name} [{unit.replace('rad', 'deg', 1)}]", np.degrees(array)
            elif QUANTITIES[quantity].of == "car":
                yield f"{quantity}.{name} [{unit}]", array
            else:
                for i, axis in enumerate("xyz"):
                    yield f"{quantity}.{name}.{axis} [{unit}]", array[..., i]


def data_frame(samples: Samples, library: str | None = None) -> Any:
    """A row for each instant, a column for each number, named as in the CSV; see `Motion.to_dataframe`."""
    if library is not None and library not in LIBRARIES:
        raise UnknownName("library of data frames", library, LIBRARIES)
    module = _imported(LIBRARIES if library is None else (library,))
    # The frame has copies: writing into the frame does not change the samples.
    return module.DataFrame({name: np.array(column) for name, column in columns(samples)})


def _imported(libraries: tuple[str, ...]) -> Any:
    """The first of some libraries that is installed.

    Raises:
        MissingLibrary: none is installed, or an installed one does not load.
    """
    for name in libraries:
        try:
            return import_module(name)
        except ImportError as error:
            if not isinstance(error, ModuleNotFoundError) or error.name != name:
                raise MissingLibrary("a data frame", (name,), f"does not load: {error}") from None
    raise MissingLibrary("a data frame", libraries)


def html_table(caption: str, head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """An HTML table with a caption, for a notebook; all text is escaped.

    >>> html_table("<a>", ["x"], [["1"]])
    '<table><caption>&lt;a&gt;</caption><tr><th>x</th></tr><tr><td>1</td></tr></table>'
    """
    lines = ["".join(f"<th>{escape(name)}</th>" for name in head)]
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    return (
        f"<table><caption>{escape(caption)}</caption>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"
    )
