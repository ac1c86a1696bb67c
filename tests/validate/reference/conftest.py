"""The paper's Table 1, and mpmath set to more digits than any result carries."""

from __future__ import annotations

from collections.abc import Iterator

import mpmath
import pytest

TABLE_1 = {
    "lower_arm_front": (270, -5, -10),
    "lower_arm_rear": (540, -10, -20),
    "rack_centre": (570, 60, 90),
    "strut_top": (460, -180, 470),
    "lower_ball_joint": (450, -330, -40),
    "tie_rod_outer": (560, -300, 60),
    "strut_lower": (452, -320, 20),
    "strut_rod_end": (456, -250, 246),
    "tie_rod_inner": (570, 60, 90),
    "wheel_centre": (452, -410, 20),
}


@pytest.fixture(scope="session")
def table() -> dict[str, tuple[int, int, int]]:
    """Table 1, mm, left wheel."""
    return dict(TABLE_1)


@pytest.fixture(scope="session", autouse=True)
def _many_digits() -> Iterator[None]:
    with mpmath.workdps(150):
        yield
