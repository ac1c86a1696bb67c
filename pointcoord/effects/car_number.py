"""Effects that are numbers of the car, each a formula of its points that is written once.

The formula gives the value at places in floats, and where it exactly is at places that are enclosed; so its
error bound needs no derivation of its own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.arithmetic import S
from pointcoord.effects.corner import Corner, View
from pointcoord.effects.effect import Effect, Point, Poses, Quantity, no_role
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.enclosure import Enclosed

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses
    from pointcoord.bounds.proof import Numbers

Array = NDArray[np.float64]

DIMENSION = Quantity("dimension", "dimension", "mm", "car")


class Formula(Protocol):
    """A number of a corner, in whichever arithmetic its points are."""

    def __call__(self, corner: Corner[S]) -> S:
        """The number; lengths in the unit of the points."""
        ...


@dataclass(frozen=True)
class CarNumber(ABC):
    """A number of a car.

    Attributes:
        name: in results and files.
        words: for people.
        sign: where it is positive, in words; empty of what is never negative.
    """

    name: str
    words: str
    sign: str

    @property
    @abstractmethod
    def quantity(self) -> Quantity:
        """The kind of number that it is."""

    @property
    @abstractmethod
    def roles(self) -> tuple[str, ...]:
        """The roles of the mechanism whose points it is made of."""

    @property
    def needs_radius(self) -> bool:
        """Whether it is made of the wheel's radius."""
        return False

    @abstractmethod
    def of(self, corner: Corner[S]) -> S:
        """The number; lengths in the unit of the points."""

    def errors(self, corner: Corner[Enclosed], found: Array, unit: float) -> Array:
        """Proven and expected error of a value that was found, (2, N).

        Args:
            unit: of the corner's lengths, a power of two, mm.
        """
        exact = self.of(corner)
        return (exact.scaled(unit) if self.quantity.unit == "mm" else exact).errors(found)

    def refusal(self, topology: Topology, drawn: Mapping[str, Point]) -> str:
        """Why a drawing that has its roles does not have it, in words; empty if it does."""
        return ""


@dataclass(frozen=True)
class Length(CarNumber):
    """A length, mm.

    Attributes:
        formula: what it is.
        made_of: the roles whose points it is made of.
        with_contact: whether the contact point is one of them.
    """

    formula: Formula
    made_of: tuple[str, ...] = ("wheel_axis",)
    with_contact: bool = True

    @property
    def quantity(self) -> Quantity:
        """A length."""
        return DIMENSION

    @property
    def roles(self) -> tuple[str, ...]:
        """As said."""
        return self.made_of

    @property
    def needs_radius(self) -> bool:
        """Where the contact point is needed."""
        return self.with_contact

    def of(self, corner: Corner[S]) -> S:
        """The formula's."""
        return self.formula(corner)


class NumberOfTheCar(Protocol):
    """What every number of a car says of itself, whatever it is made of; see `CarNumber`."""

    @property
    def name(self) -> str: ...
    @property
    def words(self) -> str: ...
    @property
    def sign(self) -> str: ...
    @property
    def quantity(self) -> Quantity: ...
    @property
    def roles(self) -> tuple[str, ...]: ...
    @property
    def needs_radius(self) -> bool: ...


@dataclass(frozen=True)
class OfTheCar(Effect):
    """Numbers of the car that are made of the points of some roles."""

    numbers: tuple[NumberOfTheCar, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the numbers."""
        return tuple(number.name for number in self.numbers)

    @property
    def lines(self) -> tuple[str, ...]:
        """The axes that they are seen on."""
        return tuple(dict.fromkeys(role for number in self.numbers for role in number.roles))

    def needs(self, topology: Topology) -> Collection[str]:
        """The points of their roles."""
        return {point for role in self.lines for point in topology.role(role)}

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], wheel_radius: float | None) -> str:
        """A role or the wheel's radius is missing."""
        for role in self.lines:
            if not topology.role(role):
                return no_role(self.name, role, topology)
        if wheel_radius is not None or not any(number.needs_radius for number in self.numbers):
            return ""
        return (
            f"{self.name!r} needs the wheel's contact point, and the mechanism has no wheel_radius; "
            f"give it in mm under [mechanism], such as wheel_radius = 300.0, or leave {self.name!r} out"
        )


def signs_of(numbers: Sequence[NumberOfTheCar]) -> str:
    """Where each is positive, in words."""
    return "; ".join(f"{number.words}: positive {number.sign or 'always'}" for number in numbers)


@dataclass(frozen=True)
class CarNumbers(OfTheCar):
    """Some numbers of the car.

    Attributes:
        numbers: what they are.
    """

    numbers: tuple[CarNumber, ...]

    @classmethod
    def of(cls, name: str, gives: str, *numbers: CarNumber) -> CarNumbers:
        """The effect that gives some numbers of one quantity."""
        return cls(
            name, gives, signs_of(numbers), derivative=0, quantities=(numbers[0].quantity,), numbers=numbers
        )

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """Each number, (..., N)."""
        corner = corner_of(poses)
        (quantity,) = self.quantities
        return {quantity.name: {number.name: number.of(corner) for number in self.numbers}}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Of each number by itself."""
        corner, unit = enclosed_corner(poses), float(poses.mechanism.unit)
        (quantity,) = self.quantities
        found = numbers[quantity.name]
        return {quantity.name: {n.name: n.errors(corner, found[n.name], unit) for n in self.numbers}}

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], wheel_radius: float | None) -> str:
        """What it is made of is missing, or a number has no meaning in the drawing."""
        problem = super().refusal(topology, drawn, wheel_radius)
        problems = (number.refusal(topology, drawn) for number in self.numbers if not problem)
        own = next((problem for problem in problems if problem), "")
        return f"{own}, or leave {self.name!r} out" if own else problem


def corner_of(poses: Poses) -> Corner[Array]:
    """The wheel of poses, mm."""
    axes, mechanism = poses.axes, poses.mechanism
    radius = np.array(np.nan if axes.wheel_radius is None else axes.wheel_radius)
    shape = next(iter(poses.states[0].values())).ndim

    def view(points: Mapping[str, Array]) -> View[Array]:
        return View(mechanism.topology, points, axes.component, axes.up, axes.outboard, radius)

    drawn = {name: _beside(place, shape) for name, place in mechanism.drawn_places.items()}
    return Corner(view(poses.states[0]), view(poses.in_chassis), view(drawn), mechanism.origin)


def _beside(place: Array, dimensions: int) -> Array:
    """Drawn places of a batch, (..., 3), in a shape that broadcasts with those at its instants."""
    more = dimensions - place.ndim if place.ndim > 1 else 0
    return place.reshape(*place.shape[:-1], *(1,) * more, 3)


def enclosed_corner(poses: EnclosedPoses) -> Corner[Enclosed]:
    """The wheel of poses where it exactly is, in units."""
    axes, mechanism = poses.axes, poses.mechanism
    up, outboard = Enclosed.of(axes.up), Enclosed.of(axes.outboard)
    radius = Enclosed.of(np.nan if axes.wheel_radius is None else axes.wheel_radius / float(mechanism.unit))

    def view(points: Mapping[str, Enclosed]) -> View[Enclosed]:
        return View(mechanism.topology, points, axes.enclosed, up, outboard, radius)

    vectors = mechanism.drawing.vectors
    drawn = {name: Enclosed.of(vectors[name]) for name in mechanism.topology.points}
    origin = Enclosed.of(mechanism.origin / float(mechanism.unit))
    return Corner(view(poses.points[0]), view(poses.in_chassis), view(drawn), origin)
