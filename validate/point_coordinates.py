"""pointcoord as a formulation: by series, by Newton at every instant, and as the paper prints it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, SceneError, SingularConfiguration, simulate
from pointcoord.chain import COARSEST, FINEST
from pointcoord.simulation import TRUNCATION_SHARE, Method
from validate.formulation import Accuracy, FormulationError, Solution

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointCoordinates:
    """pointcoord by one of its methods."""

    name: str
    method: Method

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene; the pose error is pointcoord's proven bound at each instant.

        Raises:
            FormulationError: pointcoord refuses the scene, or cannot bound the error of a pose; but a fault
                of the scene file itself is raised as it is.
        """
        try:
            motion = simulate(scene, self.method)
        except SceneError:
            raise
        except PointcoordError as error:
            raise FormulationError(self.name, error) from error
        proof = motion.proof()
        # Numbers that nothing is known of would agree with anything: they are no answer here.
        unproven = ~np.isfinite(proof.bound + proof.carried_bound)
        if unproven.any():
            first = int(np.argmax(unproven))
            reason = SingularConfiguration(
                "no error bound of the pose can be proven",
                float(proof.condition[first]),
                f"at t = {motion.times[first]:.10g} s",
            )
            raise FormulationError(self.name, reason)
        sizes = (*motion.term_sizes(), 0.0, 0.0, 0.0)
        return Solution(
            formulation=self.name,
            times=motion.times,
            position=motion.position,
            velocity=motion.velocity,
            acceleration=motion.acceleration,
            angular_velocity=motion.angular_velocity,
            angular_acceleration=motion.angular_acceleration,
            wheel=motion.wheel,
            accuracy=Accuracy(
                pose_error=proof.pose_bound,
                stored=np.maximum(proof.bound - proof.pose_bound, 0.0),
                carried_gain=proof.carried_gain,
                proven=True,
                condition=proof.condition,
                velocity_sensitivity=proof.velocity_sensitivity,
                acceleration_sensitivity=proof.acceleration_sensitivity,
                speed_terms=sizes[1],
                acceleration_terms=sizes[2],
                truncation=truncation(scene.tolerance / motion.unit) if self.method == "series" else 0.0,
            ),
            notes=motion.notes,
        )


def truncation(tolerance: float) -> float:
    """Relative truncation of a motion for a tolerance in units of its size, within the chain's limits."""
    return float(np.clip(tolerance, FINEST / TRUNCATION_SHARE, COARSEST / TRUNCATION_SHARE))
