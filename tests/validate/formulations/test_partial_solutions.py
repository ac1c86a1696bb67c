"""What a formulation solved before it refuses is kept with its claims, and holds against the other one's."""

import numpy as np
import pytest

from pointcoord import Scene
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import formulation


def locking(name: str) -> Scene:
    """A built-in scene whose arm leaves its range before the last instant."""
    scene = Scene.load(name).model_dump(exclude_none=True)
    start = scene["inputs"]["arm_angle"]["sine"]["offset"]
    scene["inputs"] = {"arm_angle": {"polynomial": [start, 0.05, 0.35]}, "rack": {"constant": 0.0}}
    return Scene.from_mapping(scene)


def partial(solver: str, scene: Scene) -> Solution:
    with pytest.raises(FormulationError) as caught:
        formulation(solver).solve(scene)
    assert caught.value.partial is not None
    return caught.value.partial


@pytest.mark.parametrize("name", ["off-axis-strut", "double-wishbone"])
@pytest.mark.parametrize("other", ["absolute", "relative"])
@pytest.mark.parametrize("solver", ["pointcoord", "pointcoord-newton"])
def test_what_both_models_solved_before_a_lock_agrees_within_their_claims(
    name: str, solver: str, other: str
) -> None:
    scene = locking(name)
    one, two = partial(solver, scene), partial(other, scene)
    np.testing.assert_array_equal(one.times, two.times)
    assert 10 < len(one.times) < len(scene.instants)
    # Models that are outside witnesses give no gradients.
    assert {"position", "wheel"} <= two.numbers.keys() <= one.numbers.keys()
    for quantity, arrays in two.numbers.items():
        for point, array in arrays.items():
            claims = (s.accuracy.claims[quantity][point] for s in (one, two))
            assert (np.abs(array - one.numbers[quantity][point]) <= sum(claims)).all(), (quantity, point)
