"""Links, axes and inputs that contradict each other, and a link too many that does not.

Two constraints of one coordinate agree in the drawing and at no other value of the inputs, so the mechanism
is over-determined however near to each other they are. A link of another length than drawn is no constraint
too many: whether it can close is a matter of its length, and one that cannot must be refused as such.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from pointcoord.errors import AssemblyError, PointcoordError
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.rise import Rise
from pointcoord.linkage.drives import ArmAngle
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.suspensions.macpherson import COLLINEAR
from validate.cars.paper_car import PAPER
from validate.hard.case import REFUSED, Answer, Case, Expected, Trial, decades
from validate.hard.cases.links import AXES, GROUP, by_absolute, by_pointcoord, strut
from validate.hard.cases.near_points import Array, assembled, drawn_angle

if TYPE_CHECKING:
    from absolute import Model

THIRD = Link("lower_ball_joint", "second_pivot")
ROD = ("tie_rod_inner", "tie_rod_outer")
# Two links that are nearly one differ by the distance of their pivots, and the condition number grows as its
# inverse from some 30 on: at 1e-6 half of the digits are left.
HELD = Expected(("right", "refused"), right_from=1e-6)


def driven_twice(gap: float) -> Trial:
    """The arm driven by two inputs, whose values are `gap` rad apart.

    pointcoord has to refuse them before it knows any value.
    """
    second = ArmAngle("arm rise again", "arm_angle_again", "lower_arm_front", "lower_ball_joint", "up")
    row = Rise("lower_ball_joint", "lower_arm_front", "up", "arm rise again")
    topology = replace(
        COLLINEAR,
        constraints=(*COLLINEAR.constraints, row),
        drives=(*COLLINEAR.drives, second),
    )

    def again() -> Model:
        whole = strut()
        return replace(whole, inputs={**whole.inputs, "arm_angle_again": whole.inputs["arm_angle"]})

    values = {"arm_angle_again": drawn_angle() + gap}
    return Trial(gap, (by_pointcoord(topology, set(row.labels)), by_absolute(again, values)))


def second_pivot(share: float) -> dict[str, Array]:
    """The assembled car with one more point of the chassis, over the arm's front one."""
    points = dict(assembled())
    ball, front = points["lower_ball_joint"], points["lower_arm_front"]
    aside = share * float(np.linalg.norm(ball - front)) * np.array([0.0, 0.0, 1.0])
    return points | {"second_pivot": front + aside}


def three_links(driven: bool) -> Topology:
    """The arm on three links; driven, or held by the third instead."""
    kept = tuple(c for c in COLLINEAR.constraints if driven or not isinstance(c, Rise))
    return replace(
        COLLINEAR,
        chassis=(*COLLINEAR.chassis, "second_pivot"),
        constraints=(*kept, THIRD),
        drives=tuple(d for d in COLLINEAR.drives if driven or d.input != "arm_angle"),
    )


def two_axes(share: float, driven: bool) -> Callable[[], Model]:
    """The arm on two parallel axes, driven or not."""
    import absolute

    front = PAPER["lower_arm_front"]
    arm = float(np.linalg.norm(np.subtract(PAPER["lower_ball_joint"], front)))

    def describe() -> Model:
        whole = strut()
        x, y, z = np.subtract(PAPER["lower_arm_rear"], PAPER["lower_arm_front"]).tolist()
        axis = (x, y, z)
        first, second = absolute.Axis("second_pivot", axis), absolute.Axis("lower_arm_front", axis)
        return replace(
            whole,
            points={**whole.points, "second_pivot": (front[0], front[1], front[2] + share * arm)},
            bodies={**whole.bodies, "chassis": (*whole.bodies["chassis"], "second_pivot")},
            joints={
                **whole.joints,
                "second": absolute.Joint("revolute", "chassis", "lower_arm", first, second),
            },
            inputs={n: i for n, i in whole.inputs.items() if driven or n != "arm_angle"},
        )

    return describe


def contradictory(share: float) -> Trial:
    """A driven arm on three links, or on two axes, that agree as drawn and at no other angle."""
    by_links = by_pointcoord(three_links(driven=True), set(THIRD.labels), points=second_pivot(share))
    return Trial(share, (by_links, by_absolute(two_axes(share, driven=True))))


def held(share: float) -> Trial:
    """The arm held by a third link where it is drawn: one assembly, or too near to none.

    Two axes that are not one hold the arm as well, by more rows than unknowns.
    """
    return Trial(share, (_held_by_links(share), by_absolute(two_axes(share, driven=False))))


def _held_by_links(share: float) -> Answer:
    points = second_pivot(share)
    ball = points["lower_ball_joint"]
    try:
        mechanism = build_mechanism(three_links(driven=False), points, AXES)
        pose = assemble(mechanism, {"rack": np.array(0.0)})
    except PointcoordError as error:
        return Answer("pointcoord", "refused", f"{type(error).__name__}: {' '.join(str(error).split())}")
    except Exception as error:
        return Answer("pointcoord", "wrong", f"fails: {type(error).__name__}: {error}")
    place = pose.y[list(mechanism.layout.vector("lower_ball_joint"))] * mechanism.unit + mechanism.origin
    off, bound = float(np.abs(place - ball).max()), float(pose.bound)
    return Answer(
        "pointcoord",
        "right" if off <= bound < np.inf else "noted" if bound == np.inf else "wrong",
        "the ball joint, which three links hold where it is drawn",
        error=off,
        bound=bound if np.isfinite(bound) else None,
        share=off / bound,
        condition=float(pose.condition),
    )


@cache
def longest_rod() -> float:
    """The longest tie rod that closes at the drawing's inputs, mm.

    Its outer end goes round the kingpin on a circle, and is farthest from the inner one opposite to it.
    """
    p = assembled()
    ball = p["lower_ball_joint"]
    kingpin = (p["strut_top"] - ball) / np.linalg.norm(p["strut_top"] - ball)
    (along_inner, beside_inner), (along_outer, beside_outer) = (
        (float((p[end] - ball) @ kingpin), float(np.linalg.norm(np.cross(p[end] - ball, kingpin))))
        for end in ROD
    )
    return float(np.hypot(along_inner - along_outer, beside_inner + beside_outer))


def with_rod(length: float) -> Mechanism:
    """The assembled car, its tie rod made another length, mm, after it was drawn."""
    mechanism = build_mechanism(COLLINEAR, assembled(), AXES)
    place = mechanism.layout.squared_length(*ROD)
    drawn, lacks = mechanism.drawn.copy(), mechanism.drawn_lacks.copy()
    drawn[..., place], lacks[..., place] = (length / float(mechanism.unit)) ** 2, 0.0
    return replace(mechanism, drawn=drawn, drawn_lacks=lacks)


def at_drawing(mechanism: Mechanism) -> Pose:
    """The mechanism assembled at the inputs of the drawing."""
    return assemble(mechanism, {"arm_angle": np.array(drawn_angle()), "rack": np.array(0.0)})


def rod_of(length: float) -> Model:
    """The same for the absolute model: the tie rod's own outer end lies `length` mm from its inner one."""
    import absolute

    whole = absolute.macpherson({name: place.tolist() for name, place in assembled().items()})
    inner, outer = (np.array(whole.points[end]) for end in ROD)
    x, y, z = (inner + length * (outer - inner) / np.linalg.norm(outer - inner)).tolist()
    ball = absolute.Joint(
        "spherical", "knuckle", "tie_rod", absolute.Axis("tie_rod_outer"), absolute.Axis("rod_end")
    )
    return replace(
        whole,
        points={**whole.points, "rod_end": (x, y, z)},
        bodies={**whole.bodies, "tie_rod": ("rod_end", "tie_rod_inner")},
        joints={**whole.joints, "tie_rod_outer_ball": ball},
    )


def too_long(share: float) -> Trial:
    """The tie rod longer than it can be by this share of itself."""
    length = longest_rod() * (1.0 + share)
    return Trial(share, (_too_long(length), by_absolute(lambda: rod_of(length))), {"length [mm]": length})


def _too_long(length: float) -> Answer:
    link = f"link {' - '.join(ROD)}"
    try:
        at_drawing(with_rod(length))
    except AssemblyError as error:
        told = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if link not in error.limits:
            return Answer("pointcoord", "wrong", f"{link} is not among what limits it: {told}")
        return Answer("pointcoord", "refused", told, condition=error.condition)
    except Exception as error:
        return Answer("pointcoord", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("pointcoord", "wrong", "assembles a tie rod that cannot close")


def _case(
    name: str,
    why: str,
    parameter: str,
    behaviour: str,
    examine: Callable[[float], Trial],
    values: tuple[float, ...] = (*decades(), 0.0),
    pointcoord: Expected = REFUSED,
) -> Case:
    expected = {"pointcoord": pointcoord, "absolute": REFUSED}
    return Case(name, GROUP, why, parameter, values, expected, behaviour, examine)


CASES: tuple[Case, ...] = (
    _case(
        "input-twice",
        "Two inputs drive one coordinate and contradict each other by less and less; at last they agree.",
        "difference of their values, rad",
        "refused, by pointcoord before there are values; it names the second row",
        driven_twice,
    ),
    _case(
        "contradictory-links",
        "A third link of the arm, or a second axis, agrees with the others as drawn and nowhere else.",
        "distance of its pivot from the first one, in parts of the arm; then a copy of it",
        "refused as over-determined; pointcoord names the third link",
        contradictory,
    ),
    _case(
        "link-too-long",
        "The tie rod is made longer than its ends can be apart, by less and less.",
        "what it is too long by, in parts of the longest that closes",
        "refused; pointcoord names the tie rod among what limits it",
        too_long,
        decades(),
    ),
    _case(
        "arm-held-by-a-third-link",
        "A third link in place of the arm's input holds the arm, by less and less; at last it is a copy.",
        "distance of its pivot from the first one, in parts of the arm; then a copy of it",
        "pointcoord is right from 1e-6 up, nearer right or refused; the two axes are refused",
        held,
        pointcoord=HELD,
    ),
)
