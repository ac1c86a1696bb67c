"""Suspension kinematics by point coordinates: one quadratic map, solved with error bounds.

from pointcoord import Scene, simulate
motion = simulate(Scene.load("bounce"))
motion.position["wheel_centre"]     # (N, 3) mm, at the scene's instants

Names are imported when they are first used. So the program starts before its libraries, and can handle
signals and report errors while they load.
"""

from importlib import import_module

TYPE_CHECKING = False  # as in `typing`, which takes longer to import than all else before signals are handled
if TYPE_CHECKING:
    from pointcoord.drawing_stands import Standing, standing
    from pointcoord.errors import (
        AssemblyError,
        InputNotKnown,
        InputOutOfRange,
        MapError,
        MechanismError,
        MissingLibrary,
        MotionNotMapped,
        MotionTooLong,
        MotionTooRough,
        NotComputed,
        NotCovered,
        NotFollowed,
        OutsideMotion,
        PointcoordError,
        SceneError,
        SingularConfiguration,
        SweepError,
        UnknownName,
        WrongArgument,
    )
    from pointcoord.mapping.kinematic_map import KinematicMap, kinematic_map
    from pointcoord.poses import SolvedPoses, solve_poses
    from pointcoord.results.motion import Motion
    from pointcoord.results.samples import Samples
    from pointcoord.scene.scene_file import Scene, built_in_scenes
    from pointcoord.simulation import simulate
    from pointcoord.sweeping.designs import Designs, designs_of, grid_of
    from pointcoord.sweeping.sensitivity import Sensitivity, sensitivity
    from pointcoord.sweeping.sweep import sweep, sweep_blocks
    from pointcoord.sweeping.swept import Sweep

__all__ = [
    "AssemblyError",
    "Designs",
    "InputNotKnown",
    "InputOutOfRange",
    "KinematicMap",
    "MapError",
    "MechanismError",
    "MissingLibrary",
    "Motion",
    "MotionNotMapped",
    "MotionTooLong",
    "MotionTooRough",
    "NotComputed",
    "NotCovered",
    "NotFollowed",
    "OutsideMotion",
    "PointcoordError",
    "Samples",
    "Scene",
    "SceneError",
    "Sensitivity",
    "SingularConfiguration",
    "SolvedPoses",
    "Standing",
    "Sweep",
    "SweepError",
    "UnknownName",
    "WrongArgument",
    "built_in_scenes",
    "designs_of",
    "grid_of",
    "kinematic_map",
    "sensitivity",
    "simulate",
    "solve_poses",
    "standing",
    "sweep",
    "sweep_blocks",
]

# Modules of the names that are not error classes.
_MODULES = {
    "Designs": "sweeping.designs",
    "KinematicMap": "mapping.kinematic_map",
    "Motion": "results.motion",
    "Samples": "results.samples",
    "Scene": "scene.scene_file",
    "Sensitivity": "sweeping.sensitivity",
    "SolvedPoses": "poses",
    "Standing": "drawing_stands",
    "Sweep": "sweeping.swept",
    "built_in_scenes": "scene.scene_file",
    "designs_of": "sweeping.designs",
    "grid_of": "sweeping.designs",
    "kinematic_map": "mapping.kinematic_map",
    "sensitivity": "sweeping.sensitivity",
    "simulate": "simulation",
    "solve_poses": "poses",
    "standing": "drawing_stands",
    "sweep": "sweeping.sweep",
    "sweep_blocks": "sweeping.sweep",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULES.get(name, 'errors')}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
