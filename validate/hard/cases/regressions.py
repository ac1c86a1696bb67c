"""Found by searches: places that nobody thought of, each with the search that found it."""

from __future__ import annotations

from validate.cars.car import RIGHT, UP, Car
from validate.hard.cars import PAPER_CAR, SQUARE, drawn_angle, scene_content
from validate.hard.case import RIGHT_OR_REFUSED, Case, Expected, decades
from validate.hard.family import ARM_AND_RACK, LEVEL, PAPER, Content, Subject
from validate.hard.last_values import last_value
from validate.hard.trial import scene_case

GROUP = "Found by searches"
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


def _searched(value: float) -> Content:
    last = last_value(SEARCHED, "arm_angle", True, {"arm_angle": drawn_angle(SEARCHED.car), "rack": HELD})
    return SEARCHED.absolute({"arm_angle": last.beyond(-value), "rack": HELD})


def _touching(value: float) -> Content:
    low, high = (float(last_value(PAPER, "rack", ahead).value) for ahead in (False, True))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    swing = {"sine": {"amplitude": half * (1.0 - value), "angular_frequency": 1.0, "offset": middle}}
    # From the middle to near the greatest travel and back; instants on both sides of the turn.
    return scene_content(PAPER_CAR, SQUARE, swing, stop=3.0, samples=4, tolerance=COARSE)


def _folded(value: float) -> Content:
    top, lower = PAPER_CAR.points["strut_top"], PAPER_CAR.points["strut_lower"]
    x, y, z = (t + value * (t - p) for t, p in zip(top, lower, strict=True))
    points = {**PAPER_CAR.points, "strut_rod_end": (x, y, z)}
    return scene_content(Car(points, "left", UP, RIGHT, "collinear"), [1.4, 0.2], stop=1.0)


CASES: tuple[Case, ...] = (
    scene_case(
        name="error-all-but-its-bound",
        group=GROUP,
        why="a search for the largest error / bound came here: the last step of Newton's method is nearly "
        "all of the error, and the bound measures it, so that nothing is left to spare",
        parameter="distance of the arm from its end, in parts of its range",
        values=decades(-12, -1),
        scene=_searched,
        expected={
            "pointcoord": Expected(("right", "refused"), 1e-11),
            "absolute": RIGHT_OR_REFUSED,
            "relative": RIGHT_OR_REFUSED,
        },
    ),
    scene_case(
        name="turn-at-a-coarse-tolerance",
        group=GROUP,
        why="the rack turns just before its end: a series too coarse to see the other branch, which comes "
        "within the root of the distance, runs smoothly over to it and every residual stays zero",
        parameter="distance of the turn from the end, in parts of half the range",
        values=decades(-12, -1),
        scene=_touching,
        expected={
            "pointcoord": Expected(("right", "refused"), 1e-12),
            "pointcoord-as-asked": Expected(("right", "refused"), 1e-12),
            "pointcoord-newton": Expected(("right", "refused"), 1e-12),
            "absolute": RIGHT_OR_REFUSED,
            "relative": RIGHT_OR_REFUSED,
        },
        behaviour="the branch is kept at any tolerance: the sign of the Jacobian's determinant is followed",
    ),
    scene_case(
        name="strut-drawn-folded",
        group=GROUP,
        why="random scenes drew the rod end behind the strut's top: their line points the other way",
        parameter="distance of the rod end behind the top, in parts of the strut",
        values=decades()[::2],  # near the top a refusal takes a second
        scene=_folded,
        expected={
            "pointcoord": Expected(("right", "refused"), 1e-2),
            "absolute": RIGHT_OR_REFUSED,
            "relative": RIGHT_OR_REFUSED,
        },
    ),
)
