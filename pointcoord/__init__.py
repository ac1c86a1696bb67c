"""Suspension kinematics by point coordinates: one quadratic map, solved with error bounds.

from pointcoord import Scene, simulate
motion = simulate(Scene.load("bounce"))
motion.position["wheel_centre"]     # (N, 3) mm, at the scene's instants
"""

from pointcoord.errors import (
    AssemblyError,
    InputOutOfRange,
    MechanismError,
    MotionTooLong,
    MotionTooRough,
    NotComputed,
    OutsideMotion,
    PointcoordError,
    SceneError,
    SingularConfiguration,
    UnknownName,
)
from pointcoord.motion import Motion, Samples
from pointcoord.scene import Scene, built_in_scenes
from pointcoord.simulate import simulate
from pointcoord.standing import Standing, standing

__all__ = [
    "AssemblyError",
    "InputOutOfRange",
    "MechanismError",
    "Motion",
    "MotionTooLong",
    "MotionTooRough",
    "NotComputed",
    "OutsideMotion",
    "PointcoordError",
    "Samples",
    "Scene",
    "SceneError",
    "SingularConfiguration",
    "Standing",
    "UnknownName",
    "built_in_scenes",
    "simulate",
    "standing",
]
