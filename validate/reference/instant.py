"""Instants of the mechanism, every number with a proven bound on its error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain
from typing import Any

from flint import arb

from validate.reference.design import Design, Driven, values_only
from validate.reference.effects.at_pose import effects_at, numbers_of
from validate.reference.effects.registry import ANGLES
from validate.reference.errors import InfeasibleError, NoReferenceError, NotDecidedError, SingularPoseError
from validate.reference.exact import MOST_DIGITS, as_ball, centre_of, with_more_digits
from validate.reference.jet import part_of
from validate.reference.kinematics import body_turns, by_balls, with_rates
from validate.reference.loads import forces_at
from validate.reference.path import Pose, StraightPath, start_pose
from validate.reference.polynomial import ordered
from validate.reference.route import CLEAR, Assembly, moved, reached
from validate.reference.vectors import Vector, each, plus, times

Triple = tuple[Fraction, Fraction, Fraction]
Inputs = Mapping[str, Sequence[object]]
Found = dict[str, Mapping[str, Any]]
"""Balls or vectors of balls, by quantity and name."""

DERIVATIVES = ("position", "velocity", "acceleration")
TURNS = ("angular_velocity", "angular_acceleration")
LEAST_PROMISED, MOST_PROMISED = 15, 200  # leaves one doubling at least


@dataclass(frozen=True)
class Instant:
    """The reference at one instant, in mm, s, rad; mappings go by names of points or bodies.

    Attributes:
        position, velocity, acceleration: of every point.
        higher: jerk of every point, mm/s^3, and so on, to the highest derivative given for the inputs.
        angular_velocity, angular_acceleration: of every moving body.
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


def instants_of(
    design: Design,
    inputs: Iterable[Inputs],
    digits: int = 60,
    clearness: float = CLEAR,
    effects: Sequence[str] = ANGLES,
) -> Iterator[Instant]:
    """A motion, with a proof of every digit.

    All given numbers (int, float, Fraction, mpf) are taken as exact. A path without singular poses leads from
    the drawing to the assembly: the drawing is closed, its inputs change to those of the first instant (see
    `route`), and then straight to those of the next instants. Every step is proven. A nearly singular pose
    takes more digits. Not safe for several threads, because the precision of python-flint is global.

    Args:
        design: its points fix the lengths and need not be assembled.
        inputs: inputs of each instant by name, rad or mm: (value, rate, acceleration), perhaps with more
            derivatives; inputs that are not named are constantly zero.
        digits: digits of every number, relative to the greatest of its kind; 15 to 200.
        clearness: least distance of another assembly from the drawing, as a share of the mechanism's size; 0
            if the drawing is exact.
        effects: names of the requested effects, see `effects.registry`.
    Returns:
        The instants, mm, s, rad.
    Raises:
        NoReferenceError: an input cannot be used, or the drawing is at a singular pose.
        InfeasibleError: it is proven that the paths from the drawing meet a fold.
        SingularPoseError: the proofs fail with 400 digits.

    >>> arm = Design.from_plain({  # level, so that the wheel moves straight up at first
    ...     "name": "arm", "rods": {}, "slides": {}, "roles": {"wheel_axis": ["inner", "wheel"]},
    ...     "bodies": {"chassis": ["front", "rear"], "arm": ["front", "rear", "inner", "wheel"]},
    ...     "inputs": {"travel": {"height": "wheel", "along": "up"}},
    ...     "points": {"front": (-100, 0, 0), "rear": (100, 0, 0),
    ...                "inner": (0, -300, 0), "wheel": (0, -350, 0)},
    ...     "up": (0, 0, 1), "right": (0, 1, 0), "side": "left", "wheel_radius": None,
    ... })
    >>> instant = next(instants_of(arm, [{"travel": (210, 0, 0)}]))
    >>> float(instant.position["wheel"][1])
    -280.0
    """
    if not LEAST_PROMISED <= digits <= MOST_PROMISED:
        raise NoReferenceError("digits", f"is {digits}", f"{LEAST_PROMISED} to {MOST_PROMISED}")
    doubled = (digits << k for k in range(MOST_DIGITS.bit_length()))
    ladder = [*(one for one in doubled if one < MOST_DIGITS), MOST_DIGITS]
    here: Assembly | None = None
    for one in inputs:
        driven = design.driven(one)
        here = reached(design, clearness, driven) if here is None else moved(design, here, driven)
        yield with_more_digits(partial(prove_instant, design, driven, here.pose, digits, effects), ladder)


def pose_exists(design: Design, inputs: Inputs, clearness: float = CLEAR) -> bool:
    """Whether the assembly of the drawing can reach these inputs.

    A pose that is singular to 400 digits counts as reached: it is the end of the range.
    """
    try:
        reached(design, clearness, design.driven(inputs))
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True


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
    still, origin = values_only(known), each(as_ball, design.origin)
    enclosure = start_pose(
        StraightPath(still.equations, still.numbers, still.numbers), followed.unknown, arb(0)
    ).box
    if not followed.holds(enclosure):
        raise NotDecidedError("the assembly found", "not proven to be the one followed", "the one followed")
    _require_others(design, enclosure, still.numbers, least)
    solver = by_balls(enclosure, still)
    solved = with_rates(enclosure, known, solver)
    points, turns = known.points_of(solved), body_turns(solved, known)
    orders = [derivative_called(order) for order in range(known.derivatives + 1)]
    found: Found = {
        quantity: {name: times(part_of(place, order), unit) for name, place in points.items()}
        for order, quantity in enumerate(orders)
    }
    found["position"] = {name: plus(origin, place) for name, place in found["position"].items()}
    for order, quantity in enumerate(TURNS):
        found[quantity] = {body: turn[order] for body, turn in turns.items()}
    for quantity, scale in _scales(found, orders, unit).items():
        bound = _largest_radius(found[quantity])
        if not (scale.is_finite() and bound <= scale * least):
            raise NotDecidedError(f"the error bound of {quantity}", bound, scale * least)
    numbers = {number.name: number for number in numbers_of(design, effects)}
    found["effects"] = {
        name: ball
        for name, ball in effects_at(design, known, enclosure, solver, numbers.values()).items()
        if ball.is_finite() and ball.rad() < unit ** numbers[name].effect.power * least
    }
    found |= forces_at(design, known, enclosure, digits)
    centres: dict[str, Any] = {
        q: {n: each(centre_of, x) if isinstance(x, tuple) else centre_of(x) for n, x in of.items()}
        for q, of in found.items()
    }
    bounds = {quantity: centre_of(_largest_radius(of)) for quantity, of in found.items()}
    higher = tuple(centres.pop(quantity) for quantity in orders[len(DERIVATIVES) :])
    return Instant(**centres, higher=higher, error_bound=bounds)


def derivative_called(order: int) -> str:
    """The name of a time derivative of positions among the error bounds."""
    return DERIVATIVES[order] if order < len(DERIVATIVES) else f"derivative {order}"


def _require_others(design: Design, enclosure: Sequence[arb], numbers: Sequence[arb], least: arb) -> None:
    """Check, to the requested digits, the rows that are not solved because they depend on others as drawn.

    Raises:
        NoReferenceError: one of these rows is violated.
    """
    values, mechanism = ordered(enclosure, numbers), design.mechanism
    for name, row in (row for i, row in enumerate(mechanism.rows) if i not in mechanism.chosen):
        missed = row.of_kind(as_ball).at(values)
        if not missed.contains(0):
            problem = f"depends on the others in the drawing and is violated here by {missed.str(6)}"
            allowed = "0; the mechanism is locked, or not drawn exactly enough"
            raise NoReferenceError(f"the row {name!r}", problem, allowed)
        if not missed.abs_upper() < least:
            raise NotDecidedError(f"the row {name!r}", missed, least)


def _scales(found: Found, orders: Sequence[str], unit: arb) -> dict[str, arb]:
    """The greatest number of each kind. Centripetal terms count with their size, because they may cancel."""

    def largest(vectors: Mapping[str, Vector]) -> Any:
        return max(x.abs_upper() for vector in vectors.values() for x in vector)

    fastest = largest(found["velocity"])
    scales = [unit, fastest]
    for quantity in orders[2:]:
        scales.append(largest(found[quantity]) + scales[-1] * fastest / unit)
    turns = {q: largest(found[q]) + scales[k] / unit for k, q in enumerate(TURNS, start=1)}
    return dict(zip(orders, scales, strict=True)) | turns


def _largest_radius(found: Mapping[str, Any]) -> arb:
    """The largest radius of balls, or of vectors of balls."""
    every = chain.from_iterable(of if isinstance(of, tuple) else (of,) for of in found.values())
    return max((x.rad() for x in every), default=arb(0))
