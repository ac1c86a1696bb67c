"""The suspensions that tests of any suspension run over, and what these need to know of each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import struts
import wishbones
from flat import built_in
from jets import Moving
from numpy.typing import NDArray
from strut_motion import strut_motion
from wishbone_motion import wishbone_motion

import absolute

Array = NDArray[np.float64]
Car = dict[str, Array]
# What holds the mechanism at the dead points of its arms and of its tie rod, as refusals name it.
LOWER_ARM = "hinge of lower_arm on chassis"
UPPER_ARM = "hinge of upper_arm on chassis"
TIE_ROD = "rod tie_rod"


@dataclass(frozen=True)
class Kind:
    """A suspension.

    Attributes:
        build: its model from points and directions.
        car: a car of whole numbers, far from its limits. angle: its arm angle at time 0, rad.
        span: arm angles, degrees, and racks, mm, that this car reaches in any combination.
        random_car: a left car of a seed, and whether its drawing closes; its rack_centre is drawn.
        exact: its closed form for value, rate and acceleration of arm angle and rack; None beyond a limit.
        links: of each margin of the closed form, what a refusal calls it.
        held: pairs of points of different bodies that keep their drawn distance.
        inner: where the spin axis begins, the first of these that a car has.
        kingpin: the ends of the steering axis.
    """

    build: Callable[..., absolute.Model]
    car: Car
    angle: float
    span: tuple[tuple[float, float], tuple[float, float]]
    random_car: Callable[[int, bool], Car]
    exact: Callable[[Car, Sequence[float], Sequence[float]], Moving | None]
    links: tuple[str, ...]
    held: tuple[tuple[str, str], ...]
    inner: tuple[str, ...]
    kingpin: tuple[str, str]

    def inputs(self, t: Array) -> dict[str, Array]:
        """Arm and rack moving together."""
        angle = self.angle + 0.25 * t + 0.0625 * t**2
        return {
            "arm_angle": np.stack([angle, 0.25 + 0.125 * t, np.full_like(t, 0.125)], axis=-1),
            "rack": np.stack([15 * t + 2.5 * t**2, 15 + 5 * t, np.full_like(t, 5.0)], axis=-1),
        }


def with_rack(car: Car) -> Car:
    """The default of the rack's line, written out."""
    return {"rack_centre": car["tie_rod_inner"], **car}


# Ends of links that lie in different bodies: their joints hold them.
ARM_AND_ROD = (
    ("lower_ball_joint", "lower_arm_front"),
    ("lower_ball_joint", "lower_arm_rear"),
    ("tie_rod_outer", "tie_rod_inner"),
    ("lower_ball_joint", "tie_rod_outer"),
)


def _strut(closure: str, random_car: Callable[[int, bool], Car], upper: str) -> Kind:
    return Kind(
        partial(built_in, "macpherson", closure=closure),
        {name: np.array(point) for name, point in struts.TABLE.items()},
        0.8,
        ((45.0, 145.0), (-60.0, 90.0)),
        lambda seed, closing: with_rack(random_car(seed, closing)),
        lambda points, angle, rack: strut_motion(points, angle, rack, closure),
        (LOWER_ARM, "slide strut at strut_top", TIE_ROD),
        (*ARM_AND_ROD, ("strut_rod_end", "strut_top"), ("strut_lower", "tie_rod_outer")),
        ("wheel_axis_inner", "strut_lower"),
        ("lower_ball_joint", upper),
    )


KINDS = {
    "strut": _strut("drawn", struts.off_axis_strut, "strut_top"),
    "collinear strut": _strut("collinear", struts.collinear_strut, "strut_lower"),
    "double wishbone": Kind(
        partial(built_in, "double_wishbone"),
        {name: np.array(point) for name, point in wishbones.LOTUS.items()},
        0.9,
        ((52.0, 112.0), (-40.0, 40.0)),
        wishbones.random_wishbone,
        wishbone_motion,
        (LOWER_ARM, UPPER_ARM, TIE_ROD),
        (
            *ARM_AND_ROD,
            ("upper_ball_joint", "upper_arm_front"),
            ("upper_ball_joint", "upper_arm_rear"),
            ("upper_ball_joint", "lower_ball_joint"),
            ("upper_ball_joint", "tie_rod_outer"),
        ),
        ("wheel_axis_inner",),
        ("lower_ball_joint", "upper_ball_joint"),
    ),
}


def mirrored(car: Car) -> Car:
    """The car's other side."""
    return {name: point * np.array([1.0, -1.0, 1.0]) for name, point in car.items()}


def inputs_at(angle: Sequence[float], rack: Sequence[float]) -> dict[str, Array]:
    """One instant."""
    return {"arm_angle": np.array([angle], dtype=float), "rack": np.array([rack], dtype=float)}
