"""One instant of the mechanism, every number with a proven bound on its error."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb
from mpmath import mpf

from validate.reference.candidates import choices_of
from validate.reference.certificate import Certificate, certify, refine
from validate.reference.design import Design, ball_vector, values_only
from validate.reference.effects.effect import Axes
from validate.reference.effects.registry import EFFECTS
from validate.reference.errors import BadInputError, NoReferenceError, NotDecidedError
from validate.reference.exact import as_ball, as_fraction, centre_of, mpf_from_fraction
from validate.reference.kinematics import body_turns, unknown_jets
from validate.reference.linkage import Choices, Known
from validate.reference.vectors import Vector, plus, times

Triple = tuple[mpf, mpf, mpf]


@dataclass(frozen=True)
class Instant:
    """The reference at one instant. Mappings go by point or body name; mm, s, rad.

    The mpf numbers hold more digits than mpmath's default: set `mpmath.mp.dps` before computing with
    them, or mpmath rounds the result.

    Attributes:
        position: every point, mm.
        velocity: every point, mm/s.
        acceleration: every point, mm/s^2.
        angular_velocity: of the knuckle and of each arm (see `Linkage.arms`), rad/s.
        angular_acceleration: of the same, rad/s^2.
        effects: by name, see `effects.registry`; one that is undefined (0/0, or at 180 deg) is left out.
        radius: exactly one assembly lies within this distance of `position` (maximum norm, mm).
        error_bound: proven bound on the error of each quantity above, in its unit.
        condition: of the Jacobian, maximum norm, lengths in units of the mechanism, rows scaled.
        choices: which of the possible assemblies this is.
        digits: how many digits it took.
    """

    position: Mapping[str, Triple]
    velocity: Mapping[str, Triple]
    acceleration: Mapping[str, Triple]
    angular_velocity: Mapping[str, Triple]
    angular_acceleration: Mapping[str, Triple]
    effects: Mapping[str, mpf]
    radius: mpf
    error_bound: Mapping[str, mpf]
    condition: float
    choices: Choices
    digits: int

    def effect(self, name: str) -> mpf:
        """An effect that must be there.

        Raises:
            BadInputError: there is no such effect.
            NoReferenceError: it is undefined in this pose.
        """
        if name not in EFFECTS:
            raise BadInputError("effect", name, f"one of {', '.join(EFFECTS)}")
        if name not in self.effects:
            raise NoReferenceError(
                f"the {name} angle cannot be proven in this pose: both sides are 0, or it is 180 deg; "
                "use the positions instead"
            )
        return self.effects[name]

    def position_as_float(self, name: str) -> tuple[float, float, float]:
        """The point rounded to float64, mm: the nearest, up to `radius` where two are equally near."""
        x, y, z = (float(as_fraction(number, name)) for number in self.position[name])
        return x, y, z


def prove_instant(
    design: Design,
    known: Known,
    start: Sequence[arb],
    expected: Choices | None,
    digits: int,
    working: int,
) -> Instant:
    """Refine, prove and differentiate at the present precision.

    Args:
        known: with rates, local.
        start: the unknowns to start from, local.
        expected: the assembly that must come out, or None for whichever is there.
        digits: what every returned number must have, relative to the greatest of its kind.
        working: digits of the arithmetic (25 more are carried), at least `digits`.
    Raises:
        NotDecidedError: a proof fails with the present digits.
    """
    still = values_only(known)
    certificate = prove_pose(still, start, expected, digits, working)
    solved = unknown_jets(certificate.enclosure, known)
    points = known.linkage.points_of(solved, known)

    unit, origin = as_ball(design.unit), ball_vector(design.origin)
    named = {name: points[name] for name in design.names}
    position = {name: plus(origin, times(_part(p, "value"), unit)) for name, p in named.items()}
    velocity = {name: times(_part(p, "rate"), unit) for name, p in named.items()}
    acceleration = {name: times(_part(p, "acceleration"), unit) for name, p in named.items()}
    turns = body_turns(solved, points, known)
    omega, alpha = ({body: turn[i] for body, turn in turns.items()} for i in (0, 1))

    fastest, hardest = _greatest(velocity.values()), _greatest(acceleration.values())
    push = hardest + fastest * fastest / unit  # centripetal parts may cancel: their size counts
    scales = {
        "position": unit,
        "velocity": fastest,
        "acceleration": push,
        "angular_velocity": _greatest(omega.values()) + fastest / unit,
        "angular_acceleration": _greatest(alpha.values()) + push / unit,
    }
    vectors = {
        "position": position,
        "velocity": velocity,
        "acceleration": acceleration,
        "angular_velocity": omega,
        "angular_acceleration": alpha,
    }
    if not all(x.is_finite() for balls in vectors.values() for vector in balls.values() for x in vector):
        raise NotDecidedError("a quotient with a divisor that may be 0", "not finite", "finite")
    bounds = {quantity: _greatest_radius(balls.values()) for quantity, balls in vectors.items()}
    for quantity, bound in bounds.items():
        limit = scales[quantity] * as_ball(Fraction(1, 10**digits))
        if not (bound <= limit):
            raise NotDecidedError(f"the error bound of {quantity}", bound, limit)

    # The proof speaks of a box about the centre, the answer is the middle of the enclosure. Half the
    # box about the answer lies inside the whole box about the centre, so the proof holds there too;
    # a shift of at most a quarter leaves room for the rounding of the radius itself.
    radius = certificate.radius * design.unit / 2
    shift = certificate.shift * unit + bounds["position"]
    if not shift < as_ball(radius / 2):
        raise NotDecidedError("the answer well inside its box (mm)", shift, as_ball(radius / 2))

    axes = Axes.of({name: _part(p, "value") for name, p in points.items()}, still, design.outboard)
    balls = {name: effect.value(axes) for name, effect in EFFECTS.items()}
    effects = {name: ball for name, ball in balls.items() if ball.rad() < as_ball(Fraction(1, 10**digits))}
    bounds["effects"] = max((ball.rad() for ball in effects.values()), default=arb(0))
    return Instant(
        **{quantity: _centres(balls) for quantity, balls in vectors.items()},
        effects={name: centre_of(ball) for name, ball in effects.items()},
        radius=mpf_from_fraction(radius, working),
        error_bound={quantity: centre_of(bound) for quantity, bound in bounds.items()},
        condition=certificate.condition,
        choices=choices_of({n: _part(p, "value") for n, p in points.items()}, still),
        digits=working,
    )


def prove_pose(
    known: Known, start: Sequence[arb], expected: Choices | None, digits: int, working: int
) -> Certificate:
    """Refine and prove the position at the present precision; `known` without rates, else as above.

    Raises:
        NotDecidedError: a proof fails with the present digits.
    """
    # Extra digits go half into a smaller box, which keeps a close second assembly out, and half into
    # the arithmetic, which a nearly singular Jacobian wears down.
    certificate = certify(refine(start, known), known, Fraction(1, 10 ** ((digits + working) // 2)))
    points = known.linkage.points_of(certificate.enclosure, known)
    choices = choices_of(points, known)
    if expected is not None and choices != expected:
        raise NotDecidedError("the choices of the assembly found", str(choices), str(expected))
    return certificate


def _part(vector: Vector, name: str) -> Vector:
    return getattr(vector[0], name), getattr(vector[1], name), getattr(vector[2], name)


def _greatest(vectors: Iterable[Vector]) -> arb:
    """Greatest component in size, from above."""
    greatest: arb = max(x.abs_upper() for vector in vectors for x in vector)
    return greatest


def _greatest_radius(vectors: Iterable[Vector]) -> arb:
    greatest: arb = max(x.rad() for vector in vectors for x in vector)
    return greatest


def _centres(balls: Mapping[str, Vector]) -> dict[str, Triple]:
    return {name: (centre_of(x), centre_of(y), centre_of(z)) for name, (x, y, z) in balls.items()}
