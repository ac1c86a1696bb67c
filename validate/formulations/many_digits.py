"""The many-digit reference as a formulation, where nothing else can stand beside pointcoord."""

from __future__ import annotations

from pointcoord.scene.scene_file import Scene
from validate.adjudication.reference_solution import reference_solution
from validate.formulations.protocol import FormulationError, Solution
from validate.reference import NoReferenceError


class ManyDigits:
    """Exact equations in balls, solved to 60 digits and rounded to doubles."""

    name = "reference"

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene.

        Raises:
            FormulationError: an instant has no pose, or none can be proven.
        """
        try:
            return reference_solution(scene)
        except NoReferenceError as error:
            raise FormulationError(self.name, error) from error
