"""Found by searches: places that nobody thought of, each with the search that found it."""

from __future__ import annotations

from functools import partial

from validate.cars.car import RIGHT, UP, Car
from validate.hard.cars import PAPER_CAR, SQUARE, drawn_angle, scene_content
from validate.hard.case import RIGHT_OR_REFUSED, Expected, case, decades
from validate.hard.cases.ends import FULL
from validate.hard.last_values import last_value
from validate.hard.subjects import ARM_AND_RACK, LEVEL, PAPER, Content, Subject

# The strut of the largest share that a search for error / bound found, 0.99999 of it.
SEARCHED = Subject(
    "searched",
    Car(
        {
            "lower_arm_front": (271.0, -5.0, -114.26757179419634),
            "lower_arm_rear": (539.0, -120.99482549806498, -64.68059692752652),
            "rack_centre": (565.7938722478295, 193.543562530239, 90.0),
            "strut_top": (504.8095912819766, -180.0, 514.8095912819766),
            "lower_ball_joint": (451.0, -217.02756130158969, -59.0531970397941),
            "tie_rod_outer": (560.0, -436.8174545750767, 76.95156742437214),
            "strut_lower": (471.83659700499715, -202.6894413586449, 151.62757063828622),
            "strut_rod_end": (490.79644482346635, -189.4048465611014, 365.363681951393),
            "tie_rod_inner": (565.7938722478295, 197.82642503435562, 90.0),
            "wheel_centre": (592.0, -537.0275613015897, -140.33333333333331),
        },
        "left",
        UP,
        RIGHT,
        "collinear",
    ),
    ARM_AND_RACK,
    LEVEL,
)
HELD = 27.68275866007217  # mm, where its rack was held
COARSE = 1e9  # mm, a tolerance that asks for nothing


def error_all_but_its_bound(_: Subject, value: float) -> Content:
    """A search for the largest error / bound came here: the last step of Newton's method is nearly all of
    the error, and the bound measures it, so that nothing is left to spare.
    """
    last = last_value(SEARCHED, "arm_angle", True, {"arm_angle": drawn_angle(SEARCHED.car), "rack": HELD})
    return SEARCHED.absolute({"arm_angle": last.beyond(-value), "rack": HELD})


def turn_at_a_coarse_tolerance(_: Subject, value: float) -> Content:
    """The rack turns just before its end: a series too coarse to see the other branch, which comes within
    the root of the distance, runs smoothly over to it and every residual stays zero.

    From the middle to near the greatest travel and back; instants on both sides of the turn.
    """
    low, high = (float(last_value(PAPER, "rack", ahead).value) for ahead in (False, True))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    swing = {"sine": {"amplitude": half * (1.0 - value), "angular_frequency": 1.0, "offset": middle}}
    return scene_content(PAPER_CAR, SQUARE, swing, stop=3.0, samples=4, tolerance=COARSE)


def strut_drawn_folded(_: Subject, value: float) -> Content:
    """Random scenes drew the rod end behind the strut's top: their line points the other way."""
    top, lower = PAPER_CAR.points["strut_top"], PAPER_CAR.points["strut_lower"]
    x, y, z = (t + value * (t - p) for t, p in zip(top, lower, strict=True))
    points = {**PAPER_CAR.points, "strut_rod_end": (x, y, z)}
    return scene_content(Car(points, "left", UP, RIGHT, "collinear"), [1.4, 0.2], stop=1.0)


_found = partial(case, group="Found by searches")
BY_ANGLE = {"absolute": RIGHT_OR_REFUSED, "relative": RIGHT_OR_REFUSED}
KEPT = Expected(("right", "refused"), 1e-12)
CASES = (
    _found(
        error_all_but_its_bound,
        "distance of the arm from its end, in parts of its range",
        FULL,
        {"pointcoord": Expected(("right", "refused"), 1e-11), **BY_ANGLE},
    ),
    _found(
        turn_at_a_coarse_tolerance,
        "distance of the turn from the end, in parts of half the range",
        decades(-12, -1),
        # The branch is kept at any tolerance: the sign of the Jacobian's determinant is followed.
        dict.fromkeys(("pointcoord", "pointcoord-as-asked", "pointcoord-newton"), KEPT) | BY_ANGLE,
    ),
    _found(
        strut_drawn_folded,
        "distance of the rod end behind the top, in parts of the strut",
        (1.0, 1e-2, 1e-6, 1e-12),  # near the top a refusal takes a second
        {"pointcoord": Expected(("right", "refused"), 1e-2), **BY_ANGLE},
    ),
)
