"""The suspensions that tests of any suspension run over, and what these need to know of each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import strut_motion
import struts
from jets import Moving
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
Car = dict[str, Array]


@dataclass(frozen=True)
class Kind:
    """A suspension.

    Attributes:
        build: its model from points and directions.
        random_car: a left car of a seed; its rack_centre is drawn.
        exact: its closed form for value, rate and acceleration of arm angle and rack; None beyond a limit.
        inner: where the spin axis begins, the first of these that a car has.
        kingpin: the ends of the steering axis.
    """

    build: Callable[..., absolute.Model]
    random_car: Callable[[int], Car]
    exact: Callable[[Car, Sequence[float], Sequence[float]], Moving | None]
    inner: tuple[str, ...]
    kingpin: tuple[str, str]


def with_rack(car: Car) -> Car:
    """The default of the rack's line, written out."""
    return {"rack_centre": car["tie_rod_inner"], **car}


def _strut(closure: str, car: Callable[[int], Car], upper: str) -> Kind:
    return Kind(
        partial(absolute.SUSPENSIONS["macpherson"], closure=closure),
        lambda seed: with_rack(car(seed)),
        lambda points, angle, rack: strut_motion.strut_motion(points, angle, rack, closure),
        ("wheel_axis_inner", "strut_lower"),
        ("lower_ball_joint", upper),
    )


KINDS = {
    "strut": _strut("drawn", struts.off_axis_strut, "strut_top"),
    "collinear strut": _strut("collinear", struts.collinear_strut, "strut_lower"),
}


def mirrored(car: Car) -> Car:
    """The car's other side."""
    return {name: point * np.array([1.0, -1.0, 1.0]) for name, point in car.items()}


def inputs_at(angle: Sequence[float], rack: Sequence[float]) -> dict[str, Array]:
    """One instant."""
    return {"arm_angle": np.array([angle], dtype=float), "rack": np.array([rack], dtype=float)}
