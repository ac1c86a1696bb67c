"""One instant of the mechanism, every number with a proven bound on its error."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from validate.reference.certificate import Certificate, certify
from validate.reference.design import Design, Known, ball_vector, values_only
from validate.reference.effects.at_pose import effects_at, numbers_of
from validate.reference.effects.registry import ANGLES, named
from validate.reference.errors import NoReferenceError, NotDecidedError
from validate.reference.exact import as_ball, centre_of
from validate.reference.jet import part_of
from validate.reference.kinematics import body_turns, inverse_jacobian, unknown_jets
from validate.reference.krawczyk import newton
from validate.reference.loads import forces_at
from validate.reference.polynomial import ordered
from validate.reference.vectors import Vector, each, plus, times

Triple = tuple[Fraction, Fraction, Fraction]
Expected = Callable[[Sequence[arb]], bool]

DERIVATIVES = ("position", "velocity", "acceleration")
UNDEFINED = (
    "cannot be proven in this pose, where it is 0/0, or jumps by a whole turn, or the wheel does not travel, "
    "or a centre is at infinity, or the wheels are not steered to one side"
)


@dataclass(frozen=True)
class Instant:
    """The reference at one instant. Mappings go by point or body name; mm, s, rad.

    Attributes:
        position: every point, mm.
        velocity: every point, mm/s.
        acceleration: every point, mm/s^2.
        higher: jerk of every point, mm/s^3, and so on: as many as the inputs are given with.
        angular_velocity: of every moving body, rad/s.
        angular_acceleration: of the same, rad/s^2.
        effects: those that were asked for, by name, with its part's prefix if there are parts, see
            `effects.registry`; rad, mm, these per mm, and %.
        rod_force, joint_force, hinge_thrust: where loads are given, of rods, dampers, joints, N; see `loads`.
        left_out: those of these three that there are none of, and why: the car lacks what they need, or they
            are undefined in this pose (0/0, an angle at 180 deg, a wheel that does not travel, a centre at
            infinity, wheels that are steered apart).
        radius: exactly one assembly lies within this distance of `position` (maximum norm, mm).
        error_bound: proven bound on the error of each quantity above, in its unit; of jerks as
            "derivative 3", and so on.
        condition: of the Jacobian, maximum norm, lengths in units of the mechanism, rows scaled.
        digits: how many digits it took.
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
    left_out: Mapping[str, str]
    radius: Fraction
    error_bound: Mapping[str, Fraction]
    condition: float
    digits: int

    @property
    def derivatives(self) -> tuple[Mapping[str, Triple], ...]:
        """Of points by order, that of order 0 their positions."""
        return self.position, self.velocity, self.acceleration, *self.higher

    def effect(self, name: str) -> Fraction:
        """An effect that must be there.

        Raises:
            BadInputError: there is no such effect.
            NoReferenceError: it was not asked for, or there is none, see `left_out`.
        """
        named([name])
        if name not in self.effects:
            raise NoReferenceError(
                f"{name} {self.left_out.get(name, 'was not asked for: name it in `effects`')}"
            )
        return self.effects[name]

    def position_as_float(self, name: str) -> tuple[float, float, float]:
        """The point rounded to float64, mm: the nearest, up to `radius` where two are equally near."""
        x, y, z = self.position[name]
        return float(x), float(y), float(z)


def prove_instant(
    design: Design,
    known: Known,
    start: Sequence[arb],
    expected: Expected,
    digits: int,
    working: int,
    effects: Sequence[str] = ANGLES,
) -> Instant:
    """Refine, prove and differentiate at the present precision.

    Args:
        known: with rates, local.
        start: the unknowns to start from, local.
        expected: holds of the enclosure of the assembly that must come out.
        digits: what every returned number must have, relative to the greatest of its kind.
        working: digits of the arithmetic (25 more are carried), at least `digits`.
        effects: names of those that are wanted.
    Raises:
        NotDecidedError: a proof fails with the present digits.
        BadInputError: there is no such effect.
    """
    still, unit, least = values_only(known), as_ball(design.unit), as_ball(Fraction(1, 10**digits))
    certificate = prove_pose(still, start, expected, digits, working)
    enclosure = certificate.enclosure
    _require_others(design, enclosure, still, least)
    inverse = inverse_jacobian(enclosure, still)
    solved = unknown_jets(enclosure, known, inverse)
    found = _motion(design, known.points_of(solved), body_turns(solved, known), known.derivatives)
    bounds = {quantity: _largest_radius(of) for quantity, of in found.items()}
    for quantity, scale in _scales(found, unit).items():
        if not bounds[quantity] <= scale * least:
            raise NotDecidedError(f"the error bound of {quantity}", bounds[quantity], scale * least)

    # The proof speaks of a box about the centre, the answer is the middle of the enclosure. Half the
    # box about the answer lies inside the whole box about the centre, so the proof holds there too;
    # a shift of at most a quarter leaves room for the rounding of the radius itself.
    # A turned chassis turns the box: in the maximum norm its room is smaller by less than two.
    radius = certificate.radius * design.unit / (4 if known.chassis.turns else 2)
    shift = certificate.shift * unit + bounds["position"]
    if not shift < as_ball(radius / 2):
        raise NotDecidedError("the answer well inside its box (mm)", shift, as_ball(radius / 2))

    numbers = {number.name: number for number in numbers_of(design, effects)}
    evaluated = effects_at(design, known, enclosure, inverse, numbers.values())
    found["effects"] = {
        name: ball
        for name, ball in evaluated.items()
        if ball.rad() < unit ** numbers[name].effect.power * least
    }
    left_out = {
        name: f"needs {number.lacks}" if number.lacks else UNDEFINED
        for name, number in numbers.items()
        if name not in found["effects"]
    }
    forces, no_forces = forces_at(design, known, enclosure, digits)
    told = (found | forces).items() if design.loads else found.items()
    further = [derivative_called(order) for order in range(len(DERIVATIVES), known.derivatives + 1)]
    return Instant(
        **{quantity: _centres(of) for quantity, of in (found | forces).items() if quantity not in further},
        higher=tuple(_centres(found[quantity]) for quantity in further),
        left_out={**left_out, **no_forces},
        radius=radius,
        error_bound={quantity: centre_of(_largest_radius(of)) for quantity, of in told},
        condition=certificate.condition,
        digits=working,
    )


def derivative_called(order: int) -> str:
    """What a time derivative of positions is called among the error bounds."""
    return DERIVATIVES[order] if order < len(DERIVATIVES) else f"derivative {order}"


def prove_pose(
    known: Known, start: Sequence[arb], expected: Expected, digits: int, working: int
) -> Certificate:
    """Refine and prove the position at the present precision; `known` without rates, else as above.

    Raises:
        NotDecidedError: a proof fails with the present digits.
    """
    # Extra digits go half into a smaller box, which keeps a close second assembly out, and half into
    # the arithmetic, which a nearly singular Jacobian wears down.
    certificate = certify(newton(known.system, start)[0], known, Fraction(1, 10 ** ((digits + working) // 2)))
    if not known.handed(certificate.enclosure):
        raise NotDecidedError("the handedness of the zero found", "not positive", "> 0")
    if not expected(certificate.enclosure):
        raise NotDecidedError("the assembly found", "not proven to be the one followed", "the same")
    return certificate


def _require_others(design: Design, enclosure: Sequence[arb], known: Known, least: arb) -> None:
    """Pass if the rows that are not solved, because the others say them in the drawing, hold here too.

    That they hold exactly cannot be proven by balls, only that they do to the digits asked for.

    Raises:
        NoReferenceError: one does not hold.
    """
    values = ordered(enclosure, known.numbers)
    for i in set(range(len(design.mechanism.rows))) - set(design.chosen):
        name, row = design.mechanism.rows[i]
        missed = row.at(values, as_ball)
        if not missed.contains(0):
            raise NoReferenceError(
                f"the row {name!r}, which depends on the others in the drawing, is violated "
                f"here by {missed.str(6)}, needed 0; the mechanism is locked, or not drawn exactly enough"
            )
        if not missed.abs_upper() < least:
            raise NotDecidedError(f"the row {name!r}", missed, least)


def _motion(
    design: Design, points: Mapping[str, Vector], turns: Mapping[str, Sequence[Vector]], derivatives: int
) -> dict[str, Mapping[str, Any]]:
    """Positions, rates and turning in mm, s, rad."""
    unit, origin = as_ball(design.unit), ball_vector(design.origin)
    found: dict[str, Mapping[str, Any]] = {
        derivative_called(order): {name: times(part_of(points[name], order), unit) for name in design.names}
        for order in range(derivatives + 1)
    }
    found["position"] = {name: plus(origin, place) for name, place in found["position"].items()}
    for order, quantity in enumerate(("angular_velocity", "angular_acceleration")):
        found[quantity] = {body: turn[order] for body, turn in turns.items()}
    if not all(x.is_finite() for of in found.values() for vector in of.values() for x in vector):
        raise NotDecidedError("a quotient with a divisor that may be 0", "not finite", "finite")
    return found


def _scales(vectors: Mapping[str, Mapping[str, Vector]], unit: arb) -> dict[str, arb]:
    """The greatest number of each kind; centripetal parts may cancel: their size counts."""
    largest = {
        quantity: max(x.abs_upper() for vector in of.values() for x in vector)
        for quantity, of in vectors.items()
    }
    fastest = largest["velocity"]
    push = largest["acceleration"] + fastest * fastest / unit
    scales = {
        "position": unit,
        "velocity": fastest,
        "acceleration": push,
        "angular_velocity": largest["angular_velocity"] + fastest / unit,
        "angular_acceleration": largest["angular_acceleration"] + push / unit,
    }
    order, before = len(DERIVATIVES), push
    while (quantity := derivative_called(order)) in largest:
        before = scales[quantity] = largest[quantity] + before * fastest / unit
        order += 1
    return scales


def _largest_radius(found: Mapping[str, Any]) -> arb:
    """Of balls, or of vectors of balls."""
    every = (x for of in found.values() for x in (of if isinstance(of, tuple) else (of,)))
    return max((x.rad() for x in every), default=arb(0))


def _centres(found: Mapping[str, Any]) -> dict[str, Any]:
    return {n: each(centre_of, of) if isinstance(of, tuple) else centre_of(of) for n, of in found.items()}
