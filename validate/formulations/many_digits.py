"""The many-digit reference as a formulation, for use where no other model is available."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS
from pointcoord.scene.scene_file import Scene
from validate.formulations.input_rates import laws_of
from validate.formulations.protocol import FormulationError, Numbers, Solution
from validate.formulations.reference_solution import reference_solution
from validate.formulations.stated_accuracy import accuracy_at
from validate.reference import NoReferenceError

Array = NDArray[np.float64]


class ManyDigits:
    """Exact equations in ball arithmetic, solved to 60 digits and rounded to doubles.

    The error bounds are those of the rounding. The usual error of a method in doubles (`Accuracy.usual`) is
    the error of a solver whose points are accurate to EPS times the car's size.
    """

    name = "reference"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene.

        Raises:
            FormulationError: an instant has no pose, or no pose can be proven.
        """
        try:
            found = reference_solution(scene)
        except NoReferenceError as error:
            raise FormulationError(self.name, error) from error
        places = found.numbers["position"]
        off = EPS * float(np.ptp([place[0] for place in places.values()], axis=0).max())
        rounded = accuracy_at(scene, off, places, laws_of(scene, scene.instants), solves_rates=True)
        return replace(found, accuracy=replace(found.accuracy, usual=_largest(rounded.claims)))


def _largest(claims: Numbers) -> dict[str, Array]:
    """The largest error bound of each quantity at each instant, (N,)."""
    return {
        quantity: np.max([one.reshape(len(one), -1).max(axis=-1) for one in of.values()], axis=0)
        for quantity, of in claims.items()
        if of
    }
