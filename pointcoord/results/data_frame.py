"""Samples as a data frame of pandas or polars, where one of them is installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from pointcoord.errors import MissingLibrary, UnknownName
from pointcoord.results.named_columns import columns
from pointcoord.results.samples import Samples

# The first that is installed is taken; each is an extra of the same name.
LIBRARIES = ("pandas", "polars")


def data_frame(samples: Samples, library: str | None = None) -> Any:
    """A row for each instant, a column for each number, named as in the CSV; see `Motion.to_dataframe`."""
    if library is not None and library not in LIBRARIES:
        raise UnknownName("library of data frames", library, LIBRARIES)
    module = _imported(LIBRARIES if library is None else (library,))
    # A frame of its own: what is written into it does not change the samples.
    return module.DataFrame({name: np.array(column) for name, column in columns(samples)})


def _imported(libraries: tuple[str, ...]) -> Any:
    """The first of some libraries that is installed.

    Raises:
        MissingLibrary: none is, or one that is installed does not load.
    """
    for name in libraries:
        try:
            return import_module(name)
        except ModuleNotFoundError as error:
            if error.name != name:
                raise MissingLibrary("a data frame", (name,), f"does not load: {error}") from None
        except ImportError as error:
            raise MissingLibrary("a data frame", (name,), f"does not load: {error}") from None
    raise MissingLibrary("a data frame", libraries)
