"""What the public strategies draw is what they say: accepted, readable, and the same again."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, find, given, seed, settings
from hypothesis import strategies as st
from mechanism_files import mechanism_file, scene_text

from pointcoord import Scene, simulate
from pointcoord.mechanism.file import MECHANISMS
from validate.cars.base_cars import Variant, variants
from validate.cars.random_cars import is_accepted
from validate.strategies import inputs, mechanisms, near_singular, scenes

FEW = settings(max_examples=3)


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
@given(near_singular("double_wishbone", nearest=1e-8, farthest=1e-6))
def test_a_near_singular_scene_is_next_to_where_an_input_ends(scene: Scene) -> None:
    """At a fold the condition number grows as the inverse root of the distance; elsewhere it is below 100."""
    assert simulate(scene).proof().condition.max() > 0.2 / np.sqrt(1e-6)


@pytest.mark.parametrize(
    "drawn",
    [mechanisms(), scenes(), near_singular("double_wishbone")],
    ids=["mechanisms", "scenes", "near_singular"],
)
def test_nothing_is_drawn_and_thrown_away(drawn: st.SearchStrategy[object]) -> None:
    """Examples that are filtered out, or found invalid, count as draws and are no examples."""
    seen = []

    @seed(1)
    @settings(max_examples=3, phases=[Phase.generate], database=None, suppress_health_check=HealthCheck)
    @given(drawn)
    def collect(example: object) -> None:
        seen.append(example)

    collect()
    assert len(seen) == 3
    again, seen = seen, []
    collect()
    assert [str(example) for example in seen] == [str(example) for example in again]


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
    (tmp_path / "links.toml").write_bytes((MECHANISMS / "five_link.toml").read_bytes())
    own = tmp_path / "own.toml"
    own.write_text(scene_text("five-link").replace('"five_link"', '"links.toml"'), encoding="utf-8")
    # The first example that is generated is the least one: there is nothing to shrink.
    first = settings(max_examples=1, phases=[Phase.generate], database=None)
    found = find(scenes(suspension=str(own)), lambda _: True, settings=first)
    assert found.mechanism.type is None
    assert set(found.mechanism.bodies) == set(mechanism_file("five_link")["bodies"])
    assert "wheel_travel" in found.inputs


@pytest.mark.parametrize("variant", variants(), ids=lambda variant: variant.words)
def test_a_car_whose_points_coincide_is_drawn_back_and_no_error(variant: Variant) -> None:
    base, names = variant.base, variant.input_sets[0]
    assert is_accepted(base, names)
    one, *others = next(iter(base.structure.rods.values()), ()) or base.structure.bodies["chassis"][:2]
    assert not is_accepted(replace(base, points={**base.points, one: base.points[others[0]]}), names)
