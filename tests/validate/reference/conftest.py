"""A car of each mechanism; mpmath has more digits than any result."""

from __future__ import annotations

from collections.abc import Iterator

import mpmath
import pytest
from mechanism_drawings import CARS, ReferenceCar


@pytest.fixture(scope="session", params=CARS)
def car(request: pytest.FixtureRequest) -> ReferenceCar:
    """One car of each mechanism."""
    return CARS[request.param]


@pytest.fixture(scope="session", autouse=True)
def _many_digits() -> Iterator[None]:
    with mpmath.workdps(150):
        yield
