"""The ends of the inputs, where arm, tie rod or the knuckle's upper end lock.

An end is a fold: two assemblies meet there as the root of the distance, rates grow as its inverse root and
the condition number with them. A value held inside an end has a pose, one beyond it has none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from validate.cars.input_limits import Linkage
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.cars import CARS
from validate.hard.case import REFUSED, Case, Expected, decades
from validate.hard.trial import scene_case

ARM_GROUP = "The arm at its dead points"
TOGGLE_GROUP = "Tie rod and steering arm in line"
UPPER_GROUP = "The knuckle's upper end out of reach"
DISTANCE = "distance from the end, in parts of the input's range"
ARM_ANGLES = (1.25, SQUARE, 1.9)  # rad, at which the rack is driven to its ends

# Where pointcoord has to be right, by how it comes near the end. Held: a path is followed until its steps
# shrink below 1e-13 of it, which is at 1e-12 of the way to the end from the drawing, half a range away; ten
# times that is always reached. Moving: a motion goes on while a segment, some tenth of the time that is left,
# is 1e-15 of the whole. Two branches 1e-6 of the car apart, the root of 1e-12, are told apart where the
# condition number, 1e6 or some ten times that, leaves half of the digits; ten times that always is.
RIGHT_FROM = {"held": 1e-11, "moving": 1e-11}
# The absolute model stops where its condition number exceeds 6.7e7, the inverse root of the rounding unit. In
# its own scaling that is 10 to 40 over the root of the distance, so it stops below (40 / 6.7e7)^2 = 4e-13 of
# the range, and at ten times the nearest decade above that no end is near enough to be a reason.
ABSOLUTE_FROM = 1e-11
# The relative model stops where the error that rounding may make of a pose changes its Jacobian by an eighth.
# At the share d of the range from an end that is 2e-15 / d, times five deviations and a factor of the car
# that is a few: some 1e-12, and ten times that is always reached.
RELATIVE_FROM = 1e-11
FULL = decades(-12, -1)
COARSE = (*decades(-11, -1)[::2], 1e-2, 1e-12)
SPARSE = (1e-1, 1e-4, 1e-8, 1e-12)
OUTSIDE = "refused: there is no pose"
LAWS = ("held", "moving", "beyond")


def near_end(law: str) -> dict[str, Expected]:
    """Right down to where each model can still tell the two assemblies apart; then refused with a reason."""
    return {
        "pointcoord": Expected(("right", "refused"), RIGHT_FROM[law]),
        "absolute": Expected(("right", "refused"), ABSOLUTE_FROM),
        "relative": Expected(("right", "refused"), RELATIVE_FROM),
    }


def inside(law: str) -> str:
    """What is expected of values inside an end."""
    return (
        f"right within the bound, by pointcoord down to {RIGHT_FROM[law]:g}, by the absolute model down to "
        f"{ABSOLUTE_FROM:g} and by the relative one down to {RELATIVE_FROM:g}; nearer right or refused, with "
        "a reason"
    )


@cache
def ends(car: str, driven: str, arm_angle: float | None = None) -> tuple[float, float]:
    """The least and the greatest value of an input of a car of `CARS`, rad or mm.

    Args:
        arm_angle: at which the rack is driven; as drawn if not given.
    """
    linkage = Linkage.of(CARS[car])
    held = linkage.home | ({} if arm_angle is None else {"arm_angle": arm_angle})
    low, high = (linkage.end(held, driven, ahead) for ahead in (False, True))
    if low is None or high is None:
        raise ValueError(f"{driven} of the car {car!r} has no end on one of its sides")
    return low[0], high[0]


def rack_ends(car: str, arm_angle: float = SQUARE) -> tuple[float, float]:
    """Least and greatest rack travel, mm, at an arm angle."""
    return ends(car, "rack", arm_angle)


@dataclass(frozen=True)
class Approach:
    """A way to one end of an input of a car.

    Attributes:
        car: its name in `CARS`.
        upper: whether to the greatest value.
        arm_angle: at which the rack is driven.
    """

    car: str
    driven: str
    upper: bool
    arm_angle: float | None = None

    @property
    def ends(self) -> tuple[float, float]:
        """This end and the opposite one."""
        low, high = ends(self.car, self.driven, self.arm_angle)
        return (high, low) if self.upper else (low, high)

    def content(self, value: float, law: str) -> dict[str, Any]:
        """The scene near the end, or beyond it."""
        end, other = self.ends
        near = end + (-value if law == "beyond" else value) * (other - end)
        middle = 0.5 * (end + other)
        # From the middle of the range to the place near its end at a constant rate, in one second.
        way: float | Sequence[float] = [middle, near - middle] if law == "moving" else near
        stop = 1.0 if law == "moving" else None
        if self.driven == "arm_angle":
            return scene_content(CARS[self.car], way, 0.0, stop=stop)
        return scene_content(CARS[self.car], self.arm_angle or SQUARE, way, stop=stop)


def _cases(
    name: str,
    group: str,
    why: str,
    approach: Approach,
    values: tuple[float, ...] | None = None,
    newton: bool = False,
    laws: Sequence[str] = LAWS,
    suffix: str = "",
) -> tuple[Case, ...]:
    more = {
        "held": "",
        "moving": "; the motion ends near it, with rates as the inverse root of the distance",
        "beyond": "; the input is beyond that",
    }

    def expected(law: str) -> dict[str, Expected]:
        found = (
            dict.fromkeys(("pointcoord", "absolute", "relative"), REFUSED)
            if law == "beyond"
            else near_end(law)
        )
        return found | ({"pointcoord-newton": found["pointcoord"]} if newton else {})

    def case(law: str) -> Case:
        return scene_case(
            name=f"{name}{f'-{law}' if len(laws) > 1 else ''}{suffix}",
            group=group,
            why=why + more[law],
            parameter=DISTANCE + (", beyond it" if law == "beyond" else ""),
            # A motion takes longest; with another car than the first few values must do.
            values=values or (COARSE if law == "moving" and suffix else FULL),
            scene=lambda value: approach.content(value, law),
            expected=expected(law),
            behaviour=OUTSIDE if law == "beyond" else inside(law),
        )

    return tuple(case(law) for law in laws)


HIGHEST = ("highest", "lowest")
TRAVEL = ("at its least", "at its greatest")


def _arm_cases(car: str, suffix: str, values: tuple[float, ...] | None = None) -> tuple[Case, ...]:
    # The ball joint is highest at the least angle.
    return tuple(
        case
        for upper in (False, True)
        for case in _cases(
            f"arm-{HIGHEST[upper]}",
            ARM_GROUP,
            f"the ball joint is {HIGHEST[upper]} on its circle: its height says no more",
            Approach(car, "arm_angle", upper),
            values,
            suffix=suffix,
        )
    )


def _rack_cases(
    car: str, suffix: str, angle: float = SQUARE, where: str = "", values: tuple[float, ...] | None = None
) -> tuple[Case, ...]:
    return tuple(
        case
        for upper in (False, True)
        for case in _cases(
            f"rack-{('least', 'greatest')[upper]}{where}",
            TOGGLE_GROUP,
            f"the rack is {TRAVEL[upper]} travel at {angle:.4g} rad: tie rod and steering arm lie in line",
            Approach(car, "rack", upper, angle),
            values,
            laws=("held",) if where else LAWS,
            suffix=suffix,
        )
    )


CASES: tuple[Case, ...] = (
    *_arm_cases("paper", ""),
    *_arm_cases("other", "-turned"),
    *_arm_cases("short-arm", "-wishbone", SPARSE),
    *_rack_cases("paper", ""),
    *_rack_cases("other", "-turned"),
    *_rack_cases("wishbone", "-wishbone", values=SPARSE),
    *_rack_cases("paper", "", ARM_ANGLES[0], "-arm-high"),
    *_rack_cases("paper", "", ARM_ANGLES[2], "-arm-low"),
    *_cases(
        "slide-runs-out",
        UPPER_GROUP,
        "the ball joint is as near to the strut's top as it lies beside the axis: it has no more way",
        Approach("wide", "arm_angle", False),
        FULL,
        newton=True,
    ),
    *_cases(
        "upper-arm-locks",
        UPPER_GROUP,
        "upper arm and kingpin of a double wishbone lie in one plane with the upper pivots",
        Approach("wishbone", "arm_angle", True),
        COARSE[::2],
        newton=True,
    ),
)
