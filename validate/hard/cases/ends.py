"""The ends of the inputs, where arm, tie rod or the knuckle's upper end lock: near each, and beyond it.

An end is a fold: two assemblies meet there as the root of the distance, rates grow as its inverse root and
the condition number with them. A value held inside an end has a pose, one beyond it has none: the refusal of
what is driven beyond it, or is to be there at the first instant, is compared with the true end (see `reach`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from validate.hard.cars import SQUARE
from validate.hard.case import Case, Expected, Values, case
from validate.hard.cases.reach import End, Lock, driven_beyond, first_three, tie_rod_within
from validate.hard.last_values import ends_of, last_value
from validate.hard.subjects import NAMED, OF_PARTS, OTHERS, Content, Subject, hyphens

# Down to where each model has to be right; nearer it may refuse with a reason.
# pointcoord, held: a path is followed until its steps shrink below 1e-13 of it, which is at 1e-12 of the way
# to the end from the drawing, half a range away; ten times that is always reached. Moving: a motion goes on
# while a segment, some tenth of the time that is left, is 1e-15 of the whole. Two branches 1e-6 of the car
# apart, the root of 1e-12, are told apart where the condition number, 1e6 or some ten times that, leaves half
# of the digits; ten times that always is.
# The absolute model stops where its condition number exceeds 6.7e7, the inverse root of the rounding unit. In
# its own scaling that is 10 to 40 over the root of the distance, so it stops below (40 / 6.7e7)^2 = 4e-13 of
# the range, and at ten times the nearest decade above that no end is near enough to be a reason.
# The relative model stops where the error that rounding may make of a pose changes its Jacobian by an eighth.
# At the share d of the range from an end that is 2e-15 / d, times five deviations and a factor of the car
# that is a few: some 1e-12, and ten times that is always reached.
NEAR_END = dict.fromkeys(("pointcoord", "absolute", "relative"), Expected(("right", "refused"), 1e-11))
FULL = (1e-1, 1e-4, 1e-7, 1e-11, 1e-12)
SPARSE = (1e-1, 1e-4, 1e-8, 1e-12)
# How the input comes to its end, and what that adds to the reason.
LAWS = {
    "held": "",
    "moving": "; the motion ends near it, with rates as the inverse root of the distance",
}


def near_end(end: End, arm_angle: float | None, law: str, _: Subject, value: float) -> Content:
    """The scene near an end of an input.

    Args:
        arm_angle: at which a rack is driven; the other inputs are as drawn.
        law: held near the end, or moving from the middle of the range to there in one second.
    """
    held = dict(end.subject.drawn) | ({} if arm_angle is None else {"arm_angle": arm_angle})
    last = last_value(end.subject, end.driven, end.ahead, held)
    at, across = float(last.value), -last.reach if end.ahead else last.reach
    near = at + value * across
    middle = at + 0.5 * across
    way: float | Sequence[float] = [middle, near - middle] if law == "moving" else near
    return end.subject.absolute({**held, end.driven: way}, stop=1.0 if law == "moving" else None)


def _near(
    name: str,
    end: End,
    suffix: str,
    group: str,
    values: Values,
    laws: Sequence[str],
    arm: float | None = None,
) -> Iterator[Case]:
    for law in laws:
        newton = {"pointcoord-newton": NEAR_END["pointcoord"]} if group == UPPER else {}
        at = "" if arm is None else f", the arm at {arm:.4g} rad"
        yield case(
            partial(near_end, end, arm, law),
            "distance from the end, in parts of the input's range",
            values,
            NEAR_END | newton,
            end.subject,
            name=f"{name}-{law}" if len(laws) > 1 else name,
            suffix=suffix,
            group=group,
            why=f"{end.where}{at}{LAWS[law]}.",
        )


UPPER = "The knuckle's upper end out of reach"
BALL_JOINT = "The ball joint is {} on its circle, where height says no more"
IN_LINE = "Tie rod and steering arm lie in line"
ARM = first_three("link lower_ball_joint - lower_arm_front", "link lower_ball_joint - lower_arm_rear")
# Group, input, whether the upper end, what lies in line, and in words.
ENDS: dict[str, tuple[str, str, bool, Lock, str]] = {
    "arm-highest": ("The arm at its dead points", "arm_angle", False, ARM, BALL_JOINT.format("highest")),
    "arm-lowest": ("The arm at its dead points", "arm_angle", True, ARM, BALL_JOINT.format("lowest")),
    "rack-least": (IN_LINE.replace(" lie", ""), "rack", False, tie_rod_within(3), IN_LINE),
    "rack-greatest": (IN_LINE.replace(" lie", ""), "rack", True, tie_rod_within(3), IN_LINE),
    "slide-runs-out": (
        *(UPPER, "arm_angle", False, lambda limits: "strut_top on the strut axis" in limits),
        "The ball joint is as near to the strut's top as it lies beside the axis: the slide has no more way",
    ),
    "upper-arm-locks": (
        *(UPPER, "arm_angle", True),
        first_three(
            "link upper_ball_joint - lower_ball_joint",
            "link upper_ball_joint - upper_arm_front",
            "link upper_ball_joint - upper_arm_rear",
        ),
        "Upper arm and kingpin of a double wishbone lie in one plane with the upper pivots",
    ),
    # Where the arm drives, what holds the knuckle's upper end is under the same force as the steering arm.
    "tie-rod-locks-the-arm": (
        *(UPPER, "arm_angle", False, tie_rod_within(5)),
        "The arm turns until tie rod and steering arm lie in line",
    ),
}
ARMS, RACKS = ("arm-highest", "arm-lowest"), ("rack-least", "rack-greatest")
# Ends, car, what the name adds; values; where the arm stands.
NEAR: tuple[tuple[Sequence[str], str, str, Values, float | None], ...] = (
    (ARMS, "paper", "", FULL, None),
    (ARMS, "other", "-turned", FULL, None),
    (ARMS, "short-arm", "-wishbone", SPARSE, None),
    (RACKS, "paper", "", FULL, SQUARE),
    (RACKS, "other", "-turned", FULL, SQUARE),
    (RACKS, "wishbone", "-wishbone", SPARSE, SQUARE),
    (RACKS, "paper", "-arm-high", FULL, 1.25),
    (RACKS, "paper", "-arm-low", FULL, 1.9),
    (("slide-runs-out",), "wide", "", FULL, None),
    (("upper-arm-locks",), "wishbone", "", (1e-1, 1e-5, 1e-9), None),
)
# Every refusal is a whole motion towards a fold, so few values must do.
FOUR, ENDS_ONLY = (1.0, 1e-4, 1e-8, 1e-12), (1.0, 1e-12)
# Ends, car, what the name adds; values of a motion beyond it, and of a first instant there.
BEYOND: tuple[tuple[Sequence[str], str, str, Values, Values], ...] = (
    ((*ARMS, *RACKS), "paper", "", ENDS_ONLY, FOUR),
    ((*ARMS, *RACKS), "turned", "-turned", ENDS_ONLY[1:], ()),
    (ARMS, "short-arm", "-wishbone", ENDS_ONLY, ()),
    (RACKS, "wishbone", "-wishbone", ENDS_ONLY, ()),
    (RACKS[1:], "wishbone-turned", "-wishbone-turned", (1e-6,), ()),
    (("slide-runs-out",), "wide", "", ENDS_ONLY, FOUR),
    (("upper-arm-locks", "tie-rod-locks-the-arm"), "wishbone", "", ENDS_ONLY, ENDS_ONLY),
)
OF_OTHERS = tuple(
    (
        f"{hyphens(driven)}-{size}",
        End(subject, driven, ahead, f"{driven} is at its {size}, the others as drawn"),
    )
    for subject in (*OTHERS, *OF_PARTS)
    for driven, ahead in ends_of(subject)
    for size in (("least", "greatest")[ahead],)
)


def _end(name: str, car: str) -> End:
    _, driven, ahead, lock, where = ENDS[name]
    return End(NAMED[car], driven, ahead, where, lock)


CASES = (
    *(
        case
        for names, car, suffix, values, arm in NEAR
        # Where the arm stands high or low the rack is only held.
        for laws in (tuple(LAWS) if arm in (None, SQUARE) else ("held",),)
        for name in names
        for case in _near(name, _end(name, car), suffix, ENDS[name][0], values, laws, arm)
    ),
    *(
        case
        for name, end in OF_OTHERS
        for case in _near(
            *(name, end, end.subject.suffix, "Inputs at their ends, of every mechanism"),
            *((1e-4,), tuple(LAWS)),
        )
    ),
    *(
        driven_beyond(replace(_end(name, car), moving=moving), f"{name}{suffix}", values)
        for names, car, suffix, *both in BEYOND
        for moving, values in zip((True, False), both, strict=True)
        for name in names
        if values
    ),
    *(
        driven_beyond(replace(end, moving=moving), f"{name}{end.subject.suffix}", (1e-3,))
        for name, end in OF_OTHERS
        for moving in (True, False)
    ),
)
