"""The strut of the paper's table 1 and motions of it, for all tests here."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]


@pytest.fixture(scope="session")
def table() -> dict[str, tuple[float, float, float]]:
    """Table 1 of the paper, mm."""
    return {
        "lower_arm_front": (270.0, -5.0, -10.0),
        "lower_arm_rear": (540.0, -10.0, -20.0),
        "rack_centre": (570.0, 60.0, 90.0),
        "strut_top": (460.0, -180.0, 470.0),
        "lower_ball_joint": (450.0, -330.0, -40.0),
        "tie_rod_outer": (560.0, -300.0, 60.0),
        "strut_lower": (452.0, -320.0, 20.0),
        "strut_rod_end": (456.0, -250.0, 246.0),
        "tie_rod_inner": (570.0, 60.0, 90.0),
        "wheel_centre": (452.0, -410.0, 20.0),
    }


@pytest.fixture(scope="session")
def strut(table: dict[str, tuple[float, float, float]]) -> absolute.Model:
    return absolute.macpherson(table, closure="collinear")


@pytest.fixture(scope="session")
def both() -> Callable[[Array], dict[str, Array]]:
    """Arm and rack moving together: the paper's arm angle and the rack column of its table 3."""

    def inputs(t: Array) -> dict[str, Array]:
        angle = np.stack([0.8 + 0.25 * t + 0.0625 * t**2, 0.25 + 0.125 * t, np.full_like(t, 0.125)], axis=-1)
        rack = np.stack([15 * t + 2.5 * t**2, 15 + 5 * t, np.full_like(t, 5.0)], axis=-1)
        return {"arm_angle": angle, "rack": rack}

    return inputs


@pytest.fixture(scope="session")
def steering() -> Callable[[Array], dict[str, Array]]:
    """The steering scene: arm held at 90 degrees, S = 150 t + 25 t^2 mm."""

    def inputs(t: Array) -> dict[str, Array]:
        rack = np.stack([150 * t + 25 * t**2, 150 + 50 * t, np.full_like(t, 50.0)], axis=-1)
        return {"arm_angle": np.tile([np.pi / 2, 0.0, 0.0], (len(t), 1)), "rack": rack}

    return inputs


@pytest.fixture(scope="session")
def held() -> Callable[[float, float], dict[str, Array]]:
    """One instant at rest."""

    def inputs(angle: float, rack: float) -> dict[str, Array]:
        return {"arm_angle": np.array([[angle, 0.0, 0.0]]), "rack": np.array([[rack, 0.0, 0.0]])}

    return inputs
