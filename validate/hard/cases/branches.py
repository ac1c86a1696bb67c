"""Two assemblies close together, starts far from the drawing, large steps: the branch must be the drawing's.

Of the assemblies of a pose the one that is meant has the four signs of the drawing (see `Choices`). The
reference is that assembly, so a solution that has jumped to another one is wrong however well its links
close. What is measured besides is how many assemblies there are: a search from a thousand starts lists those
that it finds, each with its proof, and the literature reduces this strut to a polynomial of degree 64, which
bounds them from above.

Some mechanisms are hard by nature. With cranks and couplers in one line, the parallelograms of a coupled
four-bar meet the assemblies with crossed cranks: beyond that pose there are poses of both, and none that is
reached from the drawing without a singular one. Bricard's ring of six hinges has as many rows as coordinates
and yet moves: a model that cannot hold such a mechanism has to refuse it with the reason. Where no reference
is to be had of it nothing is judged here, and the tests of mechanisms hold it to its closed form.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from pointcoord import Scene
from validate.adjudication.reference_solution import design_of, inputs_at
from validate.cars.scene_content import Law, content_of
from validate.hard.cars import SQUARE, drawn_angle, paper_car
from validate.hard.case import REFUSED, RIGHT, Case, Expected, Trial, coarse, decades
from validate.hard.cases.points import assembled, flat_upper_arm
from validate.hard.family import (
    NAMED,
    OTHERS,
    PAPER,
    SOLVERS,
    WISHBONE,
    Content,
    Subject,
    expected_of,
    hyphens,
)
from validate.hard.last_values import ends_of, last_value
from validate.hard.trial import scene_case
from validate.reference import count_assemblies

GROUP = "Branches"
# Arm angle, rad, and rack travel, mm, at which the two sides of the tie rod just meet, by car: at less rack
# travel the arm cannot pass this angle, at more it can.
MEETINGS: Mapping[str, tuple[float, float]] = {
    "paper": (0.6129246396239625, -0.00292320063271574),
    "beside": (0.6117454829993613, -3.0987778880673007),
}
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


def from_a_flat_wishbone(share: float, mirrored: bool) -> Content:
    """The upper ball joint drawn near the plane of its pivots and the lower one, from where the arm goes."""
    car = WISHBONE.car.drawn_as(flat_upper_arm(assembled("wishbone"), -share if mirrored else share))
    inputs: dict[str, Law] = {"arm_angle": (drawn_angle(car), 0.0, -0.02), "rack": 0.0}
    return content_of(car, inputs, stop=1.0, samples=3)


def crooked(share: float) -> Content:
    """The strut's inner points drawn off its line, by up to 100 mm to opposite sides."""
    aside = 100.0 * share
    points = {name: place.tolist() for name, place in assembled().items()}
    points["strut_lower"][0] += aside
    points["strut_rod_end"][0] -= aside
    points["strut_rod_end"][1] += aside
    return paper_car((PAPER.drawn["arm_angle"], 0.1), (0.0, 10.0), points=points, stop=1.0)


def far_start(subject: Subject, driven: str, ahead: bool, share: float) -> Content:
    """The first instant near the last value of an input, by a share of half its range, the others at home."""
    last = last_value(subject, driven, ahead)
    law = (last.beyond(-0.5 * share), (-0.01 if ahead else 0.01) * last.reach)
    return subject.absolute({**subject.home, driven: law}, stop=1.0, samples=2)


def whole_range(subject: Subject, driven: str, share: float) -> Content:
    """Two instants, near both ends of an input."""
    low, high = (last_value(subject, driven, ahead).beyond(-0.5 * share) for ahead in (False, True))
    return subject.absolute({**subject.home, driven: (high, low - high)}, stop=1.0, samples=2)


def _case(
    name: str,
    why: str,
    parameter: str,
    scene: Callable[[float], Content],
    values: tuple[float, ...],
    expected: Expected = CLEAR,
    also_answered: tuple[float, ...] = (),
) -> Case:
    return scene_case(
        name=name,
        group=GROUP,
        why=why,
        parameter=parameter,
        values=values,
        expected=dict.fromkeys(SOLVERS, expected),
        scene=scene,
        also_answered=also_answered,
    )


def _far_starts() -> Iterator[Case]:
    starts = [
        (subject, where, driven, ahead, values)
        for subject, values in ((PAPER, FEW), (WISHBONE, FEW[::3]))
        for where, driven, ahead in (("high", "arm_angle", False), ("rack", "rack", True))
    ]
    starts += [
        (subject, hyphens(driven), driven, ahead, (1e-4,))
        for subject in OTHERS
        for driven, ahead in ends_of(subject)
        if ahead
    ]
    for subject, where, driven, ahead, values in starts:
        yield _case(
            f"far-start-{where}{subject.suffix}",
            "The drawing is the start guess, and the first instant lies at the far end of the range.",
            "distance of the first instant from the end, in parts of half the range",
            partial(far_start, subject, driven, ahead),
            values,
        )


def _whole_ranges() -> Iterator[Case]:
    wholes = [
        (subject, where, driven, values, also)
        for subject, values, also in ((PAPER, FEW[1:], ()), (WISHBONE, FEW[2:], FEW[2:3]))
        for where, driven in (("arm", "arm_angle"), ("rack", "rack"))
    ]
    wholes += [
        (subject, hyphens(driven), driven, (1e-4,), ())
        for subject in OTHERS
        for driven in subject.kinds
        if {(driven, False), (driven, True)} <= set(ends_of(subject))
    ]
    for subject, where, driven, values, also in wholes:
        yield _case(
            f"whole-range-{where}{subject.suffix}",
            "Two instants, and between them the whole range of an input: one step could leap over it.",
            "distance of both instants from their ends, in parts of half the range",
            partial(whole_range, subject, driven),
            values,
            also_answered=also,
        )


# Poses near a singular one, or at the drawing, of which the assemblies are counted.
STARTS = 1000
DEGREE = 64  # of the polynomial of the collinear strut in the literature
Pose = Callable[[Subject, float], tuple[float, float]]


def near_greatest_rack(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel near the last value of the rack."""
    return SQUARE, last_value(subject, "rack", True).beyond(-share)


def near_lowest_arm(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel near the last value of the arm angle."""
    return last_value(subject, "arm_angle", True).beyond(-share), 0.0


def beside_meeting(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel where the two sides of the tie rod nearly meet."""
    angle, rack = MEETINGS[subject.name]
    return angle, rack + 10.0 * share


def beside_drawing(subject: Subject, share: float) -> tuple[float, float]:
    """Arm angle and rack travel some ordinary way from those of the drawing, far from every singular pose."""
    return subject.drawn["arm_angle"] - 0.2 * share, subject.drawn["rack"] + 30.0 * share


MERGING = "Closed forms say how many assemblies a pose may have, and near a singular pose two of them merge."
NEAR = decades(-12, -1)[::3]
FEWER = (1e-1, 1e-10)  # each value is a search from a thousand starts
# Name, why, parameter, pose, values of the strut and of the wishbone.
POSES: tuple[tuple[str, str, str, Pose, tuple[float, ...], tuple[float, ...]], ...] = (
    (
        "drawing",
        "Of all assemblies of an ordinary pose, up to sixteen by closed forms, one is meant.",
        "arm and rack from the drawing, in parts of 0.2 rad and 30 mm; then at it",
        beside_drawing,
        (1.0, 0.1, 0.0),
        (1.0, 0.0),
    ),
    (
        "rack",
        MERGING,
        "distance from the greatest rack travel, in parts of its range",
        near_greatest_rack,
        NEAR,
        FEWER,
    ),
    (
        "arm",
        MERGING,
        "distance from the greatest arm angle, in parts of its range",
        near_lowest_arm,
        NEAR,
        FEWER,
    ),
    (
        "meeting",
        MERGING,
        "rack travel beyond the meeting of two branches, in parts of 10 mm",
        beside_meeting,
        NEAR,
        (),
    ),
)


def _counting() -> Iterator[Case]:
    for where, why, parameter, pose, *both in POSES:
        for subject, values in zip((PAPER, WISHBONE), both, strict=True):
            if not values:
                continue

            def posed(share: float, pose: Pose = pose, subject: Subject = subject) -> Content:
                return subject.absolute(dict(zip(subject.kinds, pose(subject, share), strict=True)))

            def counted(share: float, trial: Trial, posed: Callable[[float], Content] = posed) -> Trial:
                scene = Scene.from_mapping(posed(share))
                listed = count_assemblies(design_of(scene), inputs_at(scene, 0.0), starts=STARTS)
                facts: dict[str, float | str] = {
                    "assemblies found, proven": float(len(listed.found)),
                    "starts": float(listed.starts),
                }
                return replace(trial, facts={**trial.facts, **facts})

            yield scene_case(
                name=f"assemblies-counted-{where}{subject.suffix}",
                group=GROUP,
                why=why,
                parameter=parameter,
                values=values,
                scene=posed,
                expected=dict.fromkeys(SOLVERS, RIGHT if where == "drawing" else CLEAR),
                behaviour="of all assemblies that a search finds, the one of the drawing",
                judged=counted,
            )


NEAR_MEETING = "The tie rod's two assemblies come near each other as the arm passes 35 degrees"
BEYOND, SHORT = (f"rack travel {where} the meeting, in parts of 10 mm" for where in ("beyond", "short of"))
BRANCHES: tuple[Case, ...] = (
    _case(
        "branches-nearly-meet",
        f"{NEAR_MEETING}, and a step may end on the other one.",
        BEYOND,
        partial(through_the_meeting, side=1.0),
        EVEN,
    ),
    _case(
        "branches-met",
        f"{NEAR_MEETING} and meet, so that there is a gap that a large step may leap.",
        SHORT,
        partial(through_the_meeting, side=-1.0),
        ODD,
        REFUSED,
    ),
    _case(
        "branches-nearly-meet-beside",
        f"{NEAR_MEETING} in the car whose strut passes beside the ball joint as well.",
        BEYOND,
        partial(through_the_meeting, side=1.0, car="beside"),
        FEW,
    ),
    _case(
        "branches-met-beside",
        f"{NEAR_MEETING} and meet, in the car whose strut passes beside the ball joint.",
        SHORT,
        partial(through_the_meeting, side=-1.0, car="beside"),
        ODD[::2],
        REFUSED,
    ),
    *(
        _case(
            f"flat-drawing{'-mirrored' if mirrored else ''}",
            "The drawing is close to its mirror image in the plane of kingpin and rack: rounding may choose.",
            "height of the tie rod's outer end over that plane, in parts of the paper's",
            partial(from_a_flat_drawing, mirrored=mirrored),
            decades(),
        )
        for mirrored in (False, True)
    ),
    _case(
        "crooked-drawing",
        "The drawing is the start of the assembly, and stands far from it.",
        "the strut's inner points off its line, in parts of 100 mm",
        crooked,
        decades(),
        STRAIGHTENED,
        also_answered=(1.0,),
    ),
    *_far_starts(),
    *_whole_ranges(),
    *(
        _case(
            f"flat-drawing{'-mirrored' if mirrored else ''}-wishbone",
            "The drawing is close to its mirror image in the plane of the upper arm: rounding may choose.",
            "height of the upper ball joint over that plane, in parts of the car's",
            partial(from_a_flat_wishbone, mirrored=mirrored),
            coarse(decades()),
        )
        for mirrored in (False, True)
    ),
    *_counting(),
)

# Turn of the drawing, rad, at which branches cross, or beyond which there is none.
BY_NATURE = {
    "n_four_bar": (-0.5 * math.pi, "its branches cross."),
    "bricard": (-math.pi / 6.0, "its ring goes no further."),
}
# Name, why, whether beyond that turn, whether it moves there from the drawing.
NEAR_THE_LINE = (
    ("held-near-the-line", "It rests near the pose where", False, False),
    ("swept-near-the-line", "It moves from the drawing to near the pose where", False, True),
    ("held-beyond-the-line", "It is to be beyond the pose where", True, False),
    ("swept-through-the-line", "It is to move through the pose where", True, True),
)


def _to_the_line(subject: Subject, turn: float, beyond: bool, moving: bool, value: float) -> Content:
    """A share of the way from the drawing short of a turn, or beyond it: at rest there, or there in 1 s."""
    (driven,) = subject.kinds
    goal = turn * (1.0 - (-value if beyond else value))
    if moving:
        return subject.absolute({driven: [0.0, goal]}, stop=1.0, samples=3)
    return subject.absolute({driven: goal})


CASES: tuple[Case, ...] = (
    *BRANCHES,
    *(
        scene_case(
            name=f"{name}{subject.suffix}",
            group="Mechanisms that are hard by nature",
            why=f"{why} {BY_NATURE[subject.name][1]}",
            parameter="distance from it, in parts of the way from the drawing"
            + (", beyond" if beyond else ""),
            values=(1e-2,) if beyond else (1e-1, 1e-4),
            scene=partial(_to_the_line, subject, BY_NATURE[subject.name][0], beyond, moving),
            expected=dict.fromkeys(SOLVERS, REFUSED)
            if beyond
            else expected_of(subject, Expected(("right", "refused"), right_from=1e-3)),
            # Up to where branches cross the reference needs a minute and more of ever shorter steps.
            proven=not beyond,
        )
        for subject in OTHERS
        if subject.name in BY_NATURE
        for name, why, beyond, moving in NEAR_THE_LINE
    ),
)
