"""pointcoord as a formulation: by series, by Newton at every instant, and as the paper prints it."""

from __future__ import annotations

from dataclasses import dataclass

from pointcoord import PointcoordError, Scene, SceneError, simulate
from pointcoord.simulate import Method
from validate.formulation import Accuracy, FormulationError, Solution


@dataclass(frozen=True)
class PointCoordinates:
    """pointcoord by one of its methods."""

    name: str
    method: Method

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene; the pose error is pointcoord's proven bound at each instant.

        Raises:
            FormulationError: pointcoord refuses the scene, but for a fault of the scene file itself,
                which is raised as it is.
        """
        try:
            motion = simulate(scene, self.method)
        except SceneError:
            raise
        except PointcoordError as error:
            raise FormulationError(self.name, error) from error
        proof = motion.proof()
        size = float(motion.unit)
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
                pose_error=proof.bound,
                carried_gain=proof.carried_gain,
                proven=True,
                condition=proof.condition,
                velocity_sensitivity=proof.velocity_sensitivity,
                acceleration_sensitivity=proof.acceleration_sensitivity,
                truncation=scene.tolerance / size if self.method == "series" else 0.0,
            ),
            notes=motion.notes,
        )
