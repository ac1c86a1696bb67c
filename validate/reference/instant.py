"""One instant of the mechanism, every number with a proven bound on its error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import Any

from flint import arb

from validate.reference.design import Design, Driven, values_only
from validate.reference.effects.at_pose import effects_at, numbers_of
from validate.reference.effects.registry import ANGLES
from validate.reference.errors import NoReferenceError, NotDecidedError
from validate.reference.exact import as_ball, centre_of
from validate.reference.jet import part_of
from validate.reference.kinematics import body_turns, by_balls, with_rates
from validate.reference.loads import forces_at
from validate.reference.path import Pose, StraightPath, start_pose
from validate.reference.polynomial import ordered
from validate.reference.vectors import Vector, each, plus, times

Triple = tuple[Fraction, Fraction, Fraction]

DERIVATIVES = ("position", "velocity", "acceleration")
TURNS = ("angular_velocity", "angular_acceleration")


@dataclass(frozen=True)
class Instant:
    """The reference at one instant, in mm, s, rad; mappings go by names of points or bodies.

    Attributes:
        position: every point, mm.
        velocity: every point, mm/s.
        acceleration: every point, mm/s^2.
        higher: jerk of every point, mm/s^3, and so on, to the highest derivative given for the inputs.
        angular_velocity: of every moving body, rad/s.
        angular_acceleration: of every moving body, rad/s^2.
        effects: the requested effects by name, with the part's prefix if there are parts, see
            `effects.registry`; in rad, mm, rad/mm and so on, %. An effect is missing if the car lacks what it
            needs, or if it is undefined in this pose: 0/0, an angle at 180 deg, a wheel that does not travel,
            a centre at infinity, wheels that are steered in opposite directions.
        rod_force, joint_force, hinge_thrust: forces of rods, dampers and joints under given loads, N; see
            `loads`.
        error_bound: proven bound on the error of each quantity above, in its unit; jerks have the key
            "derivative 3", and so on.
    """

    position: Mapping[str, Triple]
    velocity: Mapping[str, Triple]
    acceleration: Mapping[str, Triple]
    higher: tuple[Mapping[str, Triple], ...]
    angular_velocity: Mapping[str, Triple]
    angular_acceleration: Mapping[str, Triple]
    effects: Mapping[str, Fraction]
    rod_force: Mapping[str, Fraction]
    joint_force: Mapping[str, Triple]
    hinge_thrust: Mapping[str, Fraction]
    error_bound: Mapping[str, Fraction]

    @property
    def derivatives(self) -> tuple[Mapping[str, Triple], ...]:
        """Time derivatives of the points by order; order 0 is their positions."""
        return self.position, self.velocity, self.acceleration, *self.higher


def prove_instant(
    design: Design, driven: Driven, followed: Pose, digits: int, effects: Sequence[str] = ANGLES
) -> Instant:
    """Refine, prove and differentiate at the present precision.

    Args:
        followed: the pose at the end of a path, from fewer digits; the result must be this pose.
        digits: correct digits of every returned number, relative to the greatest of its kind.
        effects: names of the requested effects.
    Raises:
        NotDecidedError: a proof fails with the present digits.
        NoReferenceError: there is no such effect.
    """
    known, unit, least = design.known(driven), as_ball(design.unit), as_ball(Fraction(1, 10**digits))
    still = values_only(known)
    pose = start_pose(StraightPath(still.equations, still.numbers, still.numbers), followed.unknown, arb(0))
    enclosure = pose.box
    if not followed.holds(enclosure):
        raise NotDecidedError("the assembly found", "not proven to be the one followed", "the one followed")
    _require_others(design, enclosure, still.numbers, least)
    solver = by_balls(enclosure, still)
    solved = with_rates(enclosure, known, solver)
    found = _motion(design, known.points_of(solved), body_turns(solved, known), known.derivatives)
    bounds = {quantity: _largest_radius(of) for quantity, of in found.items()}
    for quantity, scale in _scales(found, unit).items():
        if not bounds[quantity] <= scale * least:
            raise NotDecidedError(f"the error bound of {quantity}", bounds[quantity], scale * least)
    numbers = {number.name: number for number in numbers_of(design, effects)}
    evaluated = effects_at(design, known, enclosure, solver, numbers.values())
    found["effects"] = {
        name: ball
        for name, ball in evaluated.items()
        if ball.is_finite() and ball.rad() < unit ** numbers[name].effect.power * least
    }
    found |= forces_at(design, known, enclosure, digits)
    further = [derivative_called(order) for order in range(len(DERIVATIVES), known.derivatives + 1)]
    return Instant(
        **{quantity: _centres(of) for quantity, of in found.items() if quantity not in further},
        higher=tuple(_centres(found[quantity]) for quantity in further),
        error_bound={quantity: centre_of(_largest_radius(of)) for quantity, of in found.items()},
    )


def derivative_called(order: int) -> str:
    """The name of a time derivative of positions among the error bounds."""
    return DERIVATIVES[order] if order < len(DERIVATIVES) else f"derivative {order}"


def _require_others(design: Design, enclosure: Sequence[arb], numbers: Sequence[arb], least: arb) -> None:
    """Check, to the requested digits, the rows that are not solved because they depend on others as drawn.

    Raises:
        NoReferenceError: one of these rows is violated.
    """
    values = ordered(enclosure, numbers)
    for i in set(range(len(design.mechanism.rows))) - set(design.mechanism.chosen):
        name, row = design.mechanism.rows[i]
        missed = row.of_kind(as_ball).at(values)
        if not missed.contains(0):
            raise NoReferenceError(
                f"the row {name!r}",
                f"depends on the others in the drawing and is violated here by {missed.str(6)}: the "
                "mechanism is locked, or not drawn exactly enough",
                "0",
            )
        if not missed.abs_upper() < least:
            raise NotDecidedError(f"the row {name!r}", missed, least)


def _motion(
    design: Design, points: Mapping[str, Vector], turns: Mapping[str, Sequence[Vector]], derivatives: int
) -> dict[str, Mapping[str, Any]]:
    """Positions, rates and angular rates in mm, s, rad."""
    unit, origin = as_ball(design.unit), each(as_ball, design.origin)
    found: dict[str, Mapping[str, Any]] = {
        derivative_called(order): {name: times(part_of(points[name], order), unit) for name in design.table}
        for order in range(derivatives + 1)
    }
    found["position"] = {name: plus(origin, place) for name, place in found["position"].items()}
    for order, quantity in enumerate(TURNS):
        found[quantity] = {body: turn[order] for body, turn in turns.items()}
    if not all(x.is_finite() for of in found.values() for vector in of.values() for x in vector):
        raise NotDecidedError("a quotient with a divisor that may be 0", "not finite", "finite")
    return found


def _scales(found: Mapping[str, Mapping[str, Vector]], unit: arb) -> dict[str, arb]:
    """The greatest number of each kind. Centripetal terms count with their size, because they may cancel."""
    largest = {
        quantity: max(x.abs_upper() for vector in of.values() for x in vector)
        for quantity, of in found.items()
    }
    fastest = largest["velocity"]
    orders = [unit, fastest]
    while (quantity := derivative_called(len(orders))) in largest:
        orders.append(largest[quantity] + orders[-1] * fastest / unit)
    turns = {quantity: largest[quantity] + orders[k] / unit for k, quantity in enumerate(TURNS, start=1)}
    return {derivative_called(order): scale for order, scale in enumerate(orders)} | turns


def _largest_radius(found: Mapping[str, Any]) -> arb:
    """The largest radius of balls, or of vectors of balls."""
    every = chain.from_iterable(of if isinstance(of, tuple) else (of,) for of in found.values())
    return max((x.rad() for x in every), default=arb(0))


def _centres(found: Mapping[str, Any]) -> dict[str, Any]:
    return {n: each(centre_of, of) if isinstance(of, tuple) else centre_of(of) for n, of in found.items()}
