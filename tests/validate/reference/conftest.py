"""The paper's Table 1, and mpmath set to more digits than any result carries."""

from __future__ import annotations

from collections.abc import Iterator

import mpmath
import pytest
from reference_cars import CARS, TABLE_1, ReferenceCar


@pytest.fixture(scope="session")
def table() -> dict[str, tuple[int, int, int]]:
    """Table 1, mm, left wheel."""
    return dict(TABLE_1)


@pytest.fixture(scope="session", params=CARS)
def car(request: pytest.FixtureRequest) -> ReferenceCar:
    """A car of each linkage in turn."""
    return CARS[request.param]


@pytest.fixture(scope="session", autouse=True)
def _many_digits() -> Iterator[None]:
    with mpmath.workdps(150):
        yield
