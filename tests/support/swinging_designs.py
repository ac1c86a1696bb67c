"""Scenes of which many designs are solved as functions of their inputs, and how they are solved."""

import numpy as np

from pointcoord import Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import SERIES
from pointcoord.simulation import chain_settings, pose_tolerance
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.designs import Follow, SolvedDesigns, solve_designs, solve_plainly
from pointcoord.sweeping.solving import way_of_inputs
from pointcoord.time_functions import TimeFunction

# Laws that go over their ranges many times.
SWINGS = {
    "bounce": {"arm_angle": {"sine": {"amplitude": 0.45, "angular_frequency": 12.0, "offset": 1.3}}},
    "steer": {"rack": {"sine": {"amplitude": 20.0, "angular_frequency": 15.0, "offset": 22.0}}},
    "off-axis-strut": {},
    "double-wishbone": {},
}


def swinging(name: str) -> Scene:
    scene = Scene.load(name)
    return scene.model_copy(update={"inputs": {**scene.inputs, **SWINGS[name]}})


def designs(scene: Scene, offsets: dict[str, np.ndarray]) -> Mechanism:
    points = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    for name, each in offsets.items():
        point, axis = name.split(".")
        points[point] = points[point] + np.outer(each, np.eye(3)["xyz".index(axis)])
    part = scene.mechanism
    return build_mechanism(part.topology, points, {"up": part.up, "right": part.right})


def laws(scene: Scene) -> dict[str, TimeFunction]:
    return {name: scene.functions[name] for name in scene.mechanism.topology.required_inputs}


def both(scene: Scene, mechanism: Mechanism, derivative: int = 2) -> tuple[SolvedDesigns, SolvedDesigns]:
    """By inputs, and plainly in time."""
    functions, time = laws(scene), scene.time
    settings = chain_settings(scene, mechanism, derivative)
    allowed, way = pose_tolerance(scene, SERIES, mechanism), way_of_inputs(scene, functions)
    solved = solve_designs(mechanism, functions, time.start, time.stop, settings, allowed, way)
    follow = Follow(functions, time.start, time.stop, settings, allowed)
    return solved, solve_plainly(mechanism, follow)


def by_boxes(scene: Scene, mechanism: Mechanism, solved: SolvedDesigns) -> np.ndarray:
    """Unknowns at the scene's instants, (designs, N, unknowns)."""
    assert solved.boxes is not None
    series = [laws(scene)[name].series(scene.instants, 0)[..., 0] for name in solved.boxes.names]
    return solved.boxes.at(np.stack(series, axis=-1), mechanism.map.unknowns)


def in_time(scene: Scene, mechanism: Mechanism, solved: SolvedDesigns) -> np.ndarray:
    assert solved.chain is not None
    pieces = [segment.coefficients[..., : mechanism.map.unknowns] for segment in solved.chain.segments]
    return np.asarray(evaluate(solved.chain, pieces, scene.instants, 0)[0])


def spread(many: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(6)
    names = ("lower_ball_joint.z", "tie_rod_outer.x", "wheel_centre.y")
    return {name: rng.uniform(-4.0, 4.0, many) for name in names}
