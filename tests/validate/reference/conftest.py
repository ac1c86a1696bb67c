"""A car of each linkage, and mpmath set to more digits than any result carries."""

from __future__ import annotations

from collections.abc import Iterator

import mpmath
import pytest
from mechanism_drawings import CARS, ReferenceCar


@pytest.fixture(scope="session", params=CARS)
def car(request: pytest.FixtureRequest) -> ReferenceCar:
    """A car of each linkage in turn."""
    return CARS[request.param]


@pytest.fixture(scope="session", autouse=True)
def _many_digits() -> Iterator[None]:
    with mpmath.workdps(150):
        yield
