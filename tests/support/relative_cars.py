"""The sample cars as relative-coordinate models, and inputs that move them about their drawing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sample_cars import SampleCar

from validate.relative.model import Model, build

Array = NDArray[np.float64]


def model_of(car: SampleCar) -> Model:
    """The model of a sample car."""
    return build(car.type, car.points, side=car.side, closure=car.closure)


def swing(car: SampleCar, times: Array, arm: float = 0.1, rack: float = 10.0) -> dict[str, Array]:
    """Both inputs as sines about the drawing: value, rate and acceleration, (N, 3), rad, mm and s."""
    home = car.drawn_inputs
    return {
        "arm_angle": _sine(home["arm_angle"], arm, 3.0, times),
        "rack": _sine(home["rack"], rack, 2.0, times),
    }


def _sine(middle: float, amplitude: float, speed: float, times: Array) -> Array:
    sine, cosine = np.sin(speed * times), np.cos(speed * times)
    values = (middle + amplitude * sine, amplitude * speed * cosine, -amplitude * speed**2 * sine)
    return np.stack(values, axis=-1)
