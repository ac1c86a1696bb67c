"""The sample cars as flat mechanisms, and inputs that move them about their drawing."""

from __future__ import annotations

from typing import Any

import numpy as np
from mechanism_files import mechanism_file, plain
from numpy.typing import NDArray
from sample_cars import SampleCar

Array = NDArray[np.float64]


def plain_car(car: SampleCar, **points: Any) -> dict[str, Any]:
    """The flat description of a sample car, or of one with other points."""
    part = {"points": {**car.points, **points}, "side": car.side, "closure": car.closure}
    return plain(mechanism_file(car.type), part, ("arm_angle", "rack"))


def swing(car: SampleCar, times: Array, arm: float = 0.1, rack: float = 10.0) -> dict[str, Array]:
    """Both inputs as sines about the drawing: value, rate and acceleration, (N, 3), rad, mm and s."""
    home = car.drawn_inputs
    return {
        "arm_angle": sine(home["arm_angle"], arm, 3.0, times),
        "rack": sine(home["rack"], rack, 2.0, times),
    }


def sine(middle: float, amplitude: float, speed: float, times: Array) -> Array:
    """A sine with its rate and acceleration, (N, 3)."""
    wave, cosine = np.sin(speed * times), np.cos(speed * times)
    values = (middle + amplitude * wave, amplitude * speed * cosine, -amplitude * speed**2 * wave)
    return np.stack(values, axis=-1)
