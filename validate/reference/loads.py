"""The forces in rods and joints under loads on the wheels, by virtual work.

The chassis and the inputs fix the mechanism, except that in a corner with a damper the damper's length is
fixed instead of the input that moves the wheel. A force f and a moment m act on the knuckle at the contact
point c. With q_j = f . dc/dy_j + m . dtheta/dy_j and the Jacobian C' of the fixed mechanism,

    C'^T l = q

gives the work l_i of the load per unit of violation of row i, with all other rows satisfied.

- A rod of length d has the row |a - b|^2 - d^2. If the rod is longer by e, the row is violated by 2 d e, so
  the tension is 2 d l.
- The rows p - p' of a ball joint are the gap between its halves. The joint pulls the body of p by -l, and the
  other body by l.
- A hinge has these three rows at one point of its line. At the other point it has two rows: the products of
  p - p' with two vectors s, s' perpendicular to the line. There the hinge pulls by -(l s + l' s'). Along the
  line there is only one row, so only the sum of the two forces along the line is known.
- A point p on a slide has the rows p - p', with p' its place on the line. They pull p by -l: across the line,
  and along the line if an input drives the place of p' on the line.

The equations are those of the mechanism with rows for every joint and slide.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from typing import Any

from flint import arb

from validate.reference.car_data import DAMPER, KNUCKLE, RADIUS, TRAVEL, WHEEL
from validate.reference.design import Design, Known, equations_in
from validate.reference.drives import compiled
from validate.reference.effects.at_pose import drawn_car, drivers, provided
from validate.reference.exact import as_ball
from validate.reference.jet import Jet, slope_of
from validate.reference.kinematics import body_rates
from validate.reference.krawczyk import column
from validate.reference.mechanism import CHASSIS, Mechanism
from validate.reference.polynomial import at, of_kind
from validate.reference.vectors import Vector, cross, dot, each, length, minus, plus, times

FORCES = ROD, JOINT, THRUST = ("rod_force", "joint_force", "hinge_thrust")
Forces = dict[str, dict[str, Any]]


def forces_at(design: Design, known: Known, enclosure: Sequence[arb], digits: int) -> Forces:
    """The forces at a pose, N, in balls, to `digits` digits of the loads.

    There are none if no load is given, if the car has no data for them, or if the pose is nearly singular.

    Args:
        known: known data of the equations; rates are not used.
        enclosure: enclosure of the unknowns.
    Returns:
        The forces by quantity and name:

        rod_force: tension of every rod, by its name, and of every fixed damper, such as `left.damper`.
        joint_force: force vectors in the scene's axes, by point:
            - the ball joint of exactly two bodies, on no slide. The force acts on the knuckle if it is one of
              the two; otherwise on the first body in the mechanism's file that is not the chassis.
            - both points of a hinge that no input turns: the force across the hinge's line, on that body.
            - a point of exactly one body on exactly one slide: the force on that one of the two bodies.
            - a point of no body on one slide, pulled by a rod that does not lie in the slide: the force on
              the point.
        hinge_thrust: sum of the forces of a hinge along its line, by its first point; positive from the first
            point to the second, in the order of the body's list.
    """
    none: Forces = {quantity: {} for quantity in FORCES}
    if not (design.loads and _can_be_had(design)):
        return none
    mechanism, chassis = _held(design), known.chassis.still()
    equations, places = equations_in(mechanism), known.equations.points_of(enclosure)
    numbers = [jet.value for jet in known.numbers]
    unknown = mechanism.unknown_of(places, numbers, as_ball)
    work, scale = [arb(0)] * mechanism.size, arb(0)
    for prefix, (force, moment) in design.loads.items():
        f, m = each(as_ball, force), times(each(as_ball, moment), as_ball(1 / design.unit))
        car = drawn_car(design, as_ball, prefix).at(chassis, places)
        spoke = minus(car.contact, car.wheel.end)
        centre, body = design.role(prefix + WHEEL)[1], design.role(prefix + KNUCKLE)
        for j in range(mechanism.size):
            pose = [Jet(y, arb(int(i == j))) for i, y in enumerate(unknown)]
            turn = chassis.turned(body_rates(*equations.frame_of(pose, body), 1)[0])
            moved = chassis.turned(each(slope_of, equations.points_of(pose, [centre])[centre]))
            work[j] += dot(f, plus(moved, cross(turn, spoke))) + dot(m, turn)
        scale += length(f) + length(m)
    try:
        solved = equations.matrix(unknown, numbers).transpose().solve(column(work)).entries()
    except ZeroDivisionError:
        return none

    def pull(point: str, acts_on_first: bool) -> Vector:
        """The force that closes the gap of a point, on its first or its second place."""
        (_, first, along), total = mechanism.gaps[point], (arb(0), arb(0), arb(0))
        for row, vector in enumerate(along, first):
            total = plus(total, times(at(of_kind(vector, as_ball), unknown), solved[row]))
        return times(total, -1 if acts_on_first else 1)

    rods = {name: (mechanism.rods[name], ends) for name, ends in design.plain["rods"].items()}
    rods |= {f"{prefix}{DAMPER}": one for prefix, one in _dampers(design, mechanism).items()}
    tensions = {
        name: 2 * length(minus(places[a], places[b])) * solved[row] for name, (row, (a, b)) in rods.items()
    }
    pulls, thrusts = {point: pull(point, not of_line) for point, of_line in _sliding(design).items()}, {}
    for points, body in _joints(design).items():
        own = {point: pull(point, mechanism.gaps[point][0] == body) for point in points}
        if len(points) == 2:
            # Across the line at both points; along it only the sum is known.
            line = minus(places[points[1]], places[points[0]])
            along = {point: dot(force, line) / dot(line, line) for point, force in own.items()}
            thrusts[points[0]] = sum(along.values()) * length(line)
            own = {point: minus(force, times(line, along[point])) for point, force in own.items()}
        pulls |= own
    pulls = {point: chassis.turned(force) for point, force in pulls.items()}
    within = scale * as_ball(Fraction(1, 10**digits))
    every = [*tensions.values(), *thrusts.values(), *(x for pull in pulls.values() for x in pull)]
    exact = all(x.is_finite() and x.rad() <= within for x in every)
    return {ROD: tensions, JOINT: pulls, THRUST: thrusts} if exact else none


def _can_be_had(design: Design) -> bool:
    """Whether no row is redundant, and each corner with a load or a damper has the data for forces."""
    for prefix in design.corners:
        has = provided(design, prefix)
        needs = {WHEEL, KNUCKLE, RADIUS} if prefix in design.loads else set()
        if not needs | ({TRAVEL} if DAMPER in has else set()) <= has:
            return False
    return len(design.mechanism.chosen) == len(design.mechanism.rows)


@lru_cache(maxsize=64)
def _held(design: Design) -> Mechanism:
    """The mechanism with rows for all joints; dampers are fixed instead of the inputs of their wheels."""
    held = compiled(design.plain, design.table, design.unit, hangs=False)
    for name, (row, ends) in _dampers(design, held).items():
        apart = minus(*(held.places[end] for end in ends))
        held.rows[row] = name, dot(apart, apart)
    return held


def _dampers(design: Design, mechanism: Mechanism) -> dict[str, tuple[int, Sequence[str]]]:
    """The row of the input that each damper replaces, and its ends, by prefix of the corner."""
    return {
        prefix: (mechanism.driving[drivers(design, prefix)[TRAVEL]], design.role(prefix + DAMPER))
        for prefix in design.corners
        if design.role(prefix + DAMPER) is not None
    }


def _joints(design: Design) -> dict[tuple[str, ...], str]:
    """For the points of each ball joint and hinge with a known force, the body on which it acts."""
    bodies: Mapping[str, Sequence[str]] = design.plain["bodies"]
    on_slides = {point for slide in design.plain["slides"].values() for point in slide["points"]}
    turned = {spec.get("angle") for spec in design.plain["inputs"].values()}
    found = {}
    for holders in combinations(bodies, 2):
        body = _felt_by(design, holders)
        points = tuple(point for point in bodies[body] if all(point in bodies[other] for other in holders))
        third = {point for other, own in bodies.items() if other not in holders for point in own}
        if not points or {*points} & (on_slides | third) or (len(points) == 2 and turned & {*holders}):
            continue
        found[points] = body
    return found


def _sliding(design: Design) -> dict[str, bool]:
    """The points on turning slides with a known force: whether it acts on the body of the line."""
    plain, found = design.plain, dict[str, bool]()
    for name, slide in plain["slides"].items():
        elsewhere = {p for other, own in plain["slides"].items() if other != name for p in own["points"]}
        ends = {end for both in plain["rods"].values() if not {*both} <= {*slide["points"]} for end in both}
        for point in slide["points"] if slide["turns"] else ():
            holders = [body for body, own in plain["bodies"].items() if point in own]
            if point in elsewhere or len(holders) > 1 or not (holders or point in ends):
                continue
            both = [body for body in plain["bodies"] if body in (*holders, slide["body"])]
            found[point] = bool(holders) and _felt_by(design, both) == slide["body"]
    return found


def _felt_by(design: Design, bodies: Sequence[str]) -> str:
    """The body of two on which the force is stated."""
    knuckles = {design.role(prefix + KNUCKLE) for prefix in design.corners}
    moving = [body for body in bodies if body != CHASSIS]
    return next((body for body in moving if body in knuckles), moving[0])
