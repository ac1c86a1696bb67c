"""Where the motions of two struts end, by bisection of the closed form: the last double that has a pose."""

from typing import NamedTuple

import numpy as np
import strut_motion as form
import struts
from numpy.typing import NDArray

Array = NDArray[np.float64]
LINKS = (
    ("link lower_ball_joint - lower_arm_front", "link lower_ball_joint - lower_arm_rear"),
    ("strut axis",),
    ("link tie_rod_inner - tie_rod_outer",),
)


class End(NamedTuple):
    """Where the motion of a car ends when one input runs: the last double with a pose, and the way out."""

    car: dict[str, Array]
    links: tuple[str, ...]
    limit: str
    inside: tuple[float, float]
    out: tuple[float, float]


def end_of(car: dict[str, Array], limit: str, out: float) -> End:
    """The end of one input's run from the drawing, by bisection of the closed form."""
    angle, rack = form.drawn_inputs(car)

    def at(change: float) -> tuple[float, float]:
        return (angle + out * change, rack) if limit == "arm_angle" else (angle, rack + out * change)

    low, high = 0.0, 0.0
    while form.strut_motion(car, *((x, 0, 0) for x in at(high)), "drawn") is not None:
        low, high = high, high + (0.02 if limit == "arm_angle" else 5.0)
    while at(0.5 * (low + high)) not in (at(low), at(high)):
        middle = 0.5 * (low + high)
        inside = form.strut_motion(car, *((x, 0, 0) for x in at(middle)), "drawn")
        low, high = (low, middle) if inside is None else (middle, high)
    exact = form.strut_motion(car, *((x, 0, 0) for x in at(low)), "drawn")
    assert exact is not None
    links = LINKS[int(np.argmin([float(margin) for margin in exact.margins]))]
    return End(car, links, limit, at(low), (out, 0.0) if limit == "arm_angle" else (0.0, out * 219.0))


def low_mount() -> dict[str, Array]:
    """A strut so short that its ball joint comes abreast of its top mount, 130 mm beside the axis."""
    car = struts.off_axis_strut(5)
    car["strut_top"] = np.array([460.0, -310.0, 190.0])
    car["strut_lower"] = np.array([452.0, -420.0, 60.0])
    car["strut_rod_end"] = car["strut_top"] - 0.3 * (car["strut_top"] - car["strut_lower"])
    car["lower_ball_joint"] = np.array([450.0, -330.0, -40.0])
    return {"rack_centre": car["tie_rod_inner"], **car}


ENDS = [
    end_of(low_mount(), "arm_angle", -1.0),
    end_of(low_mount(), "arm_angle", 1.0),
    end_of(low_mount(), "rack", -1.0),
    end_of(low_mount(), "rack", 1.0),
]
