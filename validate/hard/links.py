"""Links that are missing, given twice, or contradict each other, as descriptions of a mechanism.

A scene file cannot say these things, so both models are asked by their own descriptions: pointcoord by a
topology, the absolute model by bodies and joints. A mechanism without one assembly per input must be refused
before anything is solved, and by name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pointcoord import MechanismError
from pointcoord.assembly import assemble
from pointcoord.constraints import Constraint, Link, Rise
from pointcoord.drives import ArmAngle
from pointcoord.errors import PointcoordError
from pointcoord.hardpoints import build_mechanism
from pointcoord.suspensions.macpherson import MACPHERSON
from pointcoord.topology import Topology
from validate.hard.case import REFUSED, RIGHT_OR_REFUSED, Answer, Case, Trial
from validate.hard.content import decades
from validate.hard.near_points import assembled, drawn_angle
from validate.paper_car import PAPER

if TYPE_CHECKING:
    from absolute import Model

GROUP = "10. Links and numbers that make no mechanism"
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
LINKS = tuple(c for c in MACPHERSON.constraints if isinstance(c, Link))
JOINTS = (
    "arm_pivot",
    "strut",
    "rack_slide",
    "lower_ball",
    "top_mount",
    "tie_rod_outer_ball",
    "tie_rod_inner_cross",
)
# Pairs with as many rows as each other, so that counting them finds nothing: the first twice, the second not.
EXCHANGED = (
    ("arm_pivot", "rack_slide"),
    ("rack_slide", "arm_pivot"),
    ("arm_pivot", "strut"),
    ("strut", "rack_slide"),
    ("lower_ball", "top_mount"),
    ("top_mount", "tie_rod_outer_ball"),
    ("tie_rod_outer_ball", "lower_ball"),
)
NUMBERS = tuple(float(n) for n in range(1, len(LINKS) + 1))


def with_constraints(change: Callable[[tuple[Constraint, ...]], tuple[Constraint, ...]]) -> Topology:
    """The strut with other constraints."""
    return replace(MACPHERSON, constraints=change(MACPHERSON.constraints))


def twice(link: Link) -> Link:
    """The same link drawn from its other end."""
    return Link(link.end, link.start)


def _pointcoord(topology: Topology, needed: set[str]) -> Answer:
    """What pointcoord makes of the topology; an error has to name all that is needed."""
    try:
        build_mechanism(topology, PAPER, AXES)
    except MechanismError as error:
        missing = sorted(needed - set(error.names))
        if missing or not error.names:
            return Answer("pointcoord", "wrong", f"does not name {', '.join(missing) or 'anything'}: {error}")
        return Answer("pointcoord", "refused", f"{type(error).__name__}: {error}")
    except Exception as error:
        return Answer("pointcoord", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("pointcoord", "wrong", "takes it for a mechanism")


def _absolute(describe: Callable[[], Model]) -> Answer:
    """What the absolute model makes of a description, at its own drawing."""
    import absolute

    try:
        model = describe()
        still = {name: np.zeros((1, 3)) for name in model.inputs}
        for name in still:
            if name.startswith("arm_angle"):
                still[name][0, 0] = drawn_angle()
        absolute.solve(model, still)
    except absolute.AbsoluteError as error:
        return Answer("absolute", "refused", f"{type(error).__name__}: {' '.join(str(error).split())}")
    except Exception as error:
        return Answer("absolute", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("absolute", "wrong", "takes it for a mechanism")


def _strut() -> Model:
    import absolute

    return absolute.macpherson(PAPER)


def missing(number: float) -> Trial:
    """The mechanism without one of its links, or without one of its joints."""
    link, joint = LINKS[int(number) - 1], JOINTS[int(number) - 1]

    def without() -> Model:
        strut = _strut()
        return replace(strut, joints={n: j for n, j in strut.joints.items() if n != joint})

    topology = with_constraints(lambda all_: tuple(c for c in all_ if c != link))
    return Trial(
        number,
        (_pointcoord(topology, set()), _absolute(without)),
        {"link": link.labels[0], "joint": joint},
    )


def redundant(number: float) -> Trial:
    """One of the links twice, or one of the joints."""
    link, joint = LINKS[int(number) - 1], JOINTS[int(number) - 1]

    def again() -> Model:
        strut = _strut()
        return replace(strut, joints={**strut.joints, "again": strut.joints[joint]})

    topology = with_constraints(lambda all_: (*all_, twice(link)))
    rows = {link.labels[0], twice(link).labels[0]}
    return Trial(
        number, (_pointcoord(topology, rows), _absolute(again)), {"link": link.labels[0], "joint": joint}
    )


def exchanged(number: float) -> Trial:
    """One link twice in place of another, so that there are as many rows as unknowns; joints alike."""
    link, lost = LINKS[int(number) - 1], LINKS[int(number) % len(LINKS)]
    doubled, dropped = EXCHANGED[int(number) - 1]

    def swapped() -> Model:
        strut = _strut()
        joints = {n: j for n, j in strut.joints.items() if n != dropped}
        return replace(strut, joints={**joints, "again": strut.joints[doubled]})

    topology = with_constraints(lambda all_: (*(c for c in all_ if c != lost), twice(link)))
    rows = {link.labels[0], twice(link).labels[0]}
    facts: dict[str, float | str] = {
        "twice": f"{link.labels[0]}; {doubled}",
        "missing": f"{lost.labels[0]}; {dropped}",
    }
    return Trial(number, (_pointcoord(topology, rows), _absolute(swapped)), facts)


def driven_twice(number: float) -> Trial:
    """The arm driven by two inputs, which will sooner or later contradict each other."""
    second = ArmAngle("arm rise again", "arm_angle_again", "lower_arm_front", "lower_ball_joint", "up")
    row = Rise("lower_ball_joint", "lower_arm_front", "up", "arm rise again")
    topology = replace(
        MACPHERSON,
        constraints=(*MACPHERSON.constraints, row),
        drives=(*MACPHERSON.drives, second),
    )

    def again() -> Model:
        strut = _strut()
        return replace(strut, inputs={**strut.inputs, "arm_angle_again": strut.inputs["arm_angle"]})

    return Trial(number, (_pointcoord(topology, set(row.labels)), _absolute(again)))


def contradictory(share: float) -> Trial:
    """The arm on two axes that are `share` of the arm apart; in pointcoord a third link near the first.

    Two axes cannot both be kept, so the absolute model must refuse. Three links to three different points of
    the chassis hold the ball joint where it is drawn: that is one assembly, or too near to none.
    """
    import absolute

    front = np.array(PAPER["lower_arm_front"])
    arm = float(np.linalg.norm(np.array(PAPER["lower_ball_joint"]) - front))

    def two_axes() -> Model:
        strut = _strut()
        aside = tuple((front + share * arm * np.array([0.0, 0.0, 1.0])).tolist())
        x, y, z = np.subtract(PAPER["lower_arm_rear"], PAPER["lower_arm_front"]).tolist()
        axis = (x, y, z)
        first, second = absolute.Axis("second_pivot", axis), absolute.Axis("lower_arm_front", axis)
        joints = {n: j for n, j in strut.joints.items() if n != "rack_slide"}
        return replace(
            strut,
            points={**strut.points, "second_pivot": aside},
            bodies={**strut.bodies, "chassis": (*strut.bodies["chassis"], "second_pivot")},
            joints={**joints, "second": absolute.Joint("revolute", "chassis", "lower_arm", first, second)},
        )

    return Trial(share, (_three_links(share), _absolute(two_axes)))


def _three_links(share: float) -> Answer:
    points = dict(assembled())
    ball, front = points["lower_ball_joint"], points["lower_arm_front"]
    aside = share * float(np.linalg.norm(ball - front)) * np.array([0.0, 0.0, 1.0])
    points["second_pivot"] = front + aside
    topology = replace(
        MACPHERSON,
        chassis=(*MACPHERSON.chassis, "second_pivot"),
        constraints=(
            *(c for c in MACPHERSON.constraints if not isinstance(c, Rise)),
            Link("lower_ball_joint", "second_pivot"),
        ),
        drives=tuple(d for d in MACPHERSON.drives if d.input != "arm_angle"),
    )
    try:
        mechanism = build_mechanism(topology, points, AXES)
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


def _case(name: str, why: str, behaviour: str, examine: Callable[[float], Trial]) -> Case:
    return Case(
        name=name,
        group=GROUP,
        why=why,
        parameter="number of the link (and of a joint of the absolute model)",
        values=NUMBERS if name != "input-twice" else (1.0,),
        expected={"pointcoord": REFUSED, "absolute": REFUSED},
        behaviour=behaviour,
        examine=examine,
    )


CASES: tuple[Case, ...] = (
    _case(
        "link-missing",
        "A point is free to move although all inputs are held.",
        "refused; pointcoord names the free coordinates",
        missing,
    ),
    _case(
        "link-twice",
        "There are more rows than unknowns, and two of them say the same.",
        "refused; pointcoord names both rows",
        redundant,
    ),
    _case(
        "link-twice-for-another",
        "There are as many rows as unknowns, but one says nothing new and one is missing.",
        "refused; pointcoord names both rows",
        exchanged,
    ),
    _case(
        "input-twice",
        "Two inputs drive one coordinate and contradict each other as soon as they differ.",
        "refused; pointcoord names the second row",
        driven_twice,
    ),
    Case(
        name="contradictory-links",
        group=GROUP,
        why="Links contradict each other by less and less, until rounding alone tells them from a copy.",
        parameter="distance of the contradiction, in parts of the arm",
        values=(*decades(), 0.0),
        expected={"pointcoord": RIGHT_OR_REFUSED, "absolute": REFUSED},
        behaviour="the absolute model's two axes are refused; pointcoord's third link is right or refused",
        examine=contradictory,
    ),
)
