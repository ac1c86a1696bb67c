r"""How every quantity of an instant depends on the inputs: exact derivatives, from the equations themselves.

C(y, w) = 0 holds along a motion whose inputs w(t) are changed a little. With a dual number for each
coefficient of the jets, evaluating C gives C(y(t), w(t)) with its derivatives by time and by the change; each
coefficient of the change of y solves a linear equation with the one matrix C'.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from flint import arb, arb_mat
from mpmath import mpf

from validate.reference.design import Design, Driven, Known, balls, values_only
from validate.reference.dual import Dual, slope_of
from validate.reference.effects.at_pose import car_at, drawn_car, provided
from validate.reference.effects.registry import OF_POSITIONS, available
from validate.reference.errors import NotDecidedError
from validate.reference.exact import as_ball, centre_of
from validate.reference.instant import Triple, prove_pose
from validate.reference.jet import Jet, part_of
from validate.reference.kinematics import body_turns, inverse_jacobian, unknown_jets
from validate.reference.route import CLEAR, Assembly, reached
from validate.reference.solve import with_enough_digits
from validate.reference.vectors import Vector, each, times

ORDERS = ("value", "rate", "acceleration")


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives by one number of one input, per rad (arm angle) or mm, or these per s or s^2.

    Attributes:
        position, velocity, acceleration: of every point; mm, mm/s, mm/s^2 per unit of the input.
        angular_velocity, angular_acceleration: of every moving body.
        effects: those of positions, by name, see `effects.registry`; one that is undefined (0/0) is left out.
        error_bound: proven bound on the error of each quantity above.
    """

    position: Mapping[str, Triple]
    velocity: Mapping[str, Triple]
    acceleration: Mapping[str, Triple]
    angular_velocity: Mapping[str, Triple]
    angular_acceleration: Mapping[str, Triple]
    effects: Mapping[str, mpf]
    error_bound: Mapping[str, mpf]


def sensitivities(
    design: Design,
    inputs: Mapping[str, Sequence[object]],
    digits: int = 60,
    clearness: float = CLEAR,
) -> dict[tuple[str, str], Sensitivity]:
    """The derivatives of an instant by the value, rate and acceleration of each input.

    An input that is off by (e0, e1, e2) in value, rate and acceleration moves a quantity by the sum of
    e_i times these, to first order.

    Args:
        inputs: as for `solve_reference`; also digits, clearness.
    Returns:
        By (input, "value" | "rate" | "acceleration").
    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    driven = design.driven(inputs)
    here = reached(design, clearness, driven)
    return with_enough_digits(partial(_attempt, design, driven, here, digits), digits)


def _attempt(
    design: Design, driven: Driven, here: Assembly, digits: int, working: int
) -> dict[tuple[str, str], Sensitivity]:
    known = design.known(driven)
    still = values_only(known)
    enclosure = prove_pose(still, here.pose.unknown, here.pose.holds, digits, working).enclosure
    inverse = inverse_jacobian(enclosure, still)
    jets = unknown_jets(enclosure, known, inverse)
    return {
        (name, order): _by(design, _changed(design, driven, name, order), jets, inverse)
        for name in driven
        for order in ORDERS
    }


def _changed(design: Design, driven: Driven, name: str, order: str) -> Known:
    """What is given, with its slope by one number of one input."""

    def dual(other: str) -> Jet:
        jet = balls(driven[other])
        return Jet(*(Dual(getattr(jet, o), arb(int((other, o) == (name, order)))) for o in ORDERS))

    return design.known_for({other: dual(other) for other in driven})


def _by(design: Design, known: Known, jets: Sequence[Jet], inverse: arb_mat) -> Sensitivity:
    slopes: list[list[arb]] = [[arb(0)] * 3 for _ in jets]
    for order, name in enumerate(ORDERS):
        rows = known.residual(_with_slopes(jets, slopes))
        step = inverse * arb_mat(len(rows), 1, [-slope_of(getattr(row, name)) for row in rows])
        for i, slope in enumerate(slopes):
            slope[order] = step[i, 0]
    solved = _with_slopes(jets, slopes)
    points, unit = known.points_of(solved), as_ball(design.unit)
    turns = body_turns(solved, known)
    vectors = {
        quantity: {name: times(_slope_of(part_of(points[name], order)), unit) for name in design.names}
        for quantity, order in zip(("position", "velocity", "acceleration"), ORDERS, strict=True)
    }
    for i, quantity in enumerate(("angular_velocity", "angular_acceleration")):
        vectors[quantity] = {body: _slope_of(turn[i]) for body, turn in turns.items()}
    if not all(x.is_finite() for named in vectors.values() for vector in named.values() for x in vector):
        raise NotDecidedError("a quotient with a divisor that may be 0", "not finite", "finite")
    drawn = drawn_car(design, as_ball)
    places = known.equations.points_of([jet.value for jet in solved], drawn.points)
    car = car_at(drawn, known.chassis.still(), places)
    slopes_of_effects = {
        name: arb(slope_of(effect.evaluate(car))) * unit**effect.power
        for name, effect in available(OF_POSITIONS, provided(design)).items()
    }
    effects = {name: slope for name, slope in slopes_of_effects.items() if slope.is_finite()}
    bounds = {
        quantity: max(x.rad() for vector in named.values() for x in vector)
        for quantity, named in vectors.items()
    }
    bounds["effects"] = max((slope.rad() for slope in effects.values()), default=arb(0))
    return Sensitivity(
        **{
            quantity: {name: each(centre_of, vector) for name, vector in named.items()}
            for quantity, named in vectors.items()
        },
        effects={name: centre_of(slope) for name, slope in effects.items()},
        error_bound={quantity: centre_of(bound) for quantity, bound in bounds.items()},
    )


def _with_slopes(jets: Sequence[Jet], slopes: Sequence[Sequence[arb]]) -> list[Jet]:
    return [
        Jet(*(Dual(getattr(jet, order), one) for order, one in zip(ORDERS, slope, strict=True)))
        for jet, slope in zip(jets, slopes, strict=True)
    ]


def _slope_of(vector: Vector) -> Vector:
    return each(lambda number: arb(slope_of(number)), vector)
