"""Links, axes and inputs that contradict each other, and a link too many that does not.

Two constraints of one coordinate agree in the drawing and at no other value of the inputs, so the mechanism
is over-determined however near to each other they are. A link of another length than drawn is no constraint
too many: whether it can close is a matter of its length, and one that cannot must be refused as such.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
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
from validate.cars.car import as_tuple, unit
from validate.cars.registry import suspension_of
from validate.hard.cars import CARS, EVERY
from validate.hard.case import REFUSED, Answer, Case, Expected, Trial, coarse, decades
from validate.hard.cases.links import GROUP, axes, by_absolute, by_pointcoord, model_of, topology_of
from validate.hard.cases.near_points import Array, assembled, drawn_angle

if TYPE_CHECKING:
    from absolute import Model

THIRD = Link("lower_ball_joint", "second_pivot")
ROD = ("tie_rod_inner", "tie_rod_outer")
# Two links that are nearly one differ by the distance of their pivots, and the condition number grows as its
# inverse from some 30 on: at 1e-6 half of the digits are left.
HELD = Expected(("right", "refused"), right_from=1e-6)


def driven_twice(gap: float, car: str = "paper") -> Trial:
    """The arm driven by two inputs, whose values are `gap` rad apart.

    pointcoord has to refuse them before it knows any value.
    """
    second = ArmAngle("arm rise again", "arm_angle_again", "lower_arm_front", "lower_ball_joint", "up")
    row = Rise("lower_ball_joint", "lower_arm_front", "up", "arm rise again")
    single = topology_of(car)
    topology = replace(single, constraints=(*single.constraints, row), drives=(*single.drives, second))

    def again() -> Model:
        whole = model_of(car)
        return replace(whole, inputs={**whole.inputs, "arm_angle_again": whole.inputs["arm_angle"]})

    values = {"arm_angle_again": drawn_angle(car) + gap}
    mine = by_pointcoord(topology, set(row.labels), car=car)
    return Trial(gap, (mine, by_absolute(again, values, car)))


def second_pivot(share: float, car: str = "paper") -> dict[str, Array]:
    """The assembled car with one more point of the chassis, over the arm's front one."""
    points = topology_of(car).with_defaults(assembled(car))
    ball, front = points["lower_ball_joint"], points["lower_arm_front"]
    aside = share * float(np.linalg.norm(ball - front)) * np.array([0.0, 0.0, 1.0])
    return points | {"second_pivot": front + aside}


def three_links(driven: bool, car: str = "paper") -> Topology:
    """The arm on three links; driven, or held by the third instead."""
    whole = topology_of(car)
    kept = tuple(c for c in whole.constraints if driven or not isinstance(c, Rise))
    return replace(
        whole,
        chassis=(*whole.chassis, "second_pivot"),
        constraints=(*kept, THIRD),
        drives=tuple(d for d in whole.drives if driven or d.input != "arm_angle"),
    )


def two_axes(share: float, driven: bool, car: str = "paper") -> Callable[[], Model]:
    """The lower arm on two parallel axes, driven or not."""
    import absolute

    p = CARS[car].array
    front, axis = p["lower_arm_front"], as_tuple(p["lower_arm_rear"] - p["lower_arm_front"])
    arm = float(np.linalg.norm(p["lower_ball_joint"] - front))

    def describe() -> Model:
        whole = model_of(car)
        first, second = absolute.Axis("second_pivot", axis), absolute.Axis("lower_arm_front", axis)
        return replace(
            whole,
            points={**whole.points, "second_pivot": as_tuple(front + np.array([0.0, 0.0, share * arm]))},
            bodies={**whole.bodies, "chassis": (*whole.bodies["chassis"], "second_pivot")},
            joints={
                **whole.joints,
                "second": absolute.Joint("revolute", "chassis", "lower_arm", first, second),
            },
            inputs={n: i for n, i in whole.inputs.items() if driven or n != "arm_angle"},
        )

    return describe


def contradictory(share: float, car: str = "paper") -> Trial:
    """A driven arm on three links, or on two axes, that agree as drawn and at no other angle."""
    points = second_pivot(share, car)
    by_links = by_pointcoord(three_links(True, car), set(THIRD.labels), car=car, points=points)
    return Trial(share, (by_links, by_absolute(two_axes(share, True, car), car=car)))


def held(share: float, car: str = "paper") -> Trial:
    """The arm held by a third link where it is drawn: one assembly, or too near to none.

    Two axes that are not one hold the arm as well, by more rows than unknowns.
    """
    return Trial(share, (_held_by_links(share, car), by_absolute(two_axes(share, False, car), car=car)))


def _held_by_links(share: float, car: str) -> Answer:
    points = second_pivot(share, car)
    ball = points["lower_ball_joint"]
    try:
        mechanism = build_mechanism(three_links(False, car), points, axes(car))
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
def longest_rod(car: str = "paper") -> float:
    """The longest tie rod that closes at the drawing's inputs, mm.

    Its outer end goes round the kingpin on a circle, and is farthest from the inner one opposite to it.
    """
    p, (lower, upper) = assembled(car), suspension_of(CARS[car]).kingpin
    ball, kingpin = p[lower], unit(p[upper] - p[lower])
    (along_inner, beside_inner), (along_outer, beside_outer) = (
        (float((p[end] - ball) @ kingpin), float(np.linalg.norm(np.cross(p[end] - ball, kingpin))))
        for end in ROD
    )
    return float(np.hypot(along_inner - along_outer, beside_inner + beside_outer))


def with_rod(length: float, car: str = "paper") -> Mechanism:
    """The assembled car, its tie rod made another length, mm, after it was drawn."""
    topology = topology_of(car)
    mechanism = build_mechanism(topology, topology.with_defaults(assembled(car)), axes(car))
    place = mechanism.layout.squared_length(*ROD)
    drawn, lacks = mechanism.drawn.copy(), mechanism.drawn_lacks.copy()
    drawn[..., place], lacks[..., place] = (length / float(mechanism.unit)) ** 2, 0.0
    return replace(mechanism, drawn=drawn, drawn_lacks=lacks)


def at_drawing(mechanism: Mechanism, car: str = "paper") -> Pose:
    """The mechanism assembled at the inputs of the drawing."""
    return assemble(mechanism, {"arm_angle": np.array(drawn_angle(car)), "rack": np.array(0.0)})


def rod_of(length: float, car: str = "paper") -> Model:
    """The same for the absolute model: the tie rod's own outer end lies `length` mm from its inner one."""
    import absolute

    there = CARS[car]
    points = {name: place.tolist() for name, place in assembled(car).items()}
    # The assembled car closes as it is drawn.
    whole = absolute.SUSPENSIONS[there.suspension](points, up=there.up, right=there.right, side=there.side)
    inner, outer = (np.array(whole.points[end]) for end in ROD)
    ball = absolute.Joint(
        "spherical", "knuckle", "tie_rod", absolute.Axis("tie_rod_outer"), absolute.Axis("rod_end")
    )
    return replace(
        whole,
        points={**whole.points, "rod_end": as_tuple(inner + length * unit(outer - inner))},
        bodies={**whole.bodies, "tie_rod": ("rod_end", "tie_rod_inner")},
        joints={**whole.joints, "tie_rod_outer_ball": ball},
    )


def too_long(share: float, car: str = "paper") -> Trial:
    """The tie rod longer than it can be by this share of itself."""
    length = longest_rod(car) * (1.0 + share)
    theirs = by_absolute(lambda: rod_of(length, car), car=car)
    return Trial(share, (_too_long(length, car), theirs), {"length [mm]": length})


def _too_long(length: float, car: str) -> Answer:
    link = f"link {' - '.join(ROD)}"
    try:
        at_drawing(with_rod(length, car), car)
    except AssemblyError as error:
        told = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if link not in error.limits:
            return Answer("pointcoord", "wrong", f"{link} is not among what limits it: {told}")
        return Answer("pointcoord", "refused", told, condition=error.condition)
    except Exception as error:
        return Answer("pointcoord", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("pointcoord", "wrong", "assembles a tie rod that cannot close")


def _cases(suffix: str, car: str) -> tuple[Case, ...]:
    def case(
        name: str,
        why: str,
        parameter: str,
        behaviour: str,
        examine: Callable[..., Trial],
        values: tuple[float, ...] = (*decades(), 0.0),
        pointcoord: Expected = REFUSED,
    ) -> Case:
        return Case(
            name=f"{name}{suffix}",
            group=GROUP,
            why=why,
            parameter=parameter,
            values=coarse(values) if suffix else values,
            expected={"pointcoord": pointcoord, "absolute": REFUSED},
            behaviour=behaviour,
            examine=partial(examine, car=car),
        )

    return (
        case(
            "input-twice",
            "Two inputs drive one coordinate and contradict each other by less and less; at last they agree.",
            "difference of their values, rad",
            "refused, by pointcoord before there are values; it names the second row",
            driven_twice,
        ),
        case(
            "contradictory-links",
            "A third link of the arm, or a second axis, agrees with the others as drawn and nowhere else.",
            "distance of its pivot from the first one, in parts of the arm; then a copy of it",
            "refused as over-determined; pointcoord names the third link",
            contradictory,
        ),
        case(
            "link-too-long",
            "The tie rod is made longer than its ends can be apart, by less and less.",
            "what it is too long by, in parts of the longest that closes",
            "refused; pointcoord names the tie rod among what limits it",
            too_long,
            decades(),
        ),
        case(
            "arm-held-by-a-third-link",
            "A third link in place of the arm's input holds the arm, by less and less; at last it is a copy.",
            "distance of its pivot from the first one, in parts of the arm; then a copy of it",
            "pointcoord is right from 1e-6 up, nearer right or refused; the two axes are refused",
            held,
            pointcoord=HELD,
        ),
    )


CASES: tuple[Case, ...] = tuple(case for suffix, car in EVERY.items() for case in _cases(suffix, car))
