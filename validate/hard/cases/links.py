"""Links that are missing or given twice, as descriptions of a mechanism.

A scene file cannot say these things, so both models are asked by their own descriptions: pointcoord by a
topology, the absolute model by bodies and joints. A mechanism without one assembly per input must be refused
before anything is solved, and by name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from pointcoord import MechanismError
from pointcoord.linkage.constraints.axis_in_body import AxisInBody
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.normal import Normal
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.suspensions.macpherson import COLLINEAR, DRAWN
from validate.cars.car import Closure, Points
from validate.cars.macpherson import BESIDE
from validate.cars.paper_car import PAPER
from validate.hard.case import REFUSED, Answer, Case, Trial
from validate.hard.cases.near_points import drawn_angle

if TYPE_CHECKING:
    from absolute import Model

GROUP = "Links and numbers that make no mechanism"
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
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
DRAWINGS: dict[Closure, Points] = {"collinear": PAPER, "drawn": BESIDE}


def links_of(closure: Closure) -> tuple[Link, ...]:
    """The links of one kind of strut."""
    topology = COLLINEAR if closure == "collinear" else DRAWN
    return tuple(c for c in topology.constraints if isinstance(c, Link))


def counted(number: int) -> tuple[float, ...]:
    """The numbers of so many constraints."""
    return tuple(float(n) for n in range(1, number + 1))


LINKS = links_of("collinear")
NUMBERS = counted(len(LINKS))
# Without its normal or its axis's direction a knuckle has no such vector that could be free.
HELD = tuple(c for c in DRAWN.constraints if not isinstance(c, AxisInBody | Normal))


def with_constraints(
    change: Callable[[tuple[Constraint, ...]], tuple[Constraint, ...]], closure: Closure = "collinear"
) -> Topology:
    """The strut with other constraints."""
    whole = COLLINEAR if closure == "collinear" else DRAWN.given(BESIDE)
    return replace(whole, constraints=change(whole.constraints))


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


def strut(closure: Closure = "collinear") -> Model:
    """A car of one kind of strut as the absolute model describes it."""
    import absolute

    return absolute.macpherson(DRAWINGS[closure], closure=closure)


def missing(number: float, closure: Closure = "collinear") -> Trial:
    """The mechanism without one of its constraints, or without one of its joints.

    Of a collinear strut the links are tried; of a drawn one what fixes its axis as well.
    """
    every = LINKS if closure == "collinear" else HELD
    gone, joint = every[int(number) - 1], JOINTS[(int(number) - 1) % len(JOINTS)]

    def without() -> Model:
        whole = strut(closure)
        return replace(whole, joints={n: j for n, j in whole.joints.items() if n != joint})

    topology = with_constraints(lambda all_: tuple(c for c in all_ if c != gone), closure)
    # All else held, what can move violates the link that is gone, so that one of its ends moves.
    ends = (gone.start, gone.end) if isinstance(gone, Link) else ()
    free = {f"{axis} of {end}" for axis in "xyz" for end in ends if end in COLLINEAR.moving}
    return Trial(
        number,
        (by_pointcoord(topology, set(), free, points=DRAWINGS[closure]), by_absolute(without)),
        {"constraint": gone.labels[0], "joint": joint},
    )


def redundant(number: float, closure: Closure = "collinear") -> Trial:
    """One of the links twice, or one of the joints."""
    link, joint = links_of(closure)[int(number) - 1], JOINTS[int(number) - 1]

    def again() -> Model:
        whole = strut(closure)
        return replace(whole, joints={**whole.joints, "again": whole.joints[joint]})

    topology = with_constraints(lambda all_: (*all_, twice(link)), closure)
    rows = {link.labels[0], twice(link).labels[0]}
    return Trial(
        number,
        (by_pointcoord(topology, rows, points=DRAWINGS[closure]), by_absolute(again)),
        {"link": link.labels[0], "joint": joint},
    )


def exchanged(number: float, closure: Closure = "collinear") -> Trial:
    """One link twice in place of another, so that there are as many rows as unknowns; joints alike."""
    links = links_of(closure)
    link, lost = links[int(number) - 1], links[int(number) % len(links)]
    doubled, dropped = EXCHANGED[int(number) - 1]

    def swapped() -> Model:
        whole = strut(closure)
        joints = {n: j for n, j in whole.joints.items() if n != dropped}
        return replace(whole, joints={**joints, "again": whole.joints[doubled]})

    topology = with_constraints(lambda all_: (*(c for c in all_ if c != lost), twice(link)), closure)
    rows = {link.labels[0], twice(link).labels[0]}
    facts: dict[str, float | str] = {
        "twice": f"{link.labels[0]}; {doubled}",
        "missing": f"{lost.labels[0]}; {dropped}",
    }
    return Trial(
        number, (by_pointcoord(topology, rows, points=DRAWINGS[closure]), by_absolute(swapped)), facts
    )


def _case(
    name: str,
    why: str,
    behaviour: str,
    examine: Callable[[float], Trial],
    values: tuple[float, ...] = NUMBERS,
) -> Case:
    return Case(
        name=name,
        group=GROUP,
        why=why,
        parameter="number of the link (and of a joint of the absolute model)",
        values=values,
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
    _case(
        "constraint-missing-beside",
        "As before, of a strut beside its ball joint: a link, its axis or a place on the axis is not held.",
        "refused; pointcoord names what is free, of a link a coordinate of its own ends",
        partial(missing, closure="drawn"),
        counted(len(HELD)),
    ),
    _case(
        "link-twice-beside",
        "As before, of a strut beside its ball joint.",
        "refused; pointcoord names both rows",
        partial(redundant, closure="drawn"),
        counted(len(links_of("drawn"))),
    ),
    _case(
        "link-twice-for-another-beside",
        "As before, of a strut beside its ball joint.",
        "refused; pointcoord names both rows",
        partial(exchanged, closure="drawn"),
        counted(len(links_of("drawn"))),
    ),
)
