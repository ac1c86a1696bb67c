"""The sample cars as flat mechanisms."""

from __future__ import annotations

from typing import Any

from mechanism_files import mechanism_file, plain
from sample_cars import SampleCar


def plain_car(car: SampleCar, **points: Any) -> dict[str, Any]:
    """The flat description of a sample car, or of one with other points."""
    part = {"points": {**car.points, **points}, "side": car.side, "closure": car.closure}
    return plain(mechanism_file(car.type), part, ("arm_angle", "rack"))
