"""The numbers of samples as named columns with their units, as tables and files have them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.results.samples import Samples

Array = NDArray[np.float64]


def columns(samples: Samples) -> Iterator[tuple[str, Array]]:
    """The times of samples, and every computed number as a named column with its unit."""
    yield "time [s]", samples.times
    yield from number_columns(samples)


def number_columns(samples: Samples) -> Iterator[tuple[str, Array]]:
    """Every computed number of samples as a named column with its unit, (..., N)."""
    for quantity, channel in samples.numbers.items():
        unit = QUANTITIES[quantity].unit
        for name, array in channel.items():
            if unit == "rad":
                # Users read angles in degrees.
                yield f"{quantity}.{name} [deg]", np.degrees(array)
            elif QUANTITIES[quantity].of == "car":
                yield f"{quantity}.{name} [{unit}]", array
            else:
                for i, axis in enumerate("xyz"):
                    yield f"{quantity}.{name}.{axis} [{unit}]", array[..., i]
