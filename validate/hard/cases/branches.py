"""Two assemblies close together, starts far from the drawing, large steps: the branch must be the drawing's.

Of the assemblies of a pose the one that is meant has the four signs of the drawing (see `Choices`). The
reference is that assembly, so a solution that has jumped to another one is wrong however well its links
close. What is measured besides: the oriented products themselves (see `oriented`), how far apart the two
assemblies are, and how many there are (a polynomial of degree 64 bounds them; a search from a thousand starts
lists them).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from validate.cars.input_limits import Linkage
from validate.cars.scene_content import SQUARE, Law, scene_content
from validate.hard.cars import CARS, EVERY, paper_car
from validate.hard.case import REFUSED, RIGHT, Case, Expected, coarse, decades
from validate.hard.cases.counting import counting_cases, meeting
from validate.hard.cases.near_points import assembled, drawn_angle, flat_upper_arm
from validate.hard.cases.oriented import followed
from validate.hard.last_values import last_value
from validate.hard.trial import Facts, Tried, scene_case

GROUP = "Branches"
SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
# rad: half the motion through the place where the branches nearly meet; a dead point is 0.05 rad below it.
WIDE = {"paper": 0.05, "beside": 0.04}
# A motion through such a place takes half a second, so few values must do.
EVEN, ODD, FEW = decades()[::2], (*decades(-11, -1)[::2], 1e-12), decades()[::4]
CLEAR = Expected(("right", "refused"), right_from=1e-6)
# The paper's tie rod stands at 0.56 of what its side can be (see `oriented`). Assembling moves no point by
# more than 200 mm times the parameter, which changes each vector of that product by twice as much at most:
# at 0.1 by 40 mm of some 530, 430 and 150, together 0.08 + 0.09 + 0.27 < 0.56, so that no fold is on the way.
STRAIGHTENED = Expected(("right", "refused"), right_from=0.1)


def through_the_meeting(share: float, side: float, car: str = "paper") -> Mapping[str, Any]:
    """The arm runs through the angle of the meeting, the rack `share` of 10 mm on one side of it."""
    angle, rack = meeting(car)
    law = (angle + WIDE[car], -2.0 * WIDE[car])
    return scene_content(CARS[car], law, rack + side * 10.0 * share, stop=1.0, samples=5)


def near_meeting(tried: Tried, car: str = "paper") -> Facts:
    """The sides, and how far apart the two assemblies are in the middle of the motion."""
    facts = dict(followed(tried))
    linkage, rack = Linkage.of(CARS[car]), tried.scene.functions["rack"].series(0.5, 0)[0]
    spare = float(linkage.spare(np.array(meeting(car)[0]), np.array(rack)))
    facts["assemblies apart [mm]"] = 2.0 * linkage.steering_arm * math.sqrt(max(spare, 0.0))
    return facts


def flat_car(share: float, mirrored: bool) -> dict[str, np.ndarray]:
    """The tie rod's outer end near the plane of kingpin and rack, on its own side or on the other."""
    p = assembled()
    ball = p["lower_ball_joint"]
    normal = np.cross(p["strut_lower"] - ball, p["tie_rod_inner"] - ball)
    normal /= np.linalg.norm(normal)
    height = float((p["tie_rod_outer"] - ball) @ normal)
    moved = (-share if mirrored else share) - 1.0
    return {**p, "tie_rod_outer": p["tie_rod_outer"] + moved * height * normal}


def from_a_flat_drawing(share: float, mirrored: bool) -> Mapping[str, Any]:
    """From a drawing where the rod is all but locked, the rack runs to where it is not."""
    points = {name: place.tolist() for name, place in flat_car(share, mirrored).items()}
    return paper_car(drawn_angle(), (0.0, 0.0, 20.0), points=points, stop=1.0, samples=3)


def crooked(share: float) -> Mapping[str, Any]:
    """The strut's inner points drawn off its line, by up to 100 mm to opposite sides."""
    aside = 100.0 * share
    points = {name: place.tolist() for name, place in assembled().items()}
    points["strut_lower"][0] += aside
    points["strut_rod_end"][0] -= aside
    points["strut_rod_end"][1] += aside
    return paper_car((drawn_angle(), 0.1), (0.0, 10.0), points=points, stop=1.0)


def near_ends(share: float, car: str, driven: str, *ahead: bool) -> list[float]:
    """Values of an input `share` of half its range inside its ends."""
    return [last_value(car, driven, way).beyond(-0.5 * share) for way in ahead]


def far_start(share: float, driven: str, ahead: bool, car: str = "paper") -> Mapping[str, Any]:
    """The first instant near the last value of an input, the drawing amid its range."""
    (begin,) = near_ends(share, car, driven, ahead)
    reach = last_value(car, driven, ahead).reach
    return _driven(car, driven, (begin, (-0.01 if ahead else 0.01) * reach))


def whole_range(share: float, driven: str, car: str = "paper") -> Mapping[str, Any]:
    """Two instants, near both ends of an input."""
    low, high = near_ends(share, car, driven, False, True)
    return _driven(car, driven, (high, low - high))


def _driven(car: str, driven: str, law: tuple[float, float]) -> Mapping[str, Any]:
    laws: tuple[Law, Law] = (law, 0.0) if driven == "arm_angle" else (SQUARE, law)
    return scene_content(CARS[car], *laws, stop=1.0, samples=2)


def from_a_flat_wishbone(share: float, mirrored: bool) -> Mapping[str, Any]:
    """The upper ball joint drawn near the plane of its pivots and the lower one, from where the arm goes."""
    car = CARS["wishbone"].drawn_as(flat_upper_arm(-share if mirrored else share))
    return scene_content(car, (Linkage.of(car).drawn_angle, 0.0, -0.02), 0.0, stop=1.0, samples=3)


def _case(
    name: str,
    why: str,
    parameter: str,
    scene: Callable[[float], Mapping[str, Any]],
    expected: Expected,
    values: tuple[float, ...] = decades(),
    measure: Callable[[Tried], Facts] = followed,
    also_answered: tuple[float, ...] = (),
) -> Case:
    behaviour = {
        REFUSED: "refused: the middle instant has no pose",
        RIGHT: "the branch of the drawing at every instant",
    }.get(expected, "the branch of the drawing, or a refusal")
    return scene_case(
        name=name,
        group=GROUP,
        why=why,
        parameter=parameter,
        values=values,
        expected=dict.fromkeys(SOLVERS, expected),
        behaviour=behaviour,
        scene=scene,
        measure=measure,
        also_answered=also_answered,
    )


def _range_cases(suffix: str, car: str) -> tuple[Case, ...]:
    """Cases of the whole range of inputs."""
    return (
        *(
            _case(
                f"far-start-{where}{suffix}",
                "The drawing is the start guess, and the first instant lies at the far end of the range.",
                "distance of the first instant from the end, in parts of half the range",
                partial(far_start, driven=driven, ahead=ahead, car=car),
                CLEAR,
                FEW[::3] if suffix else FEW,
            )
            for where, driven, ahead in (("high", "arm_angle", False), ("rack", "rack", True))
        ),
        *(
            _case(
                f"whole-range-{where}{suffix}",
                "Two instants, and between them the whole range of an input: one step could leap over it.",
                "distance of both instants from their ends, in parts of half the range",
                partial(whole_range, driven=driven, car=car),
                CLEAR,
                FEW[2:] if suffix else FEW[1:],
                also_answered=FEW[2:3] if suffix else (),
            )
            for where, driven in (("arm", "arm_angle"), ("rack", "rack"))
        ),
    )


NEAR_MEETING = "The tie rod's two assemblies come near each other as the arm passes 35 degrees"
CASES: tuple[Case, ...] = (
    _case(
        "branches-nearly-meet",
        f"{NEAR_MEETING}, and a step may end on the other one.",
        "rack travel beyond the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=1.0),
        CLEAR,
        EVEN,
        measure=near_meeting,
    ),
    _case(
        "branches-met",
        f"{NEAR_MEETING} and meet, so that there is a gap that a large step may leap.",
        "rack travel short of the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=-1.0),
        REFUSED,
        ODD,
        measure=near_meeting,
    ),
    _case(
        "branches-nearly-meet-beside",
        f"{NEAR_MEETING} in the car whose strut passes beside the ball joint as well.",
        "rack travel beyond the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=1.0, car="beside"),
        CLEAR,
        FEW,
        measure=partial(near_meeting, car="beside"),
    ),
    _case(
        "branches-met-beside",
        f"{NEAR_MEETING} and meet, in the car whose strut passes beside the ball joint.",
        "rack travel short of the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=-1.0, car="beside"),
        REFUSED,
        ODD[::2],
        measure=partial(near_meeting, car="beside"),
    ),
    *(
        _case(
            f"flat-drawing{'-mirrored' if mirrored else ''}",
            "The drawing is close to its mirror image in the plane of kingpin and rack: rounding may choose.",
            "height of the tie rod's outer end over that plane, in parts of the paper's",
            partial(from_a_flat_drawing, mirrored=mirrored),
            CLEAR,
            decades(),
        )
        for mirrored in (False, True)
    ),
    _case(
        "crooked-drawing",
        "The drawing is the start of the assembly, and stands far from it.",
        "the strut's inner points off its line, in parts of 100 mm",
        crooked,
        STRAIGHTENED,
    ),
    *(case for suffix, car in EVERY.items() for case in _range_cases(suffix, car)),
    *(
        _case(
            f"flat-drawing{'-mirrored' if mirrored else ''}-wishbone",
            "The drawing is close to its mirror image in the plane of the upper arm: rounding may choose.",
            "height of the upper ball joint over that plane, in parts of the car's",
            partial(from_a_flat_wishbone, mirrored=mirrored),
            CLEAR,
            coarse(decades()),
        )
        for mirrored in (False, True)
    ),
    *counting_cases(GROUP, CLEAR),
)
