"""The ends of the inputs, where arm, tie rod or the knuckle's upper end lock: values near each and beyond.

An end is a fold: two assembly modes meet there. Their distance is the square root of the distance from the
end; rates and the condition number grow as its inverse root. A value before the end has a pose, a value
beyond it has none. If an input is driven beyond its end, or starts beyond it, the refusal is compared with
the true end (see `hard.reach`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from validate.hard.case import Case, Values, family, right_from
from validate.hard.reach import End, ends_of
from validate.hard.subjects import NAMED, OTHERS, ROLLING, hyphens

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
LAWS = {"held": "", "moving": "; the motion ends near it, with rates as the inverse root of the distance"}
FIRST = ", and the first instant lies beyond"
NO_POSE = "beyond the end there is no pose, at the end two assembly modes meet"
near_ends: list[Case] = []
beyond_ends: list[Case] = []


def _near(end: End, name: str, added: str, group: str, values: Values, laws: Iterable[str] = LAWS) -> None:
    newton = {"pointcoord-newton": right_from(1e-11)} if group == UPPER else {}
    for law in laws if values else ():
        family(
            *(near_ends, group, "distance from the end, in parts of the input's range", values),
            *(NEAR_END | newton, [end.subject]),
            name=f"{name}-{law}",
            suffix=added,
            why=f"{end.where}{LAWS[law]}.",
        )(replace(end, moving=law == "moving").near)


def _beyond(end: End, name: str, moving: Values, start: Values) -> None:
    """Add the cases of an input driven beyond its end, and beyond it at the first instant."""
    subject, driven = end.subject, end.driven
    whole = "its range" if subject.is_a("turn", driven) else f"the range of {driven}"
    whole = "the angle from the end to the upright arm" if subject.is_a("arm", driven) else whole
    for way, first, values in (("reach", "", moving), ("start-beyond", FIRST, start)):
        one = replace(end, moving=not first)
        if values:
            family(
                *(beyond_ends, "Reachable range", f"overshoot beyond the last value, in parts of {whole}"),
                values,
                subjects=[subject],
                name=f"{way}-{name}",
                suffix="",
                why=f"{end.where}{first}; {NO_POSE}.",
                judge=one.judge,
                facts=lambda *_, one=one: {"end [mm or rad]": float(one.last.value)},
                unit=subject.units[driven],
                beyond=True,
            )(one.beyond)


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
# Group, input, whether the upper end, the links that lie in line, and why it ends there.
ENDS: dict[str, tuple[str, str, bool, tuple[str, ...], str]] = {
    "arm-highest": (DEAD, "arm_angle", False, ARM, BALL_JOINT.format("highest")),
    "arm-lowest": (DEAD, "arm_angle", True, ARM, BALL_JOINT.format("lowest")),
    "rack-least": (IN_LINE, "rack", False, TIE_ROD, LIE_IN_LINE),
    "rack-greatest": (IN_LINE, "rack", True, TIE_ROD, LIE_IN_LINE),
    "slide-runs-out": (
        *(UPPER, "arm_angle", False, ("strut_top on the strut axis",)),
        "The ball joint is as near to the strut's top as it lies beside the axis: the slide is at its end",
    ),
    "upper-arm-locks": (
        *(UPPER, "arm_angle", True, UPPER_ARM),
        "Upper arm and kingpin of a double wishbone lie in one plane with the upper pivots",
    ),
    "tie-rod-locks-the-arm": (
        *(UPPER, "arm_angle", False, TIE_ROD),
        "The arm turns until tie rod and steering arm lie in line",
    ),
}
ARMS, RACKS = ("arm-highest", "arm-lowest"), ("rack-least", "rack-greatest")
FULL, SPARSE = (1e-4, 1e-11, 1e-12), (1e-1, 1e-4, 1e-8, 1e-12)
# Every refusal is a whole motion towards a fold and takes long, so there are only two values.
TWO = (1.0, 1e-12)
# Ends, car, suffix of the name; values near the end, and values for a first instant beyond it.
for names, car, added, near, start in (
    (ARMS, "paper", "", FULL, TWO),
    (ARMS, "short-arm", "-wishbone", SPARSE, ()),
    (RACKS, "paper", "", FULL, TWO),
    (RACKS, "wishbone", "-wishbone", SPARSE, ()),
    (("slide-runs-out",), "wide", "", FULL, TWO),
    (("upper-arm-locks",), "wishbone", "", (1e-1, 1e-5, 1e-9), TWO),
    (("tie-rod-locks-the-arm",), "wishbone", "", (), TWO),
):
    for name in names:
        group, driven, ahead, links, where = ENDS[name]
        end = End(NAMED[car], driven, ahead, where, links)
        _near(end, name, added, group, near)
        _beyond(end, name + added, TWO, start)
for subject in (*OTHERS, ROLLING):
    for driven, ahead in ends_of(subject):
        size = "greatest" if ahead else "least"
        name, parts = f"{hyphens(driven)}-{size}", subject.of_parts
        end = End(subject, driven, ahead, f"{driven} is at its {size}, the others as drawn")
        # The right corner of an axle mirrors the left one, so only the left one is run.
        if not driven.startswith("right"):
            of_all = "Inputs at their ends, of every mechanism"
            _near(end, name, subject.suffix, of_all, (1e-4,), ("moving",) if parts else LAWS)
            _beyond(end, name + subject.suffix, (1e-3,), () if parts else (1e-3,))
CASES = (*near_ends, *beyond_ends)
