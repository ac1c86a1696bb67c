"""The closed drawing: the car solved at the inputs that it is drawn at, and how far that moves its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

from flint import arb, ctx
from mpmath import mpf

from validate.reference.branches import CLEAR_SIGN, candidate, choices_of_table
from validate.reference.closures import DEFAULT
from validate.reference.design import Design, Driven
from validate.reference.equations import Known
from validate.reference.exact import as_ball, as_fraction, bits, centre_of, mpf_from_fraction
from validate.reference.instant import Instant
from validate.reference.jet import Jet
from validate.reference.solve import Points, prove_assembly
from validate.reference.vectors import dot, minus, plus, times


@dataclass(frozen=True)
class ClosedDrawing:
    """A car at its own drawn inputs.

    Attributes:
        instant: the proven pose, at rest; `instant.radius` bounds the error of its positions.
        arm_angle: drawn theta, rad: cos(theta) = (p5 - p1) . up / d_51, 0 to pi.
        rack: drawn S, mm: (p3 - p9) . right, exact to `digits`.
        movement: how far each point is from where it is drawn, mm; within sqrt(3) times `instant.radius`.
    """

    instant: Instant
    arm_angle: mpf
    rack: mpf
    movement: Mapping[str, mpf]

    @property
    def farthest(self) -> tuple[str, mpf]:
        """The point that moves most, and how far, mm."""
        return max(self.movement.items(), key=lambda item: item[1])


def closed_drawing(
    points: Points,
    up: Sequence[object] = (0, 0, 1),
    right: Sequence[object] = (0, 1, 0),
    side: str = "left",
    digits: int = 60,
    closure: str = DEFAULT,
    clearness: float = CLEAR_SIGN,
) -> ClosedDrawing:
    """Solve a drawing at its own inputs; every link as long as drawn, the side of each choice as drawn.

    The height of the ball joint over point 1 and the rack's travel are taken from the drawing as they
    are, without the way through theta. A drawing that closes comes back within the radius.

    Args:
        points: as for `solve_reference`, mm; also up, right, side, digits, closure, clearness.
    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    design = Design.from_points(points, up, right, side, closure)
    table = design.table
    height = dot(minus(table[5], table[1]), design.up)
    travel = dot(minus(table[3], table[9]), design.right)

    def given() -> Known:
        still = design.known(Driven.from_mapping({"arm_angle": (0, 0, 0)}))
        return replace(still, arm_height=_resting(height), rack=_resting(travel))

    choose = partial(candidate, choices=choices_of_table(table, design.up, closure, clearness))
    instant = prove_assembly(design, given, choose, digits)
    with ctx.workprec(bits(instant.digits)):
        # cos and sin from the drawing: an arc cosine loses its digits where the arm stands upright.
        # `up` is a unit vector to rounding only, so the difference may be just below zero.
        beside = max(design.squared_length[5, 1] - height * height, Fraction(0))
        angle = arb.atan2(as_ball(beside).sqrt(), as_ball(height))
        movement = {name: _distance(instant, name, design) for name in design.names}
        return ClosedDrawing(
            instant, centre_of(angle), mpf_from_fraction(travel * design.unit, digits), movement
        )


def _resting(value: Fraction) -> Jet:
    return Jet(as_ball(value), as_ball(0), as_ball(0))


def _distance(instant: Instant, name: str, design: Design) -> mpf:
    drawn = plus(design.origin, times(design.table[design.names[name]], design.unit))
    x, y, z = (as_fraction(number, name) for number in instant.position[name])
    moved = minus((x, y, z), drawn)
    return centre_of(as_ball(dot(moved, moved)).sqrt())
