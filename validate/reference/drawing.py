"""The closed drawing: the car solved at the inputs that it is drawn at, and how far that moves its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import ctx
from mpmath import mpf

from validate.reference.design import Design
from validate.reference.effects.registry import ANGLES
from validate.reference.exact import as_ball, as_fraction, bits, centre_of
from validate.reference.instant import Instant, prove_instant
from validate.reference.route import CLEAR, closed
from validate.reference.solve import with_enough_digits
from validate.reference.vectors import dot, minus, plus, times


@dataclass(frozen=True)
class ClosedDrawing:
    """A car at its own drawn inputs.

    Attributes:
        instant: the proven pose, at rest; `instant.radius` bounds the error of its positions.
        inputs: as drawn, by name, rad or mm, without those that move the whole car.
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
    design: Design, digits: int = 60, clearness: float = CLEAR, effects: Sequence[str] = ANGLES
) -> ClosedDrawing:
    """Solve a drawing at its own inputs; every link as long as drawn.

    The inputs are taken from the drawing in the numbers that the equations take (see `drives`), without the
    way through an angle. A drawing that closes comes back within the radius.

    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    here = closed(design, clearness)
    instant = with_enough_digits(
        lambda working: prove_instant(
            design, design.known_as_drawn(), here.pose.unknown, here.pose.holds, digits, working, effects
        ),
        digits,
    )
    with ctx.workprec(bits(instant.digits)):
        drives = design.mechanism.drives
        inputs = {name: centre_of(drive.input_of(drive.drawn())) for name, drive in drives.items()}
        movement = {name: _distance(instant, name, design) for name in design.names}
        return ClosedDrawing(instant, inputs, movement)


def _distance(instant: Instant, name: str, design: Design) -> mpf:
    drawn = plus(design.origin, times(design.table[name], design.unit))
    x, y, z = (as_fraction(number, name) for number in instant.position[name])
    moved = minus((x, y, z), drawn)
    return centre_of(as_ball(dot(moved, moved)).sqrt())
