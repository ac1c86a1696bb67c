"""Two assemblies close together, starts far from the drawing, large steps: the branch must be the drawing's.

Of the assemblies of a pose the one that is meant has the four signs of the drawing (see `Choices`). The
reference is that assembly, so a solution that has jumped to another one is wrong however well its links
close. What is measured besides is how many assemblies there are (a polynomial of degree 64 bounds them; a
search from a thousand starts lists them).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from validate.cars.scene_content import Law, content_of
from validate.hard.cars import drawn_angle, paper_car
from validate.hard.case import REFUSED, RIGHT, Case, Expected, coarse, decades
from validate.hard.cases.counting import MEETINGS, counting_cases
from validate.hard.cases.near_points import assembled, flat_upper_arm
from validate.hard.family import NAMED, OTHERS, PAPER, SOLVERS, WISHBONE, Content, Subject, hyphens
from validate.hard.last_values import ends_of, last_value
from validate.hard.trial import scene_case

GROUP = "Branches"
# rad: half the motion through the place where the branches nearly meet; a dead point is 0.05 rad below it.
WIDE = {"paper": 0.05, "beside": 0.04}
# A motion through such a place takes half a second, so few values must do.
EVEN, ODD, FEW = decades()[::2], (*decades(-11, -1)[::2], 1e-12), decades()[::4]
CLEAR = Expected(("right", "refused"), right_from=1e-6)
# The product of vectors that tells the side of the paper's tie rod is 0.56 of their lengths. Assembling moves
# no point by more than 200 mm times the parameter, which changes each vector of that product by twice as much
# at most: at 0.1 by 40 mm of some 530, 430 and 150, 0.08 + 0.09 + 0.27 < 0.56 in all: no fold is on the way.
# At 1 the lower point, 61 mm from the ball joint, is drawn so far aside that their line misses the top by
# 440 mm, and that sum is above 4: the way back is each model's own, and a fold may lie on it.
STRAIGHTENED = Expected(("right", "refused"), right_to=0.1)


def through_the_meeting(share: float, side: float, car: str = "paper") -> Content:
    """The arm runs through the angle of the meeting, the rack `share` of 10 mm on one side of it."""
    angle, rack = MEETINGS[car]
    law = (angle + WIDE[car], -2.0 * WIDE[car])
    inputs: dict[str, Law] = {"arm_angle": law, "rack": rack + side * 10.0 * share}
    return NAMED[car].absolute(inputs, stop=1.0, samples=5)


def flat_car(share: float, mirrored: bool) -> dict[str, np.ndarray]:
    """The tie rod's outer end near the plane of kingpin and rack, on its own side or on the other."""
    p = assembled()
    ball = p["lower_ball_joint"]
    normal = np.cross(p["strut_lower"] - ball, p["tie_rod_inner"] - ball)
    normal /= np.linalg.norm(normal)
    height = float((p["tie_rod_outer"] - ball) @ normal)
    moved = (-share if mirrored else share) - 1.0
    return {**p, "tie_rod_outer": p["tie_rod_outer"] + moved * height * normal}


def from_a_flat_drawing(share: float, mirrored: bool) -> Content:
    """From a drawing where the rod is all but locked, the rack runs to where it is not."""
    points = {name: place.tolist() for name, place in flat_car(share, mirrored).items()}
    return paper_car(PAPER.drawn["arm_angle"], (0.0, 0.0, 20.0), points=points, stop=1.0, samples=3)


def crooked(share: float) -> Content:
    """The strut's inner points drawn off its line, by up to 100 mm to opposite sides."""
    aside = 100.0 * share
    points = {name: place.tolist() for name, place in assembled().items()}
    points["strut_lower"][0] += aside
    points["strut_rod_end"][0] -= aside
    points["strut_rod_end"][1] += aside
    return paper_car((PAPER.drawn["arm_angle"], 0.1), (0.0, 10.0), points=points, stop=1.0)


def far_start(share: float, subject: Subject, driven: str, ahead: bool) -> Content:
    """The first instant near the last value of an input, by a share of half its range, the others at home."""
    last = last_value(subject, driven, ahead)
    law = (last.beyond(-0.5 * share), (-0.01 if ahead else 0.01) * last.reach)
    return subject.absolute({**subject.home, driven: law}, stop=1.0, samples=2)


def whole_range(share: float, subject: Subject, driven: str) -> Content:
    """Two instants, near both ends of an input."""
    low, high = (last_value(subject, driven, ahead).beyond(-0.5 * share) for ahead in (False, True))
    return subject.absolute({**subject.home, driven: (high, low - high)}, stop=1.0, samples=2)


def from_a_flat_wishbone(share: float, mirrored: bool) -> Content:
    """The upper ball joint drawn near the plane of its pivots and the lower one, from where the arm goes."""
    car = WISHBONE.car.drawn_as(flat_upper_arm(-share if mirrored else share))
    inputs: dict[str, Law] = {"arm_angle": (drawn_angle(car), 0.0, -0.02), "rack": 0.0}
    return content_of(car, inputs, stop=1.0, samples=3)


def _case(
    name: str,
    why: str,
    parameter: str,
    scene: Callable[[float], Content],
    expected: Expected,
    values: tuple[float, ...] = decades(),
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
        also_answered=also_answered,
    )


FAR = "The drawing is the start guess, and the first instant lies at the far end of the range."
WHOLE = "Two instants, and between them the whole range of an input: one step could leap over it."


def _ends_cases() -> tuple[Case, ...]:
    """Far starts and whole ranges of inputs."""
    starts = [
        (subject, where, driven, ahead, values)
        for subject, values in ((PAPER, FEW), (WISHBONE, FEW[::3]))
        for where, driven, ahead in (("high", "arm_angle", False), ("rack", "rack", True))
    ]
    wholes = [
        (subject, where, driven, values, also)
        for subject, values, also in ((PAPER, FEW[1:], ()), (WISHBONE, FEW[2:], FEW[2:3]))
        for where, driven in (("arm", "arm_angle"), ("rack", "rack"))
    ]
    for subject in OTHERS:
        ends = ends_of(subject)
        starts += [(subject, hyphens(driven), driven, ahead, (1e-4,)) for driven, ahead in ends if ahead]
        wholes += [
            (subject, hyphens(driven), driven, (1e-4,), ())
            for driven in subject.kinds
            if {(driven, False), (driven, True)} <= set(ends)
        ]
    return (
        *(
            _case(
                f"far-start-{where}{subject.suffix}",
                FAR,
                "distance of the first instant from the end, in parts of half the range",
                partial(far_start, subject=subject, driven=driven, ahead=ahead),
                CLEAR,
                values,
            )
            for subject, where, driven, ahead, values in starts
        ),
        *(
            _case(
                f"whole-range-{where}{subject.suffix}",
                WHOLE,
                "distance of both instants from their ends, in parts of half the range",
                partial(whole_range, subject=subject, driven=driven),
                CLEAR,
                values,
                also_answered=also,
            )
            for subject, where, driven, values, also in wholes
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
    ),
    _case(
        "branches-met",
        f"{NEAR_MEETING} and meet, so that there is a gap that a large step may leap.",
        "rack travel short of the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=-1.0),
        REFUSED,
        ODD,
    ),
    _case(
        "branches-nearly-meet-beside",
        f"{NEAR_MEETING} in the car whose strut passes beside the ball joint as well.",
        "rack travel beyond the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=1.0, car="beside"),
        CLEAR,
        FEW,
    ),
    _case(
        "branches-met-beside",
        f"{NEAR_MEETING} and meet, in the car whose strut passes beside the ball joint.",
        "rack travel short of the meeting, in parts of 10 mm",
        partial(through_the_meeting, side=-1.0, car="beside"),
        REFUSED,
        ODD[::2],
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
        also_answered=(1.0,),
    ),
    *_ends_cases(),
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
