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
from pointcoord.suspensions import SUSPENSIONS
from validate.hard.cars import CARS
from validate.hard.case import REFUSED, Answer, Case, Trial
from validate.hard.cases.near_points import drawn_angle

if TYPE_CHECKING:
    from absolute import Model

GROUP = "Links and numbers that make no mechanism"
SIMPLE = {"": "paper", "-beside": "beside", "-wishbone": "wishbone"}


def topology_of(car: str) -> Topology:
    """The topology that pointcoord has for a car of `CARS`."""
    there = CARS[car]
    return SUSPENSIONS[there.suspension].closures[there.closure].given(there.points)


def hardpoints(car: str) -> Mapping[str, ArrayLike]:
    """A car's hardpoints with those that may be left to others."""
    return topology_of(car).with_defaults(dict(CARS[car].points))


def axes(car: str) -> Mapping[str, ArrayLike]:
    """A car's directions."""
    return {"up": CARS[car].up, "right": CARS[car].right}


def links_of(car: str) -> tuple[Link, ...]:
    """The links of a car's topology."""
    return tuple(c for c in topology_of(car).constraints if isinstance(c, Link))


def held_in(car: str) -> tuple[Constraint, ...]:
    """What can be left out of a car's topology: all that holds a point or an axis.

    Of a collinear strut and a double wishbone the links are tried; of a strut as drawn what fixes its axis
    as well, but not the normal or the axis itself: without them a knuckle has no such vector to be free.
    """
    if not any(isinstance(c, AxisInBody) for c in topology_of(car).constraints):
        return links_of(car)
    return tuple(c for c in topology_of(car).constraints if not isinstance(c, AxisInBody | Normal))


def counted(number: int) -> tuple[float, ...]:
    """The numbers of so many constraints."""
    return tuple(float(n) for n in range(1, number + 1))


def with_constraints(
    change: Callable[[tuple[Constraint, ...]], tuple[Constraint, ...]], car: str = "paper"
) -> Topology:
    """A car's topology with other constraints."""
    whole = topology_of(car)
    return replace(whole, constraints=change(whole.constraints))


def twice(link: Link) -> Link:
    """The same link drawn from its other end."""
    return Link(link.end, link.start)


def by_pointcoord(
    topology: Topology,
    needed: Set[str],
    any_of: Set[str] = frozenset(),
    car: str = "paper",
    points: Mapping[str, ArrayLike] | None = None,
) -> Answer:
    """What pointcoord makes of a topology.

    Args:
        needed: names that its error has to give, all of them.
        any_of: names of which it has to give one at least; none if there are none.
        car: name of the car; points: its hardpoints, mm, where they are others.
    """
    try:
        build_mechanism(topology, hardpoints(car) if points is None else points, axes(car))
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


def model_of(car: str) -> Model:
    """A car as the absolute model describes it."""
    import absolute

    there = CARS[car]
    return absolute.SUSPENSIONS[there.suspension](
        there.points, up=there.up, right=there.right, side=there.side, closure=there.closure
    )


def exchangeable(model: Model) -> tuple[tuple[str, str], ...]:
    """Pairs of joints with as many rows as each other, so that counting rows finds nothing."""
    from absolute.description import JOINT_ROWS

    rows = {name: JOINT_ROWS[joint.kind] for name, joint in model.joints.items()}
    pairs = []
    for name in rows:
        alike = [other for other in rows if rows[other] == rows[name]]
        if len(alike) > 1:
            pairs.append((name, alike[(alike.index(name) + 1) % len(alike)]))
    return tuple(pairs)


def by_absolute(
    describe: Callable[[], Model], inputs: Mapping[str, float] | None = None, car: str = "paper"
) -> Answer:
    """What the absolute model makes of a description, at its own drawing.

    Args:
        inputs: values of inputs that do not stand as drawn, rad or mm.
        car: whose drawing it is.
    """
    import absolute

    try:
        model = describe()
        values = {"arm_angle": drawn_angle(car)} | dict(inputs or {})
        still = {name: np.array([[values.get(name, 0.0), 0.0, 0.0]]) for name in model.inputs}
        absolute.solve(model, still)
    except absolute.AbsoluteError as error:
        return Answer("absolute", "refused", f"{type(error).__name__}: {' '.join(str(error).split())}")
    except Exception as error:
        return Answer("absolute", "wrong", f"fails: {type(error).__name__}: {error}")
    return Answer("absolute", "wrong", "takes it for a mechanism")


def missing(number: float, car: str = "paper") -> Trial:
    """The mechanism without one of its constraints, or without one of its joints."""
    gone, whole = held_in(car)[int(number) - 1], model_of(car)
    joint = tuple(whole.joints)[(int(number) - 1) % len(whole.joints)]

    def without() -> Model:
        return replace(whole, joints={n: j for n, j in whole.joints.items() if n != joint})

    topology = with_constraints(lambda all_: tuple(c for c in all_ if c != gone), car)
    # All else held, what can move violates the link that is gone, so that one of its ends moves.
    ends = (gone.start, gone.end) if isinstance(gone, Link) else ()
    free = {f"{axis} of {end}" for axis in "xyz" for end in ends if end in topology.moving}
    return Trial(
        number,
        (by_pointcoord(topology, set(), free, car), by_absolute(without, car=car)),
        {"constraint": gone.labels[0], "joint": joint},
    )


def redundant(number: float, car: str = "paper") -> Trial:
    """One of the links twice, or one of the joints."""
    link, whole = links_of(car)[int(number) - 1], model_of(car)
    joint = tuple(whole.joints)[(int(number) - 1) % len(whole.joints)]

    def again() -> Model:
        return replace(whole, joints={**whole.joints, "again": whole.joints[joint]})

    topology = with_constraints(lambda all_: (*all_, twice(link)), car)
    rows = {link.labels[0], twice(link).labels[0]}
    return Trial(
        number,
        (by_pointcoord(topology, rows, car=car), by_absolute(again, car=car)),
        {"link": link.labels[0], "joint": joint},
    )


def exchanged(number: float, car: str = "paper") -> Trial:
    """One link twice in place of another, so that there are as many rows as unknowns; joints alike."""
    links, whole = links_of(car), model_of(car)
    link, lost = links[int(number) - 1], links[int(number) % len(links)]
    pairs = exchangeable(whole)
    doubled, dropped = pairs[(int(number) - 1) % len(pairs)]

    def swapped() -> Model:
        joints = {n: j for n, j in whole.joints.items() if n != dropped}
        return replace(whole, joints={**joints, "again": whole.joints[doubled]})

    topology = with_constraints(lambda all_: (*(c for c in all_ if c != lost), twice(link)), car)
    rows = {link.labels[0], twice(link).labels[0]}
    facts: dict[str, float | str] = {
        "twice": f"{link.labels[0]}; {doubled}",
        "missing": f"{lost.labels[0]}; {dropped}",
    }
    return Trial(number, (by_pointcoord(topology, rows, car=car), by_absolute(swapped, car=car)), facts)


def _cases(suffix: str, car: str) -> tuple[Case, ...]:
    def case(name: str, why: str, behaviour: str, examine: Callable[..., Trial], count: int) -> Case:
        return Case(
            name=f"{name}{suffix}",
            group=GROUP,
            why=why,
            parameter="number of the link (and of a joint of the absolute model)",
            values=counted(count),
            expected={"pointcoord": REFUSED, "absolute": REFUSED},
            behaviour=behaviour,
            examine=partial(examine, car=car),
        )

    links = len(links_of(car))
    return (
        case(
            "constraint-missing" if suffix == "-beside" else "link-missing",
            "A point, or the strut's axis, is free to move although all inputs are held.",
            "refused; pointcoord names what is free, of a link a coordinate of its own ends",
            missing,
            len(held_in(car)),
        ),
        case(
            "link-twice",
            "There are more rows than unknowns, and two of them say the same.",
            "refused; pointcoord names both rows",
            redundant,
            links,
        ),
        case(
            "link-twice-for-another",
            "There are as many rows as unknowns, but one says nothing new and one is missing.",
            "refused; pointcoord names both rows",
            exchanged,
            links,
        ),
    )


CASES: tuple[Case, ...] = tuple(case for suffix, car in SIMPLE.items() for case in _cases(suffix, car))
