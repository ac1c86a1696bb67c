"""The closed drawing: the car solved at the inputs that it is drawn at, and how far that moves its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import ctx
from mpmath import mpf

from validate.reference.candidates import CLEAR_SIGN, choices_of_table
from validate.reference.design import Design
from validate.reference.exact import as_ball, as_fraction, bits, centre_of
from validate.reference.instant import Instant
from validate.reference.jet import Jet
from validate.reference.linkage import Known
from validate.reference.solve import Points, prove_assembly
from validate.reference.suspensions import CLOSURE, SUSPENSION
from validate.reference.vectors import dot, minus, plus, times


@dataclass(frozen=True)
class ClosedDrawing:
    """A car at its own drawn inputs.

    Attributes:
        instant: the proven pose, at rest; `instant.radius` bounds the error of its positions.
        inputs: as drawn, by name, rad or mm.
        movement: how far each point is from where it is drawn, mm; within sqrt(3) times `instant.radius`.
    """

    instant: Instant
    inputs: Mapping[str, mpf]
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
    closure: str = CLOSURE,
    clearness: float = CLEAR_SIGN,
    suspension: str = SUSPENSION,
) -> ClosedDrawing:
    """Solve a drawing at its own inputs; every link as long as drawn, the side of each choice as drawn.

    The arm's height and the rack's travel are taken from the drawing as they are, without the way through
    theta. A drawing that closes comes back within the radius.

    Args:
        points: as for `solve_reference`, mm; also up, right, side, digits, closure, clearness, suspension.
    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    design = Design.from_points(points, up, right, side, closure, suspension)
    linkage, table = design.linkage, design.table
    drawn = {name: drive.drawn(table, design.up, design.right) for name, drive in linkage.inputs.items()}

    def given() -> Known:
        return design.known_at({name: _resting(x) for name, x in drawn.items()}, _resting(Fraction(0)))

    choices = choices_of_table(table, design.up, linkage, clearness)
    instant = prove_assembly(design, given, lambda known: linkage.candidate(known, choices), digits)
    with ctx.workprec(bits(instant.digits)):
        inputs = {
            name: drive.input_of(drawn[name], design.squared_length, design.unit, digits)
            for name, drive in linkage.inputs.items()
        }
        movement = {name: _distance(instant, name, design) for name in design.names}
        return ClosedDrawing(instant, inputs, movement)


def _resting(value: Fraction) -> Jet:
    return Jet(as_ball(value), as_ball(0), as_ball(0))


def _distance(instant: Instant, name: str, design: Design) -> mpf:
    drawn = plus(design.origin, times(design.table[name], design.unit))
    x, y, z = (as_fraction(number, name) for number in instant.position[name])
    moved = minus((x, y, z), drawn)
    return centre_of(as_ball(dot(moved, moved)).sqrt())
