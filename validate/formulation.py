"""What a formulation is to a comparison: a name, and a way from a scene to plain arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Accuracy:
    """What a formulation says of its own accuracy; `tolerance` makes tolerances of it.

    Attributes:
        pose_error: error of each coordinate of each point in the frame where it is solved, at most, (N,), mm.
        carried_gain: how many times as large it is for a point that rides on a body, shape (N,).
        proven: whether `pose_error` is a proven bound or an estimate.
        condition: condition number of the matrix that gives the rates, shape (N,).
        velocity_sensitivity: change of a velocity per displacement of the pose, shape (N,), 1/s.
        acceleration_sensitivity: the same of an acceleration, shape (N,), 1/s^2. Both are zero if the
            formulation does not know them.
        truncation: relative error of the rates that the method leaves on purpose.
        speed_terms, acceleration_terms: largest sum of magnitudes of the terms that a velocity or an
            acceleration of the motion was summed from, mm/s and mm/s^2; zero if it was not summed.
        stored: what a reported coordinate is rounded besides, shape (N,), mm: far from the origin, say. No
            rate sees it.
    """

    pose_error: Array
    carried_gain: Array
    proven: bool
    condition: Array
    velocity_sensitivity: Array
    acceleration_sensitivity: Array
    truncation: float = 0.0
    speed_terms: float = 0.0
    acceleration_terms: float = 0.0
    stored: Array | float = 0.0


@dataclass(frozen=True)
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
