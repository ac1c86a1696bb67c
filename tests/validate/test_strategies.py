"""What the public strategies draw is what they say: accepted, readable, and the same again."""

import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, find, given, seed, settings
from hypothesis import strategies as st

from pointcoord import PointcoordError, Scene, simulate
from pointcoord.mechanism.file import MECHANISMS
from validate.cars.base_cars import Variant, variants
from validate.cars.car import Car
from validate.cars.input_ends import drawn_inputs, end
from validate.cars.random_cars import is_accepted
from validate.strategies import inputs, mechanisms, near_singular, scenes

ROOT = Path(__file__).parents[2]
FEW = settings(max_examples=5)
# The first example that is generated is the least one: there is nothing to shrink.
FIRST = settings(max_examples=1, phases=[Phase.generate], database=None)


@FEW
@given(st.data())
def test_a_mechanism_and_its_inputs_make_a_scene_that_is_solved(data: st.DataObject) -> None:
    mechanism = data.draw(mechanisms())
    laws = data.draw(inputs(mechanism, stop=0.25))
    time = {"start": 0.0, "stop": 0.25, "samples": 3}
    scene = Scene.from_mapping({"mechanism": mechanism, "inputs": laws, "time": time})
    assert set(scene.inputs) == set(laws)
    motion = simulate(scene)
    assert all(np.isfinite(place).all() for place in motion.position.values())


@settings(max_examples=2)
@given(near_singular("double_wishbone", nearest=1e-6, farthest=1e-4))
def test_a_near_singular_scene_is_next_to_where_an_input_ends(scene: Scene) -> None:
    assert any(away < 2e-4 for away in away_from_ends(scene))


def away_from_ends(scene: Scene) -> Iterator[float]:
    """How far each input is from each end of it, in parts of its range, the others where they are."""
    car, known = Car.of(scene), scene.mechanism.structure.inputs
    at = {name: law.polynomial[0] for name, law in scene.inputs.items() if not known[name].moves_the_chassis}
    for driven, value in at.items():
        held = at | {driven: drawn_inputs(car, tuple(at))[driven]}
        for ahead in (False, True):
            try:
                last = end(car, held, driven, ahead)
            except PointcoordError:
                continue
            if last is not None:
                yield abs(last.value - value) / last.reach


@pytest.mark.parametrize(
    "drawn",
    [mechanisms(), scenes(), near_singular("double_wishbone")],
    ids=["mechanisms", "scenes", "near_singular"],
)
def test_nothing_is_drawn_and_thrown_away(drawn: st.SearchStrategy[object]) -> None:
    """Examples that are filtered out, or found invalid, count as draws and are no examples."""
    seen = []

    @seed(1)
    @settings(max_examples=5, phases=[Phase.generate], database=None, suppress_health_check=HealthCheck)
    @given(drawn)
    def collect(example: object) -> None:
        seen.append(example)

    collect()
    assert len(seen) == 5
    again, seen = seen, []
    collect()
    assert [str(example) for example in seen] == [str(example) for example in again]


by_variant = pytest.mark.parametrize("variant", variants(), ids=lambda variant: variant.words)


@FEW
@given(mechanisms("macpherson", "drawn", reach=20))
def test_cars_are_of_the_kind_that_is_asked_for(mechanism: dict[str, object]) -> None:
    assert (mechanism["type"], mechanism["closure"]) == ("macpherson", "drawn")
    (variant,) = (one for one in variants() if (one.suspension, one.closure) == ("macpherson", "drawn"))
    for name, place in mechanism["points"].items():
        if name in ("strut_top", "lower_arm_front"):
            turned = np.sort(np.abs(place)) - np.sort(np.abs(variant.base.points[name]))
            assert np.abs(turned).max() <= 20.0


def test_a_scene_file_of_ones_own_is_a_base_car(tmp_path: Path) -> None:
    """Its mechanism is a file beside it."""
    tables = tomllib.loads((MECHANISMS / "five_link.toml").read_text(encoding="utf-8"))
    part = Scene.load("five-link").mechanism
    (tmp_path / "links.toml").write_bytes((MECHANISMS / "five_link.toml").read_bytes())
    points = "\n".join(f"{name} = {list(place)}" for name, place in part.points.items())
    own = tmp_path / "own.toml"
    own.write_text(
        f'effects = []\ntolerance = 1e-9\n[mechanism]\ntype = "links.toml"\nside = "{part.side}"\n'
        f"[mechanism.points]\n{points}\n[inputs]\nwheel_travel = {{ constant = 0.0 }}\n"
        "[time]\nstart = 0.0\nstop = 0.0\nsamples = 1\n",
        encoding="utf-8",
    )
    found = find(scenes(suspension=str(own)), lambda _: True, settings=FIRST)
    assert found.mechanism.type is None
    assert set(found.mechanism.bodies) == set(tables["bodies"])
    assert "wheel_travel" in found.inputs


@by_variant
def test_a_car_whose_points_coincide_is_drawn_back_and_no_error(variant: Variant) -> None:
    base, names = variant.base, variant.input_sets[0]
    assert is_accepted(base, names)
    one, *others = next(iter(base.structure.rods.values()), ()) or base.structure.bodies["chassis"][:2]
    assert not is_accepted(replace(base, points={**base.points, one: base.points[others[0]]}), names)


def test_without_hypothesis_the_extra_is_named() -> None:
    program = "import sys; sys.modules['hypothesis'] = None; import validate.strategies"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert "needs the package 'hypothesis', which is not installed" in done.stderr
    assert "pip install 'pointcoord[strategies]'" in done.stderr
