"""Groups 1 and 2: the ends of the inputs, where the arm or the tie rod locks.

An end is a fold: two assemblies meet there as the root of the distance, rates grow as its inverse root and
the condition number with them. A value held inside an end has a pose, one beyond it has none.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from validate.cars.car import Car
from validate.cars.input_limits import Linkage
from validate.cars.scene_content import scene_content
from validate.hard.cars import OTHER_CAR, PAPER_CAR
from validate.hard.case import REFUSED, Case, Expected, decades
from validate.hard.trial import scene_case

ARM_GROUP = "1. The arm at its dead points"
TOGGLE_GROUP = "2. Tie rod and steering arm in line"
DISTANCE = "distance from the end, in parts of the input's range"

CARS = {"": PAPER_CAR, "-turned": OTHER_CAR}
ARM_ANGLES = (1.25, 1.5707963267948966, 1.9)  # rad, at which the rack is driven to its ends

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
COARSE = (*decades(-11, -1)[::2], 1e-2, 1e-12)
BEYOND = {"pointcoord": REFUSED, "absolute": REFUSED}
OUTSIDE = "refused: there is no pose"


def near_end(law: str) -> dict[str, Expected]:
    """Right down to where each model can still tell the two assemblies apart; then refused with a reason."""
    return {
        "pointcoord": Expected(("right", "refused"), RIGHT_FROM[law]),
        "absolute": Expected(("right", "refused"), ABSOLUTE_FROM),
    }


def inside(law: str) -> str:
    """What is expected of values inside an end."""
    return (
        f"right within the bound, by pointcoord down to {RIGHT_FROM[law]:g} and by the absolute model down "
        f"to {ABSOLUTE_FROM:g}; nearer right or refused with a reason"
    )


@cache
def arm_ends(car_key: str) -> tuple[float, float]:
    """Arm angles of the highest and of the lowest ball joint, rad."""
    return Linkage.of(CARS[car_key]).dead_points()


@cache
def rack_ends(car_key: str, arm_angle: float) -> tuple[float, float]:
    """Least and greatest rack travel, mm, at an arm angle."""
    linkage = Linkage.of(CARS[car_key])
    held = {"arm_angle": arm_angle, "rack": linkage.drawn_rack, "heave": 0.0}
    ends = [linkage.end(held, "rack", ahead) for ahead in (False, True)]
    low, high = (end[0] for end in ends if end is not None)
    return low, high


def _arm_case(name: str, car_key: str, place: int, law: str) -> Case:
    car, ends = CARS[car_key], arm_ends(car_key)
    end, across = ends[place], ends[1 - place] - ends[place]

    def content(value: float) -> dict[str, Any]:
        near = end + (-value if law == "beyond" else value) * across
        return _content(car, law, near, 0.5 * (ends[0] + ends[1]), lambda angle: (angle, 0.0))

    which = ("highest", "lowest")[place]
    return _case(
        name,
        ARM_GROUP,
        law,
        car_key,
        f"the ball joint is {which} on its circle: its height says no more",
        content,
    )


def _toggle_case(name: str, car_key: str, place: int, law: str, arm_angle: float) -> Case:
    car, ends = CARS[car_key], rack_ends(car_key, arm_angle)
    end, across = ends[place], ends[1 - place] - ends[place]

    def content(value: float) -> dict[str, Any]:
        near = end + (-value if law == "beyond" else value) * across
        return _content(car, law, near, 0.5 * (ends[0] + ends[1]), lambda travel: (arm_angle, travel))

    how = ("at its least", "at its greatest")[place]
    why = f"the rack is {how} travel at {arm_angle:.4g} rad: tie rod and steering arm lie in line"
    return _case(name, TOGGLE_GROUP, law, car_key, why, content)


def _content(
    car: Car, law: str, near: float, middle: float, inputs: Callable[[Any], tuple[Any, Any]]
) -> dict[str, Any]:
    if law == "moving":
        # From the middle of the range to the place near its end at a constant rate, in one second.
        return scene_content(car, *inputs([middle, near - middle]), stop=1.0)
    return scene_content(car, *inputs(near))


def _case(
    name: str, group: str, law: str, car_key: str, why: str, content: Callable[[float], dict[str, Any]]
) -> Case:
    more = {
        "held": "",
        "moving": "; the motion ends near it, with rates as the inverse root of the distance",
        "beyond": "; the input is beyond that",
    }
    return scene_case(
        name=name,
        group=group,
        why=why + more[law],
        parameter=DISTANCE,
        # A motion takes longest; with the other car it is tried at every second decade and at the end.
        values=decades(-12, -1) if law != "moving" or car_key == "" else COARSE,
        scene=content,
        expected=BEYOND if law == "beyond" else near_end(law),
        behaviour=OUTSIDE if law == "beyond" else inside(law),
    )


LAWS = ("held", "moving", "beyond")
CASES: tuple[Case, ...] = (
    *(
        _arm_case(f"arm-{('highest', 'lowest')[place]}-{law}{key}", key, place, law)
        for key in CARS
        for place in (0, 1)
        for law in LAWS
    ),
    *(
        _toggle_case(f"rack-{('least', 'greatest')[place]}-{law}{key}", key, place, law, ARM_ANGLES[1])
        for key in CARS
        for place in (0, 1)
        for law in LAWS
    ),
    *(
        _toggle_case(f"rack-{('least', 'greatest')[place]}-arm-{name}", "", place, "held", angle)
        for name, angle in (("high", ARM_ANGLES[0]), ("low", ARM_ANGLES[2]))
        for place in (0, 1)
    ),
)
