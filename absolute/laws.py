"""How the value of an input becomes the coordinate it drives."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from absolute.solution import Array


class Law(NamedTuple):
    """A function of one input value.

    Attributes:
        expand: values -> (f, df/dvalue, d2f/dvalue2).
        invert: coordinate / factor -> value, for the drawing's own input.
    """

    expand: Callable[[Array], tuple[Array, Array, Array]]
    invert: Callable[[float], float]


def _linear(value: Array) -> tuple[Array, Array, Array]:
    return value, np.ones_like(value), np.zeros_like(value)


def _cosine(angle: Array) -> tuple[Array, Array, Array]:
    cosine = np.cos(angle)
    return cosine, -np.sin(angle), -cosine


_LINEAR = Law(_linear, lambda ratio: ratio)

LAWS = {
    # coordinate = factor * value, value in mm, or in rad for a turn
    "linear": _LINEAR,
    "distance": _LINEAR,
    "turn": _LINEAR,
    # coordinate = factor * cos(value), value in rad, factor in mm
    "cosine": Law(_cosine, lambda ratio: math.acos(max(-1.0, min(1.0, ratio)))),
}
