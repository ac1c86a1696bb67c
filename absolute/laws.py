"""How the value of an input becomes the coordinate it drives."""

import math
from collections.abc import Callable
from typing import NamedTuple


class Law(NamedTuple):
    """A function of one input value.

    Attributes:
        expand: value -> (f, df/dvalue, d2f/dvalue2).
        invert: coordinate / factor -> value, for the drawing's own input.
    """

    expand: Callable[[float], tuple[float, float, float]]
    invert: Callable[[float], float]


def _cosine(angle: float) -> tuple[float, float, float]:
    cosine = math.cos(angle)
    return cosine, -math.sin(angle), -cosine


_LINEAR = Law(lambda value: (value, 1.0, 0.0), lambda ratio: ratio)

LAWS = {
    # coordinate = factor * value, value in mm, or in rad for a turn
    "linear": _LINEAR,
    "distance": _LINEAR,
    "turn": _LINEAR,
    # coordinate = factor * cos(value), value in rad, factor in mm
    "cosine": Law(_cosine, lambda ratio: math.acos(max(-1.0, min(1.0, ratio)))),
}
