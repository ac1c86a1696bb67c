"""The base class of effects, the results that a scene may request, and the data that effects use."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import Way
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array, Flags

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers

ALONG = "components along the user's axes"


@dataclass(frozen=True)
class Quantity:
    """A kind of number that a motion can report.

    Attributes:
        name: in results and files, such as angular_velocity.
        words: for people, such as angular velocity.
        unit: unit of the numbers.
        of: what each number belongs to; points, bodies and joints have vectors (N, 3), a
            car has scalars (N,).
        definition: the definition as in the README; empty if the words are enough, or if each number has
            one of its own.
        sign: where it is positive, in words; empty if each number has a sign of its own.
    """

    name: str
    words: str
    unit: str
    of: Literal["point", "body", "joint", "car"]
    definition: str = ""
    sign: str = ""


@dataclass(frozen=True, eq=False)
class Doubt:
    """A warning about drawings that look wrong although they can be solved.

    Attributes:
        where: whether each drawing looks wrong, shape (...,).
        words: index of a drawing -> the warning, with the reason.
    """

    where: Flags
    words: Callable[[tuple[int, ...]], str]


@dataclass(frozen=True, eq=False)
class Poses:
    """Solved poses, from which effects are evaluated; lengths in mm, from the mechanism's origin.

    All numbers here are floats. `EnclosedPoses` has the same attributes in enclosures, and a subclass may use
    another arithmetic (see `arithmetic`).

    Attributes:
        axes: the car's directions.
        points: by time derivative, point -> state after the rotations of the chassis, (..., N, 3), mm per
            s^d; points that were requested.
        in_chassis: the states in the chassis' frame, as far as effects need them; equal to `points` if
            nothing rotates the chassis.
        slopes: way -> derivatives of positions along it, after the rotations of the chassis and in the
            chassis' frame, (N, 3), mm per rad, mm or unit; for the ways that effects need.
        unit: the unit of lengths, mm.
    """

    mechanism: Mechanism
    axes: CarAxes
    points: Sequence[Mapping[str, Any]]
    in_chassis: Sequence[Mapping[str, Any]]
    slopes: Mapping[Way, tuple[Mapping[str, Any], Mapping[str, Any]]] = field(default_factory=dict)
    unit: ClassVar[float] = 1.0

    def constant(self, number: Array) -> Any:
        """A number that is equal for all cars, in the arithmetic of the poses."""
        return number

    @cached_property
    def drawn(self) -> Mapping[str, Any]:
        """Drawn place of every point."""
        return {name: self._beside(place) for name, place in self.mechanism.drawn_places.items()}

    @property
    def origin(self) -> Any:
        """From the user's origin to the mechanism's origin."""
        return self.constant(self._beside(self.mechanism.origin))

    def _beside(self, place: Array) -> Array:
        """Places of a batch of cars, (..., 3), reshaped to broadcast with places at their instants."""
        more = next(iter(self.points[0].values())).ndim - place.ndim if place.ndim > 1 else 0
        return place.reshape(*place.shape[:-1], *(1,) * more, 3)

    def in_mm(self, number: Any, power: int, derivative: int) -> Any:
        """A number of the unit of length^power and of time^-derivative, in mm and s."""
        return number


@dataclass(frozen=True, eq=False)
class Effect(ABC):
    """An effect: results that a scene may request.

    Attributes:
        name: the name in a scene's list.
        gives: the results in words, with the unit.
        derivative: highest time derivative of positions that it needs.
        quantities: the quantities of its numbers in results.
        own_names: names of its numbers for one wheel; empty for effects of points and bodies.
        lines: the axes that it needs, as roles of the topology: wheel_axis, steering_axis.
        way: kind of way along which it needs derivatives of positions, for each wheel; empty for none.
        base: the effect of whose numbers this one gives the derivatives; empty if it has its own definition.
        reports_states: whether its numbers are the states of every point, including what reporting adds.
        no_number: why a number may be missing, in words; empty if none can be.
    """

    name: str
    gives: str
    derivative: int
    quantities: tuple[Quantity, ...]
    own_names: tuple[str, ...] = ()
    lines: tuple[str, ...] = ()
    way: str = ""
    base: str = ""
    reports_states: bool = False
    no_number: str = ""

    def gives_numbers(self, topology: Topology) -> Mapping[str, tuple[str, ...] | None]:
        """Quantity -> the names that it gives for a mechanism; None for every point or every body."""
        return {quantity.name: self.own_names or None for quantity in self.quantities}

    def names(self, topology: Topology) -> tuple[str, ...]:
        """Names of its numbers of the car, for every wheel."""
        numbers = self.gives_numbers(topology)
        return tuple(n for q in self.quantities if q.of == "car" for n in numbers[q.name] or ())

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        """The ways along which it needs derivatives, for every wheel."""
        return ()

    @abstractmethod
    def needs(self, topology: Topology) -> Collection[str]:
        """The points whose states it needs."""

    @abstractmethod
    def evaluate(self, poses: Poses | EnclosedPoses) -> dict[str, dict[str, Any]]:
        """Its numbers by quantity and name, in the arithmetic of the poses."""

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Error bounds of its numbers, proven and expected, each with a leading dimension of 2.

        Args:
            poses: enclosed exact places and rates of the points.
            numbers: all reported numbers, its own included.
        """
        return {
            quantity: {name: exact.errors(numbers[quantity][name]) for name, exact in of.items()}
            for quantity, of in self.evaluate(poses).items()
        }

    def refusal(self, topology: Topology, axes: CarAxes) -> str:
        """Why a drawing does not have this effect, and what to do, in words; empty if it has."""
        return ""


def lacks(effect: str, needs: str, advice: str) -> str:
    """The message that a drawing does not have an effect, from the need and the advice."""
    return f"{effect!r} needs {needs}; {advice}, or leave {effect!r} out"


def no_role(effect: str, role: str, topology: Topology) -> str:
    """The message that a mechanism lacks a role that an effect needs."""
    needs = f"the role {role}, which the mechanism {topology.name!r} does not have"
    return lacks(effect, needs, "name it under [roles] of the mechanism")


def no_radius(effect: str) -> str:
    """The message that a mechanism lacks the wheel radius that an effect needs."""
    needs = "the wheel's contact point, but the mechanism has no wheel_radius"
    return lacks(effect, needs, "give it under [mechanism], such as wheel_radius = 300.0 in a scene in mm")


def not_one_input(effect: str, which: str, driven: Sequence[str]) -> str:
    """The message that an effect needs exactly one driven input of a kind."""
    needs = f"exactly one driven input {which}, but there is {', '.join(driven) or 'none'}"
    several = (
        "drive one for each wheel; if each moves a wheel of its own, make these wheels parts, and begin each "
        "input's name with its part, such as left.wheel_travel"
    )
    return lacks(effect, needs, several if driven else "drive one")
