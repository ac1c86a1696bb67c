"""What the public strategies draw is what they say: accepted, readable, and the same again."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, find, given, seed, settings
from hypothesis import strategies as st

from pointcoord import Scene, simulate
from validate.cars.accepted import REACH, is_accepted
from validate.cars.input_limits import DRIVEN, Linkage
from validate.cars.registry import VARIANTS, Variant
from validate.cars.scene_content import car_of
from validate.strategies import inputs, mechanisms, near_singular, scenes

ROOT = Path(__file__).parents[2]
FEW = settings(max_examples=5)


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


@FEW
@given(scenes(samples=4))
def test_a_scene_is_solved_at_every_instant(scene: Scene) -> None:
    motion = simulate(scene)
    assert all(np.isfinite(place).all() and len(place) == 4 for place in motion.position.values())


@FEW
@given(near_singular(nearest=1e-6, farthest=1e-4))
def test_a_near_singular_scene_is_solved_next_to_where_an_input_ends(scene: Scene) -> None:
    motion = simulate(scene)
    assert all(np.isfinite(place).all() for place in motion.position.values())
    assert nearest_end(scene) < 2e-4


def nearest_end(scene: Scene) -> float:
    """How far the nearer input is from an end of it, in parts of its range, by the closed form.

    The ends of an input are looked for with the other one where it is.
    """
    linkage = Linkage.of(car_of(scene))
    at = {name: float(law.polynomial[0]) for name, law in scene.inputs.items()}
    nearest = [1.0]
    for driven in DRIVEN:
        ends = [linkage.end(at, driven, ahead) for ahead in (False, True)]
        found = [end[0] for end in ends if end is not None]
        if len(found) == 2:
            nearest.append(min(abs(end - at[driven]) for end in found) / abs(found[1] - found[0]))
    return min(nearest)


@pytest.mark.parametrize("draw", [mechanisms, scenes, near_singular], ids=lambda draw: draw.__name__)
def test_nothing_is_drawn_and_thrown_away(draw) -> None:
    """Examples that are filtered out, or found invalid, count as draws and are no examples."""
    seen = []

    @seed(1)
    @settings(max_examples=5, phases=[Phase.generate], database=None, suppress_health_check=HealthCheck)
    @given(draw())
    def collect(example: object) -> None:
        seen.append(example)

    collect()
    assert len(seen) == 5
    again, seen = seen, []
    collect()
    assert [str(example) for example in seen] == [str(example) for example in again]


@pytest.mark.parametrize("variant", VARIANTS[2:], ids=lambda variant: variant.words)
def test_the_least_example_is_the_base_car_in_its_own_axes(variant: Variant) -> None:
    """What hypothesis shrinks to: no point is moved, and nothing is turned."""
    kind = mechanisms(variant.suspension, variant.closure)
    least = find(kind, lambda _: True, settings=settings(max_examples=5, database=None))
    assert (least["up"], least["right"], least["side"]) == ([0, 0, 1], [0, 1, 0], variant.base.side)
    moved = {n for n, place in variant.base.points.items() if tuple(least["points"][n]) != place}
    # The rod's end of a strut as drawn is put on its axis in eighths of the way.
    assert moved <= {"strut_rod_end"}


@FEW
@given(mechanisms(turns=False))
def test_places_are_in_millimetres_that_can_be_read(mechanism: dict[str, object]) -> None:
    for name, place in mechanism["points"].items():
        step = 8.0 if name == "strut_rod_end" else 1.0
        assert (step * np.array(place) == np.round(step * np.array(place))).all()
    assert (mechanism["up"], mechanism["right"]) == ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0])


@FEW
@given(mechanisms("macpherson", "drawn", reach=20))
def test_cars_are_of_the_kind_that_is_asked_for(mechanism: dict[str, object]) -> None:
    assert (mechanism["type"], mechanism["closure"]) == ("macpherson", "drawn")
    assert REACH > 20


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: variant.words)
def test_a_car_whose_points_coincide_is_drawn_back_and_no_error(variant: Variant) -> None:
    points = variant.base.points
    assert is_accepted(variant.base)
    for moved, onto in (("lower_ball_joint", "lower_arm_front"), ("lower_arm_rear", "lower_arm_front")):
        assert not is_accepted(replace(variant.base, points={**points, moved: points[onto]}))


def test_a_kind_that_there_is_not_is_told_in_a_line() -> None:
    with pytest.raises(ValueError, match="'multilink' and closure=None; there are: macpherson: drawn"):
        find(mechanisms("multilink"), lambda _: True)


def test_without_hypothesis_the_extra_is_named() -> None:
    program = "import sys; sys.modules['hypothesis'] = None; import validate.strategies"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert "needs the package 'hypothesis', which is not installed" in done.stderr
    assert "pip install 'pointcoord[strategies]'" in done.stderr
