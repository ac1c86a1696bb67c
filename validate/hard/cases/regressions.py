"""Cases that searches found."""

from __future__ import annotations

from functools import partial

from validate.cars.car import Car
from validate.hard.case import RIGHT_OR_REFUSED, Case, family, right_from
from validate.hard.cases.ends import FULL
from validate.hard.reach import last_value
from validate.hard.subjects import NAMED, PAPER, SQUARE, Content, Subject, drawn_angle, scene_content

SEARCHED = NAMED["searched"]
HELD = 27.68275866007217  # mm, where its rack was held
BY_ANGLE = {"absolute": RIGHT_OR_REFUSED, "relative": RIGHT_OR_REFUSED}
# The branch is kept at any tolerance, because the sign of the Jacobian's determinant is checked.
AT_A_TURN = dict.fromkeys(("pointcoord", "pointcoord-as-asked", "pointcoord-newton"), right_from(1e-12))
CASES: list[Case] = []
_found = partial(family, CASES, "Found by searches", subjects=[PAPER])


@_found(
    "distance of the arm from its end, in parts of its range",
    FULL,
    {"pointcoord": right_from(1e-11), **BY_ANGLE},
)
def error_all_but_its_bound(_: Subject, value: float) -> Content:
    """A search for the largest error / bound found this pose: the last Newton step is nearly the whole error,
    and the bound is nearly this step, so it has no margin.
    """
    last = last_value(SEARCHED, "arm_angle", True, {"arm_angle": drawn_angle(SEARCHED.car), "rack": HELD})
    return SEARCHED.absolute({"arm_angle": last.beyond(-value), "rack": HELD})


@_found(
    "distance of the turn from the end, in parts of half the range",
    (1e-1, 1e-7, 1e-12),
    AT_A_TURN | BY_ANGLE,
)
def turn_at_a_coarse_tolerance(_: Subject, value: float) -> Content:
    """The rack reverses just before its end: a coarse series may cross over smoothly to the other branch,
    which is as near as the root of the distance, with zero residuals.

    The rack moves from the middle to near its greatest travel and back; there are instants before and after.
    """
    low, high = (float(last_value(PAPER, "rack", ahead).value) for ahead in (False, True))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    swing = {"sine": {"amplitude": half * (1.0 - value), "angular_frequency": 1.0, "offset": middle}}
    return scene_content(PAPER.car, SQUARE, swing, stop=3.0, samples=4, tolerance=1e9)


@_found(
    "distance of the rod end behind the top, in parts of the strut",
    (1.0, 1e-2, 1e-6, 1e-12),  # near the top a refusal takes a second
    {"pointcoord": right_from(1e-2), **BY_ANGLE},
)
def strut_drawn_folded(_: Subject, value: float) -> Content:
    """Random scenes had the end of the strut rod drawn beyond the strut's top: their line is reversed."""
    top, lower = PAPER.car.points["strut_top"], PAPER.car.points["strut_lower"]
    x, y, z = (t + value * (t - p) for t, p in zip(top, lower, strict=True))
    points = {**PAPER.car.points, "strut_rod_end": (x, y, z)}
    return scene_content(Car(points, closure="collinear"), [1.4, 0.2], stop=1.0)
