"""The ends of the inputs, where arm, tie rod or the knuckle's upper end lock: near each, and beyond it.

An end is a fold: two assemblies meet there as the root of the distance, rates grow as its inverse root and
the condition number with them. A value held inside an end has a pose, one beyond it has none.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from validate.hard.cars import SQUARE
from validate.hard.case import REFUSED, Case, Expected, decades
from validate.hard.family import NAMED, OTHERS, Content, Subject, hyphens
from validate.hard.last_values import ends_of, last_value
from validate.hard.trial import scene_case

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
FULL = decades(-12, -1)
COARSE = (*decades(-11, -1)[::2], 1e-2, 1e-12)
SPARSE = (1e-1, 1e-4, 1e-8, 1e-12)
WAYS = (False, True)
HIGHEST, LEAST = ("highest", "lowest"), ("least", "greatest")  # the ball joint is highest at the least angle
# How the input comes to its end, and what that adds to the reason.
LAWS = {
    "held": "",
    "moving": "; the motion ends near it, with rates as the inverse root of the distance",
    "beyond": "; the input is beyond that",
}


def near_content(
    subject: Subject, driven: str, ahead: bool, arm_angle: float | None, law: str, value: float
) -> Content:
    """The scene near an end of an input, or beyond it.

    Args:
        ahead: whether the upper end.
        arm_angle: at which a rack is driven; the other inputs are as drawn.
        law: held near the end, moving from the middle of the range to there in one second, or held beyond.
    """
    held = dict(subject.drawn) | ({} if arm_angle is None else {"arm_angle": arm_angle})
    last = last_value(subject, driven, ahead, held)
    end = float(last.value)
    across = -last.reach if ahead else last.reach
    near = end + (-value if law == "beyond" else value) * across
    middle = end + 0.5 * across
    way: float | Sequence[float] = [middle, near - middle] if law == "moving" else near
    return subject.absolute({**held, driven: way}, stop=1.0 if law == "moving" else None)


def _cases(
    name: str,
    group: str,
    why: str,
    car: str,
    driven: str,
    ahead: bool,
    arm_angle: float | None = None,
    values: tuple[float, ...] | None = None,
    newton: bool = False,
    laws: Sequence[str] = tuple(LAWS),
    suffix: str = "",
) -> tuple[Case, ...]:
    def case(law: str) -> Case:
        beyond = law == "beyond"
        expected = dict.fromkeys(NEAR_END, REFUSED) if beyond else NEAR_END
        return scene_case(
            name=f"{name}{f'-{law}' if len(laws) > 1 else ''}{suffix}",
            group=group,
            why=why + LAWS[law],
            parameter="distance from the end, in parts of the input's range"
            + (", beyond it" if beyond else ""),
            # A motion takes longest; with another car than the first few values must do.
            values=values or (COARSE if law == "moving" and suffix else FULL),
            scene=partial(near_content, NAMED[car], driven, ahead, arm_angle, law),
            expected=expected | ({"pointcoord-newton": expected["pointcoord"]} if newton else {}),
        )

    return tuple(case(law) for law in laws)


ARMS = (("paper", "", None), ("other", "-turned", None), ("short-arm", "-wishbone", SPARSE))
RACKS = (
    ("paper", "", SQUARE, "", None),
    ("other", "-turned", SQUARE, "", None),
    ("wishbone", "-wishbone", SQUARE, "", SPARSE),
    ("paper", "", 1.25, "-arm-high", None),
    ("paper", "", 1.9, "-arm-low", None),
)
UPPER_GROUP = "The knuckle's upper end out of reach"
CASES: tuple[Case, ...] = (
    *(
        case
        for car, suffix, values in ARMS
        for ahead in WAYS
        for case in _cases(
            f"arm-{HIGHEST[ahead]}",
            "The arm at its dead points",
            f"the ball joint is {HIGHEST[ahead]} on its circle: its height says no more",
            car,
            "arm_angle",
            ahead,
            values=values,
            suffix=suffix,
        )
    ),
    *(
        case
        for car, suffix, angle, where, values in RACKS
        for ahead in WAYS
        for case in _cases(
            f"rack-{LEAST[ahead]}{where}",
            "Tie rod and steering arm in line",
            f"the rack is at its {LEAST[ahead]} travel at {angle:.4g} rad: "
            "tie rod and steering arm lie in line",
            car,
            "rack",
            ahead,
            angle,
            values,
            laws=("held",) if where else tuple(LAWS),
            suffix=suffix,
        )
    ),
    *_cases(
        "slide-runs-out",
        UPPER_GROUP,
        "the ball joint is as near to the strut's top as it lies beside the axis: it has no more way",
        "wide",
        "arm_angle",
        False,
        values=FULL,
        newton=True,
    ),
    *_cases(
        "upper-arm-locks",
        UPPER_GROUP,
        "upper arm and kingpin of a double wishbone lie in one plane with the upper pivots",
        "wishbone",
        "arm_angle",
        True,
        values=COARSE[::2],
        newton=True,
    ),
    *(
        case
        for subject in OTHERS
        for driven, ahead in ends_of(subject)
        for case in _cases(
            f"{hyphens(driven)}-{LEAST[ahead]}",
            "Inputs at their ends, of every mechanism",
            f"{driven} is at its {LEAST[ahead]} and goes no further, the other inputs as drawn",
            subject.name,
            driven,
            ahead,
            values=(1e-4,),
            laws=("held", "beyond"),
            suffix=subject.suffix,
        )
    ),
)
