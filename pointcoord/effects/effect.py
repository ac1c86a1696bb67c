"""What an effect is: something that a scene may ask for, which knows everything about itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import Way
from pointcoord.linkage.topology import Topology

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers

Array = NDArray[np.float64]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Quantity:
    """A kind of numbers that a motion can report.

    Attributes:
        name: in results and files, such as angular_velocity.
        words: for people, such as angular velocity.
        unit: of what is computed.
        of: what each number belongs to; points, bodies and joints have vectors (N, 3), a
            car has scalars (N,).
        definition: what such a number is, as the page of effects has it; empty if the words say it, or
            if each has its own.
        sign: where it is positive, in words; empty if its effect says it.
    """

    name: str
    words: str
    unit: str
    of: Literal["point", "body", "joint", "car"]
    definition: str = ""
    sign: str = ""


@dataclass(frozen=True, eq=False)
class Doubt:
    """Something that looks wrong with drawings although they can be solved.

    Attributes:
        where: the drawings that it looks wrong in, shape (...,).
        words: what and why, of the drawing at an index of these.
    """

    where: NDArray[np.bool_]
    words: Callable[[tuple[int, ...]], str]


@dataclass(frozen=True, eq=False)
class Poses:
    """Solved poses, from which effects are evaluated.

    Attributes:
        axes: the car's directions.
        states: by time derivative, the states of the points that were asked for, (..., N, 3), mm per s^d, in
            the chassis' frame and from the mechanism's origin; after the turns of the chassis.
        in_chassis: the states before these turns, as far as effects take them; the same where nothing turns.
        added: by time derivative, what reporting adds to every point: the user's origin and what the chassis
            does, (..., N, 3), mm per s^d; None where that is zero.
        slopes: by way, the derivatives of positions along it, after the turns of the chassis and before,
            (N, 3), mm per rad, mm or unit; of the ways that effects take.

    All numbers are floats here; a kind of its own may have them in another arithmetic (see `arithmetic`).
    """

    mechanism: Mechanism
    axes: CarAxes
    states: Sequence[Mapping[str, Any]]
    in_chassis: Sequence[Mapping[str, Any]]
    added: Sequence[Any]
    slopes: Mapping[Way, tuple[Mapping[str, Any], Mapping[str, Any]]] = field(default_factory=dict)

    def constant(self, number: Array) -> Any:
        """What is the same of every car, in the arithmetic of the numbers."""
        return number

    @cached_property
    def drawn(self) -> Mapping[str, Any]:
        """Where every point is drawn, mm from the mechanism's origin."""
        return {name: self.beside(place) for name, place in self.mechanism.drawn_places.items()}

    def beside(self, place: Array) -> Array:
        """Places of a batch of cars, (..., 3), in a shape that broadcasts with those at their instants."""
        more = next(iter(self.states[0].values())).ndim - place.ndim if place.ndim > 1 else 0
        return place.reshape(*place.shape[:-1], *(1,) * more, 3)


@dataclass(frozen=True, eq=False)
class Effect(ABC):
    """Something that a scene may ask for.

    Attributes:
        name: that a scene lists.
        gives: what a user gets, in words, with its unit.
        sign: which way its numbers count.
        derivative: highest time derivative of positions that it is made of.
        quantities: what its numbers are called in results.
    """

    name: str
    gives: str
    sign: str
    derivative: int
    quantities: tuple[Quantity, ...]

    @property
    def own_names(self) -> tuple[str, ...]:
        """The names of what it gives of the car, of one wheel; empty of points and bodies."""
        return ()

    def gives_numbers(self, topology: Topology) -> Mapping[str, tuple[str, ...] | None]:
        """By quantity, the names that it gives of a mechanism; None for every point or every body."""
        return {quantity.name: self.own_names or None for quantity in self.quantities}

    def names(self, topology: Topology) -> tuple[str, ...]:
        """The names of what it gives of the car, of every wheel."""
        numbers = self.gives_numbers(topology)
        return tuple(n for q in self.quantities if q.of == "car" for n in numbers[q.name] or ())

    @property
    def lines(self) -> tuple[str, ...]:
        """The axes of the topology that it is seen on: wheel_axis, steering_axis."""
        return ()

    @property
    def way(self) -> str:
        """Along what it takes derivatives of positions, of each wheel; empty if it takes none."""
        return ""

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        """The ways along which it takes them, of every wheel."""
        return ()

    @property
    def base(self) -> str:
        """The effect whose numbers' derivatives it gives; empty if it has a definition of its own."""
        return ""

    @property
    def reports_states(self) -> bool:
        """Whether its numbers are the states of every point of its derivative, with what reporting adds."""
        return False

    @property
    def no_number(self) -> str:
        """Why a number that it gives may be none, in words; empty if each always is one."""
        return ""

    @abstractmethod
    def needs(self, topology: Topology) -> Collection[str]:
        """The points whose derivatives it is made of."""

    @abstractmethod
    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """Its numbers by quantity and name."""

    @abstractmethod
    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """How far its numbers may be off, proven and expected, each with a leading dimension of 2.

        Args:
            poses: where the points exactly are.
            numbers: everything that was reported, its own among it.
        """

    def refusal(self, topology: Topology, drawn: Mapping[str, Point], axes: CarAxes) -> str:
        """Why a drawing does not have it and what to do, in words; empty if it does."""
        return ""


def lacks(effect: str, needs: str, advice: str) -> str:
    """Why a drawing does not have an effect, by what that needs, and what to do."""
    return f"{effect!r} needs {needs}; {advice}, or leave {effect!r} out"


def no_role(effect: str, role: str, topology: Topology) -> str:
    """Why a mechanism without a role has not an effect that asks for it."""
    needs = f"the role {role}, which the mechanism {topology.name!r} does not have"
    return lacks(effect, needs, "name it under [roles] of the mechanism")


def no_radius(effect: str) -> str:
    """Why a mechanism without a wheel's radius has not an effect that asks for its contact point."""
    needs = "the wheel's contact point, and the mechanism has no wheel_radius"
    return lacks(effect, needs, "give it in mm under [mechanism], such as wheel_radius = 300.0")


def not_one_input(effect: str, which: str, driven: Sequence[str]) -> str:
    """Why an effect is not there that needs one driven input of a kind."""
    needs = f"exactly one driven input {which}, and there is {', '.join(driven) or 'none'}"
    return lacks(effect, needs, "drive one")
