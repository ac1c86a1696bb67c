"""The ends of the inputs, where arm, tie rod or the knuckle's upper end lock: values near each and beyond.

An end is a fold: two assembly modes meet there. Their distance is the square root of the distance from the
end; rates and the condition number grow as its inverse root. A value before the end has a pose, a value
beyond it has none. If an input is driven beyond its end, or starts beyond it, the refusal is compared with
the true end (see `hard.reach`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from validate.hard.case import RIGHT_OR_REFUSED, Case, family, right_from
from validate.hard.reach import End, ends_of, last_value
from validate.hard.subjects import NAMED, OTHERS, PAPER, ROLLING, Content, Subject, hyphens, scene_content

CASES: list[Case] = []
# The distance down to which each model must be right, as a share of the range; nearer, it may refuse with a
# reason. pointcoord, held: a path is followed until its steps shrink below 1e-13 of it, which happens at
# 1e-12 of the way from the drawing to the end, half a range; ten times this distance is always reached.
# Moving: a motion continues while a segment, some tenth of the remaining time, is at least 1e-15 of the
# whole. Two branches at a distance of 1e-6 of the car, the root of 1e-12, are distinguished if the condition
# number, 1e6 to 1e7, leaves half of the digits; at ten times this distance they always are. The absolute
# model stops where its condition number exceeds 6.7e7, the inverse root of the rounding unit. In its scaling
# the condition number is 10 to 40 over the root of the distance, so it stops below (40 / 6.7e7)^2 = 4e-13 of
# the range. At ten times the next decade above, no end is near enough to justify a refusal. The relative
# model stops where the error of a pose by rounding changes its Jacobian by an eighth. At the share d of the
# range from an end this change is 2e-15 / d, times five deviations and a factor of a few that depends on the
# car. So it stops at some 1e-12, and ten times this distance is always reached.
NEAR_END = dict.fromkeys(("pointcoord", "absolute", "relative"), right_from(1e-11))
NEWTON = {"pointcoord-newton": right_from(1e-11)}
NO_POSE = "; beyond the end there is no pose, at the end two assembly modes meet."


def _rows(
    end: End,
    name: str,
    group: str,
    held: Sequence[float],
    moving: Sequence[float],
    past: Sequence[float],
    start: Sequence[float],
) -> None:
    """Add the cases of one end: near it and beyond it, each with a motion and held.

    Args:
        held, moving: the values of an input that is held near its end, and that moves there.
        past, start: those of an input that moves beyond its end, and that is beyond it at the first instant.
    """
    subject, where, still = end.subject, end.where, replace(end, moving=False)
    kind, unit = subject.inputs[end.driven].kind, subject.inputs[end.driven].unit
    wholes = {"turn": "its range", "arm": "the angle from the end to the upright arm"}
    whole = wholes.get(kind, f"the range of {end.driven}")
    expected = NEAR_END | (NEWTON if group == UPPER else {})
    near = partial(family, CASES, group, "distance from the end, in parts of the input's range")
    beyond = partial(
        family, CASES, "Reachable range", f"overshoot beyond the last value, in parts of {whole}"
    )
    near, beyond = partial(near, expected=expected), partial(beyond, unit=unit, beyond=True)
    rates = "the motion ends near it, with rates as the inverse root of the distance"
    for rows, way, values, why, scene in (
        (near, f"{name}-held", held, f"{where}.", still.near),
        (near, f"{name}-moving", moving, f"{where}; {rates}.", end.near),
        (beyond, f"reach-{name}", past, f"{where}{NO_POSE}", end.beyond),
        (
            beyond,
            f"start-beyond-{name}",
            start,
            f"{where}, and the first instant lies beyond{NO_POSE}",
            still.beyond,
        ),
    ):
        if values:
            rows(values=values, subjects=[subject], name=way, why=why)(scene)


UPPER = "The knuckle's upper end out of reach"
DEAD, IN_LINE = "The arm at its dead points", "Tie rod and steering arm in line"
BALL_JOINT = "The ball joint is {} on its circle, where its height is stationary"
LIE_IN_LINE = "Tie rod and steering arm lie in line"
ARM = ("link lower_ball_joint - lower_arm_front", "link lower_ball_joint - lower_arm_rear")
TIE_ROD = ("link tie_rod_inner - tie_rod_outer",)
UPPER_ARM = (
    "link upper_ball_joint - lower_ball_joint",
    "link upper_ball_joint - upper_arm_front",
    "link upper_ball_joint - upper_arm_rear",
)
# Every refusal is a whole motion towards a fold and takes long, so there are only two values.
FULL, SPARSE, TWO = (1e-4, 1e-11, 1e-12), (1e-1, 1e-4, 1e-8, 1e-12), (1.0, 1e-12)
# For each car, values near the end, and values for a first instant beyond it.
OF_ARMS = {"paper": (FULL, TWO), "short-arm": (SPARSE, ())}
OF_RACKS = {"paper": (FULL, TWO), "wishbone": (SPARSE, ())}
# Name: group, input, whether the upper end, the links that lie in line, why it ends there, and the cars.
ENDS: dict[str, tuple[str, str, bool, tuple[str, ...], str, Mapping[str, Sequence[Sequence[float]]]]] = {
    "arm-highest": (DEAD, "arm_angle", False, ARM, BALL_JOINT.format("highest"), OF_ARMS),
    "arm-lowest": (DEAD, "arm_angle", True, ARM, BALL_JOINT.format("lowest"), OF_ARMS),
    "rack-least": (IN_LINE, "rack", False, TIE_ROD, LIE_IN_LINE, OF_RACKS),
    "rack-greatest": (IN_LINE, "rack", True, TIE_ROD, LIE_IN_LINE, OF_RACKS),
    "slide-runs-out": (
        *(UPPER, "arm_angle", False, ("strut_top on the strut axis",)),
        "The ball joint is as near to the strut's top as it lies beside the axis: the slide is at its end",
        {"wide": (FULL, TWO)},
    ),
    "upper-arm-locks": (
        *(UPPER, "arm_angle", True, UPPER_ARM),
        "Upper arm and kingpin of a double wishbone lie in one plane with the upper pivots",
        {"wishbone": ((1e-1, 1e-5, 1e-9), TWO)},
    ),
    "tie-rod-locks-the-arm": (
        *(UPPER, "arm_angle", False, TIE_ROD),
        "The arm turns until tie rod and steering arm lie in line",
        {"wishbone": ((), TWO)},
    ),
}
for name, (group, driven, ahead, links, where, cars) in ENDS.items():
    for car, (near, start) in cars.items():
        # The name of an end that only one car has needs no suffix.
        subject = NAMED[car] if len(cars) > 1 else replace(NAMED[car], suffix="")
        _rows(End(subject, driven, ahead, where, links), name, group, near, near, TWO, start)
for subject in (*OTHERS, ROLLING):
    for driven, ahead in ends_of(subject):
        size = "greatest" if ahead else "least"
        end = End(subject, driven, ahead, f"{driven} is at its {size}, the others as drawn")
        # The right corner of an axle mirrors the left one, so only the left one is run.
        if not driven.startswith("right"):
            held, start = ((), ()) if subject is ROLLING else ((1e-4,), (1e-3,))
            group = "Inputs at their ends, of every mechanism"
            _rows(end, f"{hyphens(driven)}-{size}", group, held, (1e-4,), (1e-3,), start)

SEARCHED = NAMED["searched"]
HELD = 27.68275866007217  # mm, where its rack was held
BY_ANGLE = dict.fromkeys(("absolute", "relative"), RIGHT_OR_REFUSED)
# The branch is kept at any tolerance, because the sign of the Jacobian's determinant is checked.
AT_A_TURN = dict.fromkeys(("pointcoord", "pointcoord-as-asked", "pointcoord-newton"), right_from(1e-12))
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
    last = last_value(SEARCHED, "arm_angle", True, (SEARCHED.drawn["arm_angle"], HELD))
    return scene_content(SEARCHED.car, last.beyond(-value), HELD)


@_found(
    "distance of the turn from the end, in parts of half the range", (1e-1, 1e-7, 1e-12), AT_A_TURN | BY_ANGLE
)
def turn_at_a_coarse_tolerance(subject: Subject, value: float) -> Content:
    """The rack reverses just before its end: a coarse series may cross over smoothly to the other branch,
    which is as near as the root of the distance, with zero residuals.

    The rack moves from the middle to near its greatest travel and back; there are instants before and after.
    """
    low, high = (float(last_value(subject, "rack", ahead).value) for ahead in (False, True))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    swing = {"sine": {"amplitude": half * (1.0 - value), "angular_frequency": 1.0, "offset": middle}}
    return scene_content(subject.car, rack=swing, stop=3.0, samples=4, tolerance=1e9)


@_found(
    "distance of the rod end behind the top, in parts of the strut",
    (1.0, 1e-2, 1e-6, 1e-12),  # near the top a refusal takes a second
    {"pointcoord": right_from(1e-2), **BY_ANGLE},
)
def strut_drawn_folded(subject: Subject, value: float) -> Content:
    """Random scenes had the end of the strut rod drawn beyond the strut's top: their line is reversed."""
    p = subject.car.array
    top = p["strut_top"]
    car = subject.car.drawn_as({**p, "strut_rod_end": top + value * (top - p["strut_lower"])})
    return scene_content(car, [1.4, 0.2], stop=1.0)
