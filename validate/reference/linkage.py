r"""The contract: all that the many-digit solver wants to know of a linkage.

A linkage is its equations C(y) = 0 for some unknowns y, each at most quadratic; the closed forms of its
assemblies, which only propose; and the names of its parts. Points go by name and lie in local coordinates
(see `design`). One text of the equations serves every kind of number: balls, duals, jets, fractions, floats.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb

from validate.reference.drives import Drive
from validate.reference.errors import InfeasibleError, NotDecidedError
from validate.reference.vectors import Scalar, Vector

Link = tuple[str, str]
# Per choice of a drawing the number whose sign it is, and the square of its scale.
Sides = dict[str, tuple[Scalar, Scalar]]


@dataclass(frozen=True)
class Choices:
    """The yes-or-no choices that name an assembly: fields that are +1 or -1, given by each suspension.

    A motion can change a choice only through a singular pose, where its two answers meet, so an assembly
    keeps its signs along every regular motion. That is how "the same assembly as the design" is meant here,
    and why no path has to be followed.
    """


@dataclass(frozen=True)
class Candidate:
    """One combination of choices, worked out with balls in local coordinates.

    Attributes:
        choices: the combination.
        points: all; where a closure cannot be met, the flat position that comes nearest.
        gaps: per closure, how far the link is too short: proven feasible if the ball is negative.
    """

    choices: Choices
    points: Mapping[str, Vector]
    gaps: Mapping[str, arb]

    def require_feasible(self, unit: float) -> None:
        """Pass if every closure is proven to be met.

        Raises:
            InfeasibleError: one is proven not to be; the gap is given in mm, from `unit` in mm.
            NotDecidedError: neither is proven with the present digits.
        """
        for closure, gap in self.gaps.items():
            if gap > 0:
                raise InfeasibleError(closure, float(gap.mid()) * unit)
            if not gap < 0:
                raise NotDecidedError(f"the {closure} closure, how far its link is short", gap, "< 0")


@dataclass(frozen=True)
class Known:
    """What the equations take as given at one instant; scalars may be balls, fractions, floats or jets.

    Attributes:
        linkage: whose equations hold.
        chassis: its points on the chassis.
        up: direction of z, a constant.
        right: direction of y, a constant.
        squared_length: of every link.
        driven: the number of each input that the equations take, see `Drive`.
        knuckle: its shape, in the numbers that the equations use.
    """

    linkage: Linkage
    chassis: Mapping[str, Vector]
    up: Vector
    right: Vector
    squared_length: Mapping[Link, Scalar]
    driven: Mapping[str, Scalar]
    knuckle: Mapping[str, Vector]


@dataclass(frozen=True)
class Linkage:
    """A suspension under one closure.

    Attributes:
        points: names of all hardpoints.
        stand_ins: a point that may be left out, and the point that it is then drawn in the place of.
        left_out: points that a car may do without, and then has not.
        chassis: points that move with the chassis only.
        joints: points that the equations place; all others are carried by the knuckle.
        inputs: by name, what drives the linkage besides heave.
        links: pairs of points whose drawn distance the equations need.
        steering_axis: its lower and its upper point.
        wheel_axis: where the wheel's spin axis starts, the first of these that the car has, and the wheel
            centre.
        arms: three points of each body that turns besides the knuckle.
        size: unknowns, and equations.
        coordinates: so many unknowns, the first, are coordinates of points; the others follow from points.
        shape: what the equations need of the knuckle as drawn, exact; `BadInputError` if it is none.
        residual: C(y).
        jacobian: dC/dy as (row, column, entry), zeros left out.
        points_of: all points of y.
        unknown_of: y of assembled points.
        implied: the unknowns that are no coordinates, of assembled points.
        knuckle_frame: two vectors that are fixed in the knuckle and not parallel.
        handedness: of y, positive for an assembly, negative for a zero that mirrors the knuckle.
        choices: makes `Choices` from signs by name.
        drawn_sides: of the points as drawn, which need not be assembled, and `up`.
        posed_sides: of an assembly.
        combinations: the choices that an assembly can have.
        candidate: the closed form of one combination.
    """

    points: tuple[str, ...]
    stand_ins: Mapping[str, str]
    left_out: tuple[str, ...]
    chassis: tuple[str, ...]
    joints: tuple[str, ...]
    inputs: Mapping[str, Drive]
    links: tuple[Link, ...]
    steering_axis: tuple[str, str]
    wheel_axis: tuple[tuple[str, ...], str]
    arms: Mapping[str, tuple[str, str, str]]
    size: int
    coordinates: int
    shape: Callable[[Mapping[str, Vector]], dict[str, Vector]]
    residual: Callable[[Sequence[Scalar], Known], list[Scalar]]
    jacobian: Callable[[Sequence[Scalar], Known], list[tuple[int, int, Scalar]]]
    points_of: Callable[[Sequence[Scalar], Known], dict[str, Vector]]
    unknown_of: Callable[[Mapping[str, Vector], Known], list[Scalar]]
    implied: Callable[[Mapping[str, Vector], Known], list[Scalar]]
    knuckle_frame: Callable[[Sequence[Scalar], Known], tuple[Vector, Vector]]
    handedness: Callable[[Sequence[Scalar]], Scalar]
    choices: Callable[..., Choices]
    drawn_sides: Callable[[Mapping[str, Vector], Vector], Sides]
    posed_sides: Callable[[Mapping[str, Vector], Known], Sides]
    combinations: Callable[[Known], Iterator[Choices]]
    candidate: Callable[[Known, Any], Candidate]  # of its own `Choices`

    @property
    def required(self) -> tuple[str, ...]:
        """The points that every car must give."""
        return tuple(n for n in self.points if n not in self.stand_ins and n not in self.left_out)
