"""Where the motions of some cars end, by bisection of the closed form: the last double that has a pose."""

from typing import NamedTuple

import numpy as np
import struts
from kinds import KINDS, Array, Car, Kind, with_rack
from strut_motion import drawn_inputs
from wishbones import random_wishbone, short_lower_arm


class End(NamedTuple):
    """Where the motion of a car ends when one input runs: the last double with a pose, and the way out."""

    kind: Kind
    car: Car
    links: str
    limit: str
    inside: tuple[float, float]
    out: tuple[float, float]


def end_of(kind: Kind, car: Car, limit: str, out: float) -> End:
    """The end of one input's run from the drawing, by bisection of the closed form."""
    angle, rack = drawn_inputs(car)

    def at(change: float) -> tuple[float, float]:
        return (angle + out * change, rack) if limit == "arm_angle" else (angle, rack + out * change)

    low, high = 0.0, 0.0
    while kind.exact(car, *((x, 0, 0) for x in at(high))) is not None:
        low, high = high, high + (0.02 if limit == "arm_angle" else 5.0)
    while at(0.5 * (low + high)) not in (at(low), at(high)):
        middle = 0.5 * (low + high)
        inside = kind.exact(car, *((x, 0, 0) for x in at(middle)))
        low, high = (low, middle) if inside is None else (middle, high)
    exact = kind.exact(car, *((x, 0, 0) for x in at(low)))
    assert exact is not None
    links = kind.links[int(np.argmin([float(margin) for margin in exact.margins]))]
    return End(kind, car, links, limit, at(low), (out, 0.0) if limit == "arm_angle" else (0.0, out * 219.0))


def low_mount() -> dict[str, Array]:
    """A strut so short that its ball joint comes abreast of its top mount, 130 mm beside the axis."""
    car = struts.off_axis_strut(5)
    car["strut_top"] = np.array([460.0, -310.0, 190.0])
    car["strut_lower"] = np.array([452.0, -420.0, 60.0])
    car["strut_rod_end"] = car["strut_top"] - 0.3 * (car["strut_top"] - car["strut_lower"])
    car["lower_ball_joint"] = np.array([450.0, -330.0, -40.0])
    return with_rack(car)


WAYS = [("arm_angle", -1.0), ("arm_angle", 1.0), ("rack", -1.0), ("rack", 1.0)]
STRUT, WISHBONE = KINDS["strut"], KINDS["double wishbone"]
ENDS = [
    *(end_of(STRUT, low_mount(), *way) for way in WAYS),
    *(end_of(WISHBONE, random_wishbone(0), *way) for way in WAYS),
    *(end_of(WISHBONE, short_lower_arm(0), *way) for way in WAYS[:2]),
]
