"""Where an effect has no number."""

import numpy as np
import pytest
from changed_scenes import content_of, scene_with

from pointcoord import MapError, Scene, SceneError, kinematic_map, simulate

LOAD = {"force": [700.0, -400.0, 3000.0], "moment": [2e4, -1e5, 3e4]}


def test_where_there_is_no_number_a_note_says_why() -> None:
    """A trailing arm that stands straight up moves its wheel level."""
    points = {"a": [0, 400, 0], "b": [0, 600, 0], "inner": [0, 650, -300], "centre": [0, 700, -300]}
    mechanism = {
        "bodies": {"chassis": ["a", "b"], "arm": ["a", "b", "inner", "centre"]},
        "inputs": {"turn": {"angle": "arm", "from": "drawing"}},
        "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
        "side": "right",
        "points": points,
    }
    inputs, time = {"turn": {"polynomial": [0.0, 0.1]}}, {"start": 0.0, "stop": 1.0, "samples": 3}
    content = {"effects": ["toe_by_travel"], "mechanism": mechanism, "inputs": inputs, "time": time}
    motion = simulate(Scene.from_mapping(content))
    assert np.isfinite(motion.angle_gradient["toe_by_travel"]).tolist() == [False, True, True]
    assert any("does not travel" in note for note in motion.notes)


def test_a_mechanism_that_is_held_twice_has_no_forces() -> None:
    content = content_of("bricard")
    plain = Scene.from_mapping(content).mechanism.structure.plain(content["inputs"])
    body = next(body for body in plain["bodies"] if body != "chassis")
    content["mechanism"] |= {key: plain[key] for key in ("bodies", "rods", "slides", "inputs")}
    content["mechanism"] |= {"type": None, "wheel_radius": 300.0, "loads": LOAD}
    content["mechanism"]["roles"] = {"knuckle": body, "wheel_axis": plain["bodies"][body][:2]}
    with pytest.raises(SceneError, match="follow from the others"):
        Scene.from_mapping({**content, "effects": ["loads"]})


def test_a_map_takes_no_loads() -> None:
    scene = scene_with("pushrod", {"loads": LOAD}, effects=["loads"])
    with pytest.raises(MapError, match="without derivatives"):
        kinematic_map(scene, dict.fromkeys(scene.inputs, (-1.0, 1.0)))
