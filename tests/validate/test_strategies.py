"""What the public strategies draw is what they say."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pointcoord import Scene, simulate
from validate.cars.input_limits import DRIVEN, Linkage
from validate.cars.scene_content import car_of
from validate.strategies import inputs, mechanisms, near_singular, scenes

ROOT = Path(__file__).parents[2]


@settings(max_examples=20)
@given(st.data())
def test_a_mechanism_and_its_inputs_make_the_content_of_a_scene(data: st.DataObject) -> None:
    mechanism = data.draw(mechanisms())
    laws = data.draw(inputs(mechanism))
    time = {"start": 0.0, "stop": 0.1, "samples": 3}
    scene = Scene.from_mapping({"mechanism": mechanism, "inputs": laws, "time": time})
    assert set(scene.inputs) == set(laws)
    # The scene may add a point that has a default.
    assert {n: tuple(p) for n, p in mechanism["points"].items()}.items() <= dict(
        scene.mechanism.points
    ).items()


@settings(max_examples=20)
@given(scenes(solvable=True, samples=4))
def test_a_solvable_scene_is_solved_at_every_instant(scene: Scene) -> None:
    motion = simulate(scene)
    assert all(np.isfinite(place).all() and len(place) == 4 for place in motion.position.values())


@settings(max_examples=20)
@given(near_singular(nearest=1e-6, farthest=1e-4))
def test_a_near_singular_scene_is_solved_next_to_where_an_input_ends(scene: Scene) -> None:
    motion = simulate(scene)
    assert all(np.isfinite(place).all() for place in motion.position.values())
    # The closed form has no pose, or locks, a little further on one of the ways that an input can go.
    linkage = Linkage.of(car_of(scene))
    at = {name: float(law(0.0)) for name, law in laws_of(scene).items()}
    nearest = []
    for driven in DRIVEN:
        ends = [linkage.end(at, driven, ahead) for ahead in (False, True)]
        found = [end[0] for end in ends if end is not None]
        if len(found) == 2:
            nearest.append(min(abs(end - at[driven]) for end in found) / abs(found[1] - found[0]))
    assert min(nearest) < 2e-4


def laws_of(scene: Scene) -> dict[str, np.polynomial.Polynomial]:
    """The polynomials that a near-singular scene's inputs are."""
    return {n: np.polynomial.Polynomial(law.polynomial) for n, law in scene.inputs.items()}


def test_without_hypothesis_the_extra_is_named() -> None:
    program = "import sys; sys.modules['hypothesis'] = None; import validate.strategies"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert "needs the package 'hypothesis', which is not installed" in done.stderr
    assert "pip install 'pointcoord[strategies]'" in done.stderr
