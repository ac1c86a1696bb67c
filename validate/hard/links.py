"""Links that are missing or given twice, as descriptions of a mechanism.

A scene file cannot say these things, so both models are asked by their own descriptions: pointcoord by a
topology, the absolute model by bodies and joints. A mechanism without one assembly per input must be refused
before anything is solved, and by name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from pointcoord import MechanismError
from pointcoord.constraints import Constraint, Link
from pointcoord.hardpoints import build_mechanism
from pointcoord.suspensions.macpherson import COLLINEAR
from pointcoord.topology import Topology
from validate.hard.case import REFUSED, Answer, Case, Trial
from validate.hard.near_points import drawn_angle
from validate.paper_car import PAPER

if TYPE_CHECKING:
    from absolute import Model

GROUP = "10. Links and numbers that make no mechanism"
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
LINKS = tuple(c for c in COLLINEAR.constraints if isinstance(c, Link))
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
    return replace(COLLINEAR, constraints=change(COLLINEAR.constraints))


def twice(link: Link) -> Link:
    """The same link drawn from its other end."""
    return Link(link.end, link.start)


def by_pointcoord(
    topology: Topology,
    needed: Set[str],
    any_of: Set[str] = frozenset(),
    points: Mapping[str, ArrayLike] = PAPER,
) -> Answer:
    """What pointcoord makes of a topology.

    Args:
        needed: names that its error has to give, all of them.
        any_of: names of which it has to give one at least; none if there are none.
    """
    try:
        build_mechanism(topology, points, AXES)
    except MechanismError as error:
        missing = sorted(needed - set(error.names))
        if missing or not error.names:
            return Answer("pointcoord", "wrong", f"does not name {', '.join(missing) or 'anything'}: {error}")
        if any_of and not any_of & set(error.names):
            return Answer("pointcoord", "wrong", f"names none of {', '.join(sorted(any_of))}: {error}")
        return Answer("pointcoord", "refused", f"{type(error).__name__}: {error}")
    except Exception as error:
        return Answer("pointcoord", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("pointcoord", "wrong", "takes it for a mechanism")


def by_absolute(describe: Callable[[], Model], inputs: Mapping[str, float] | None = None) -> Answer:
    """What the absolute model makes of a description, at its own drawing.

    Args:
        inputs: values of inputs that do not stand as drawn, rad or mm.
    """
    import absolute

    try:
        model = describe()
        values = {"arm_angle": drawn_angle()} | dict(inputs or {})
        still = {name: np.array([[values.get(name, 0.0), 0.0, 0.0]]) for name in model.inputs}
        absolute.solve(model, still)
    except absolute.AbsoluteError as error:
        return Answer("absolute", "refused", f"{type(error).__name__}: {' '.join(str(error).split())}")
    except Exception as error:
        return Answer("absolute", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("absolute", "wrong", "takes it for a mechanism")


def strut() -> Model:
    """The paper's car as the absolute model describes it."""
    import absolute

    return absolute.macpherson(PAPER)


def missing(number: float) -> Trial:
    """The mechanism without one of its links, or without one of its joints."""
    link, joint = LINKS[int(number) - 1], JOINTS[int(number) - 1]

    def without() -> Model:
        whole = strut()
        return replace(whole, joints={n: j for n, j in whole.joints.items() if n != joint})

    topology = with_constraints(lambda all_: tuple(c for c in all_ if c != link))
    # All else held, what can move violates the link that is gone, so that one of its ends moves.
    free = {f"{axis} of {end}" for axis in "xyz" for end in (link.start, link.end) if end in COLLINEAR.moving}
    return Trial(
        number,
        (by_pointcoord(topology, set(), free), by_absolute(without)),
        {"link": link.labels[0], "joint": joint},
    )


def redundant(number: float) -> Trial:
    """One of the links twice, or one of the joints."""
    link, joint = LINKS[int(number) - 1], JOINTS[int(number) - 1]

    def again() -> Model:
        whole = strut()
        return replace(whole, joints={**whole.joints, "again": whole.joints[joint]})

    topology = with_constraints(lambda all_: (*all_, twice(link)))
    rows = {link.labels[0], twice(link).labels[0]}
    return Trial(
        number, (by_pointcoord(topology, rows), by_absolute(again)), {"link": link.labels[0], "joint": joint}
    )


def exchanged(number: float) -> Trial:
    """One link twice in place of another, so that there are as many rows as unknowns; joints alike."""
    link, lost = LINKS[int(number) - 1], LINKS[int(number) % len(LINKS)]
    doubled, dropped = EXCHANGED[int(number) - 1]

    def swapped() -> Model:
        whole = strut()
        joints = {n: j for n, j in whole.joints.items() if n != dropped}
        return replace(whole, joints={**joints, "again": whole.joints[doubled]})

    topology = with_constraints(lambda all_: (*(c for c in all_ if c != lost), twice(link)))
    rows = {link.labels[0], twice(link).labels[0]}
    facts: dict[str, float | str] = {
        "twice": f"{link.labels[0]}; {doubled}",
        "missing": f"{lost.labels[0]}; {dropped}",
    }
    return Trial(number, (by_pointcoord(topology, rows), by_absolute(swapped)), facts)


def _case(name: str, why: str, behaviour: str, examine: Callable[[float], Trial]) -> Case:
    return Case(
        name=name,
        group=GROUP,
        why=why,
        parameter="number of the link (and of a joint of the absolute model)",
        values=NUMBERS,
        expected={"pointcoord": REFUSED, "absolute": REFUSED},
        behaviour=behaviour,
        examine=examine,
    )


CASES: tuple[Case, ...] = (
    _case(
        "link-missing",
        "A point is free to move although all inputs are held.",
        "refused; pointcoord names what is free, a coordinate of the link's own ends among it",
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
)
