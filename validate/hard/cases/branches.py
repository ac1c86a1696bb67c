"""Two assembly modes close together, drawings near their mirror image, large steps: the drawn branch is kept.

The right assembly mode of a pose is the one that can be reached from the drawing without passing a singular
pose. The reference is this mode, so a solution that has jumped to another one is wrong even if its links
close. `pointcoord hard --assemblies` counts the modes.

Some mechanisms are hard by nature. When cranks and couplers of a coupled four-bar lie in one line, its
parallelogram branches meet branches with crossed cranks: beyond this pose both kinds exist, and neither can
be reached from the drawing without passing the singular pose. Bricard's ring of six hinges has as many
equations as coordinates and still moves: a model that cannot solve such a mechanism must refuse it with the
reason. Where the reference finds no proof, nothing is judged here; the tests of mechanisms compare it with
its closed form.
"""

from __future__ import annotations

import math
from functools import partial

from validate.hard.case import REFUSED, Case, decades, family, right_from
from validate.hard.cases.drawings import flattened
from validate.hard.reach import ends_of, last_value
from validate.hard.subjects import NAMED, OTHERS, PAPER, WISHBONE, Content, Subject, hyphens, scene_content

CLEAR = right_from(1e-6)
CASES: list[Case] = []
_branch = partial(family, CASES, "Branches")
_by_nature = partial(family, CASES, "Mechanisms that are hard by nature")

# Arm angle, rad, and rack travel, mm, at which the two assembly modes of the tie rod just meet: with less
# rack travel the arm cannot pass this angle, with more it can. Third, half the range of the motion, rad; a
# dead point is 0.05 rad below the meeting.
ANGLE, RACK, WIDE = 0.6129246396239625, -0.00292320063271574, 0.05
APPROACH = "Two assembly modes of the tie rod come near each other as the arm passes 35 degrees"


def through_the_meeting(side: float, subject: Subject, share: float) -> Content:
    """The arm moves through the angle of the meeting; the rack is `share` of 10 mm on one side of it."""
    arm, rack = (ANGLE + WIDE, -2.0 * WIDE), RACK + side * 10.0 * share
    return scene_content(subject.car, arm, rack, stop=1.0, samples=5)


_branch(
    *("rack travel beyond the meeting, in parts of 10 mm", (1.0, 1e-6, 1e-12), CLEAR, [PAPER]),
    name="branches-nearly-meet",
    why=f"{APPROACH}: a step may end in the wrong mode.",
)(partial(through_the_meeting, 1.0))
_branch(
    *("rack travel short of the meeting, in parts of 10 mm", (1e-1, 1e-7, 1e-12), REFUSED, [PAPER]),
    name="branches-met",
    why=f"{APPROACH} and meet: a large step may jump over the gap without a pose.",
)(partial(through_the_meeting, -1.0))


def whole_range(driven: str, subject: Subject, share: float) -> Content:
    """An input moves from near its upper end to near its lower one, between two instants."""
    low, high = (last_value(subject, driven, ahead).beyond(-0.5 * share) for ahead in (False, True))
    return subject.absolute({**subject.home, driven: (high, low - high)}, stop=1.0, samples=2)


for subject in (PAPER, WISHBONE, *OTHERS):
    for driven in subject.driven:
        if {(driven, False), (driven, True)} <= set(ends_of(subject)):
            _branch(
                "distance of both instants from their ends, in parts of half the range",
                (1e-8,) if subject is WISHBONE else (1e-4,),
                subjects=[subject],
                name=f"whole-range-{hyphens(driven).removesuffix('-angle')}",
                why="The whole range of an input lies between two instants: "
                "one large step could reach a wrong branch.",
            )(partial(whole_range, driven))


def flat_drawing(side: float, subject: Subject, share: float) -> Content:
    """The rack moves away from a drawing in which it is nearly locked.

    The tie rod's outer end is near the plane of kingpin and rack, on either side. For a wishbone the arm
    moves: its upper ball joint is drawn near the plane of its pivots and the lower ball joint.
    """
    point, plane = "upper_ball_joint", ("upper_arm_front", "upper_arm_rear", "lower_ball_joint")
    if subject is PAPER:
        point, plane = "tie_rod_outer", ("lower_ball_joint", "strut_lower", "tie_rod_inner")
    car = subject.car.drawn_as(flattened(subject.assembled.array, side * share, point=point, onto=plane))
    angle = subject.drawn["arm_angle"]
    if subject is PAPER:
        return scene_content(car, angle, (0.0, 0.0, 20.0), stop=1.0, samples=3)
    return scene_content(car, (angle, 0.0, -0.02), stop=1.0, samples=3, effects=None)


for label, side in (("", 1.0), ("-mirrored", -1.0)):
    _branch(
        *("height over the plane, in parts of the car's", decades(), CLEAR, (PAPER, WISHBONE)),
        name=f"flat-drawing{label}",
        why="The tie rod's outer end, or a wishbone's upper ball joint, is drawn close to its mirror image: "
        "rounding may choose the wrong side.",
    )(partial(flat_drawing, side))


def to_the_line(turn: float, beyond: bool, moving: bool, subject: Subject, value: float) -> Content:
    """A pose short of a turn of the input or beyond it, by a share of it: at rest, or reached in 1 s."""
    (driven,) = subject.driven
    goal = turn * (1.0 + value if beyond else 1.0 - value)
    if moving:
        return subject.absolute({driven: [0.0, goal]}, stop=1.0, samples=3)
    return subject.absolute({driven: goal})


# The turn from the drawing, rad, at which branches cross or beyond which there is no pose.
for mechanism, turn, what in (
    ("bricard", -math.pi / 6.0, "its ring reaches its end."),
    ("n_four_bar", -0.5 * math.pi, "its branches cross."),
):
    for name, why, beyond, moving in (
        ("held-near-the-line", "The mechanism rests near the pose where", False, False),
        ("swept-near-the-line", "The mechanism moves from the drawing to near the pose where", False, True),
        ("held-beyond-the-line", "The mechanism is to rest beyond the pose where", True, False),
        ("swept-through-the-line", "The mechanism is to move through the pose where", True, True),
    ):
        _by_nature(
            f"distance from it, in parts of the way from the drawing{', beyond' * beyond}",
            (1e-2,) if beyond else (1e-1, 1e-4),
            REFUSED if beyond else right_from(1e-3),
            [NAMED[mechanism]],
            name=name,
            why=f"{why} {what}",
        )(partial(to_the_line, turn, beyond, moving))
