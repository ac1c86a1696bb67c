"""Every suspension, and the strut of the paper's table 1 with motions of it, for all tests here."""

from collections.abc import Callable

import numpy as np
import pytest
import struts
from flat import built_in
from kinds import KINDS, Kind
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]


@pytest.fixture(scope="session", params=KINDS.values(), ids=KINDS)
def kind(request: pytest.FixtureRequest) -> Kind:
    """Every suspension in turn."""
    found: Kind = request.param
    return found


@pytest.fixture(scope="session")
def model(kind: Kind) -> absolute.Model:
    """Its car of whole numbers."""
    return kind.build(kind.car)


@pytest.fixture(scope="session")
def table() -> dict[str, tuple[float, float, float]]:
    """Table 1 of the paper, mm."""
    return struts.TABLE


@pytest.fixture(scope="session")
def strut(table: dict[str, tuple[float, float, float]]) -> absolute.Model:
    return built_in("macpherson", table, closure="collinear")


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
