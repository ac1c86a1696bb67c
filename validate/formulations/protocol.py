"""What a formulation is to a comparison: a name, and a way from a scene to plain arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.scene.scene_file import Scene

Array = NDArray[np.float64]


NUMBERS_OF = {
    "position": 3,
    "velocity": 3,
    "acceleration": 3,
    "angular_velocity": 3,
    "angular_acceleration": 3,
    "wheel": 1,
}
"""The quantities of a solution, and how many numbers each has at an instant."""


class AccuracyError(ValueError):
    """What a formulation claims of its accuracy is no bound of an error."""

    def __init__(self, claim: str, problem: str, allowed: str) -> None:
        self.claim = claim
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"the accuracy of {claim} {problem}; allowed: {allowed}")


@dataclass(frozen=True)
class Accuracy:
    """What a formulation says of its own accuracy: how far each of its numbers may be off, at most.

    A comparison holds two formulations to the sum of what they claim (see `tolerance`), so a claim must hold
    for whatever the formulation rounds and leaves out, and a formulation that claims too much is found out
    by the other: what its method should reach counts, not how far off its numbers happen to be.

    Attributes:
        condition: condition number of the matrix that gives the rates, shape (N,).
        position, velocity, acceleration: by point, (N, 3), mm and s.
        angular_velocity, angular_acceleration: by body, (N, 3), rad/s and rad/s^2.
        wheel: by angle, (N,), rad.
        proven: whether the claims are proven bounds or estimates.
    Raises:
        AccuracyError: a claim is not a finite number from 0 up, or has not the shape of its numbers.
    """

    condition: Array
    position: Mapping[str, Array] = field(default_factory=dict)
    velocity: Mapping[str, Array] = field(default_factory=dict)
    acceleration: Mapping[str, Array] = field(default_factory=dict)
    angular_velocity: Mapping[str, Array] = field(default_factory=dict)
    angular_acceleration: Mapping[str, Array] = field(default_factory=dict)
    wheel: Mapping[str, Array] = field(default_factory=dict)
    proven: bool = False

    def __post_init__(self) -> None:
        if np.ndim(self.condition) != 1:
            raise AccuracyError("condition", f"has the shape {np.shape(self.condition)}", "one per instant")
        count = len(self.condition)
        _check_claim("condition", self.condition, (count,))
        for quantity, width in NUMBERS_OF.items():
            for name, claim in getattr(self, quantity).items():
                shape = (count, width) if width > 1 else (count,)
                _check_claim(f"{quantity} of {name}", claim, shape)


def _check_claim(what: str, claim: Array, shape: tuple[int, ...]) -> None:
    array = np.asarray(claim)
    if array.dtype.kind != "f":
        raise AccuracyError(what, f"is of type {array.dtype}", "floating point numbers")
    if array.shape != shape:
        raise AccuracyError(what, f"has the shape {array.shape}", f"{shape}, as many as instants")
    wrong = ~(np.isfinite(array) & (array >= 0.0))
    if wrong.any():
        where = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise AccuracyError(
            what, f"is {array[where]:.6g} at instant number {where[0]}", "finite numbers from 0 up"
        )


@dataclass(frozen=True, repr=False)
class Solution:
    """A solved scene as plain arrays; empty mappings where the scene did not ask.

    Attributes:
        times: shape (N,), s.
        position, velocity, acceleration: by point, (N, 3), mm and s.
        angular_velocity, angular_acceleration: by body, (N, 3), rad and s, world axes.
        wheel: `camber` and `kingpin`, (N,), rad.
        notes: what the formulation itself says of numbers that have no meaning.
    """

    formulation: str
    times: Array
    position: Mapping[str, Array]
    velocity: Mapping[str, Array]
    acceleration: Mapping[str, Array]
    angular_velocity: Mapping[str, Array]
    angular_acceleration: Mapping[str, Array]
    wheel: Mapping[str, Array]
    accuracy: Accuracy
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        given = ", ".join(quantity for quantity in NUMBERS_OF if getattr(self, quantity))
        return f"<Solution of {self.formulation}: {np.size(self.times)} instants; {given}>"


class Formulation(Protocol):
    """A way to solve a scene. Adding one is writing one class with these two members."""

    @property
    def name(self) -> str:
        """Name on the command line and in reports."""
        ...

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: the scene cannot be solved; carries the formulation's own error.
        """
        ...


class FormulationError(Exception):
    """A formulation refused a scene, with its own reason as the cause."""

    def __init__(self, formulation: str, reason: Exception) -> None:
        self.formulation = formulation
        self.reason = reason
        super().__init__(f"{formulation}: {reason}")
