"""The ends of the inputs, where arm, tie rod or the knuckle's upper end lock: near each, and beyond it.

An end is a fold: two assemblies meet there as the root of the distance, rates grow as its inverse root and
the condition number with them. A value held inside an end has a pose, one beyond it has none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from validate.hard.cars import SQUARE
from validate.hard.case import REFUSED, Case, Expected, Values, case, decades
from validate.hard.last_values import ends_of, last_value
from validate.hard.subjects import NAMED, OTHERS, Content, Subject, hyphens

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


def near_end(
    driven: str, ahead: bool, arm_angle: float | None, law: str, subject: Subject, value: float
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


def _near(
    name: str,
    group: str,
    why: str,
    car: str,
    driven: str,
    ahead: bool,
    arm_angle: float | None = None,
    values: Values = (),
    newton: bool = False,
    laws: Sequence[str] = tuple(LAWS),
    suffix: str = "",
) -> Iterator[Case]:
    for law in laws:
        expected = dict.fromkeys(NEAR_END, REFUSED) if law == "beyond" else NEAR_END
        yield case(
            partial(near_end, driven, ahead, arm_angle, law),
            f"distance from the end, in parts of the input's range{', beyond it' * (law == 'beyond')}",
            # A motion takes longest; with another car than the first few values must do.
            values or (COARSE if law == "moving" and suffix else FULL),
            expected | ({"pointcoord-newton": expected["pointcoord"]} if newton else {}),
            NAMED[car],
            name=f"{name}-{law}" if len(laws) > 1 else name,
            suffix=suffix,
            group=group,
            why=f"{why}{LAWS[law]}.",
        )


ARM, RACK = "The arm at its dead points", "Tie rod and steering arm in line"
UPPER, EVERY = "The knuckle's upper end out of reach", "Inputs at their ends, of every mechanism"
RUNS_OUT = "The ball joint is as near to the strut's top as it lies beside the axis: it has no more way"
LOCKS = "Upper arm and kingpin of a double wishbone lie in one plane with the upper pivots"
CASES = (
    *(
        case
        for car, suffix, values in (
            ("paper", "", ()),
            ("other", "-turned", ()),
            ("short-arm", "-wishbone", SPARSE),
        )
        for ahead in WAYS
        for case in _near(
            f"arm-{HIGHEST[ahead]}",
            ARM,
            f"The ball joint is {HIGHEST[ahead]} on its circle: its height says no more",
            car,
            "arm_angle",
            ahead,
            values=values,
            suffix=suffix,
        )
    ),
    *(
        case
        for car, suffix, angle, where, values in (
            ("paper", "", SQUARE, "", ()),
            ("other", "-turned", SQUARE, "", ()),
            ("wishbone", "-wishbone", SQUARE, "", SPARSE),
            ("paper", "", 1.25, "-arm-high", ()),
            ("paper", "", 1.9, "-arm-low", ()),
        )
        for ahead in WAYS
        for case in _near(
            f"rack-{LEAST[ahead]}{where}",
            RACK,
            f"The rack is at its {LEAST[ahead]} travel at {angle:.4g} rad: "
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
    *_near("slide-runs-out", UPPER, RUNS_OUT, "wide", "arm_angle", False, values=FULL, newton=True),
    *_near("upper-arm-locks", UPPER, LOCKS, "wishbone", "arm_angle", True, values=COARSE[::2], newton=True),
    *(
        case
        for subject in OTHERS
        for driven, ahead in ends_of(subject)
        for case in _near(
            f"{hyphens(driven)}-{LEAST[ahead]}",
            EVERY,
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
