"""What cannot move is no mechanism: a scene that drives nothing is refused in words."""

import pytest

from pointcoord import Scene, SceneError


def test_a_tripod_of_rods_is_refused_as_a_structure() -> None:
    content = {
        "mechanism": {
            "bodies": {"chassis": ["a", "b", "c"]},
            "rods": {"r1": ["a", "p"], "r2": ["b", "p"], "r3": ["c", "p"]},
            "points": {"a": [0, 0, 0], "b": [300, 0, 0], "c": [0, 300, 10], "p": [100, 100, 300]},
        },
        "inputs": {},
        "time": {"start": 0.0, "stop": 1.0, "samples": 3},
    }
    with pytest.raises(SceneError, match="structure that nothing moves"):
        Scene.from_mapping(content)
