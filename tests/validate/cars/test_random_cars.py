"""Random cars are solved as drawn; ends of inputs are ends, and near poses have their distance from them."""

from contextlib import suppress

import numpy as np
import pytest
from cars_in_closed_form import cars_of
from hypothesis import given
from hypothesis import strategies as st
from searched import searched

from pointcoord import PointcoordError, Scene, simulate
from pointcoord.drawing_stands import drawn_inputs as drawn_inputs_of
from pointcoord.linkage.directions import DIRECTIONS
from validate.cars.base_cars import variants
from validate.cars.car import Car, content_of
from validate.cars.input_ends import at, drawn_inputs, end, redrawn
from validate.cars.random_cars import LEFT_OVER, near_pose, random_car, sliding
from validate.cars.random_scenes import KINDS, random_scene
from validate.formulations.reference_solution import design_of
from validate.reference import NoReferenceError, pose_exists

NUMBERS = st.integers(0, 2**32 - 1)
# Share of the range of an input: more than the rounding of the inputs of the redrawn car.
NEAR = 1e-11


@searched(8)
@given(NUMBERS)
def test_a_random_car_is_solved_where_it_is_drawn_and_what_slides_is_drawn_on_its_line(number: int) -> None:
    drawn = random_car(np.random.default_rng(number))
    home = drawn_inputs(drawn.car, drawn.inputs)
    assert set(home) == set(drawn.inputs)
    motion = simulate(Scene.from_mapping(content_of(drawn.car, home)))
    if drawn.car.closure != "drawn":
        return
    # Points drawn off their line are moved onto it, which moves other points too.
    car, p = drawn.car, drawn.car.array
    for name, place in p.items():
        assert np.abs(motion.position[name][0] - place).max() <= 0.05 * car.size, name
    # At most LEFT_OVER off its line.
    far = max(float(np.abs(place).max()) for place in p.values())
    for slide in (one for one in car.structure.slides.values() if one.through in p):
        there = p[slide.through]
        along = car.direction(slide.along) if slide.along in DIRECTIONS else p[slide.along] - there
        for name in set(slide.points) & set(sliding(car)):
            aside = np.cross(p[name] - there, along) / np.linalg.norm(along)
            assert np.linalg.norm(aside) <= np.sqrt(3.0) * LEFT_OVER * drawn.scale + 1e-12 * far, name


@searched(2)
@given(NUMBERS, st.floats(-11.0, -2.0))
def test_a_near_pose_is_as_near_to_its_end_as_is_asked(number: int, decades: float) -> None:
    distance = 10.0**decades
    pose = near_pose(number, nearest=distance, farthest=distance)
    names = pose.home.keys() - pose.variant.chassis_motions
    held = {name: pose.inputs[name] for name in names} | {pose.driven: pose.home[pose.driven]}
    scene = Scene.from_mapping(content_of(pose.car, pose.inputs))
    assert drawn_inputs_of(scene)[pose.driven] == pose.home[pose.driven]
    last = end(pose.car, held, pose.driven, pose.inputs[pose.driven] > pose.home[pose.driven])
    assert last is not None
    assert abs(last.value - pose.inputs[pose.driven]) / last.reach == pytest.approx(distance, rel=1e-2)
    # At a fold it is singular: the condition number grows as the inverse root of the distance.
    try:
        condition = float(simulate(scene).proof().condition.max())
    except PointcoordError:
        assert distance < 1e-9
    else:
        assert condition > 0.05 / np.sqrt(distance)


@searched(2)
@pytest.mark.parametrize(("driven", "sign"), [("arm_angle", -1.0), ("rack", 1.0)])
@given(car=cars_of())
def test_an_end_separates_poses_from_none_to_a_hundred_billionth_of_the_range(
    car: Car, driven: str, sign: float
) -> None:
    """By the reference."""
    home = drawn_inputs(car)
    try:
        last = end(car, home, driven, sign > 0.0)
    except PointcoordError:
        return
    if last is not None:
        design = design_of(at(redrawn(car, home), home))
        ends = (last.value - sign * NEAR * last.reach, last.value + sign * NEAR * last.reach)
        poses = [{n: (v, 0.0, 0.0) for n, v in (home | {driven: value}).items()} for value in ends]
        # A drawing close to another assembly has no reference.
        with suppress(NoReferenceError):
            assert [pose_exists(design, pose) for pose in poses] == [True, False]


def test_a_number_names_one_scene_and_one_pose() -> None:
    scenes, poses = ([make(number) for number in (7, 7, 8)] for make in (random_scene, near_pose))
    assert scenes[0] == scenes[1]
    assert scenes[1].scene != scenes[2].scene
    assert poses[0] == poses[1]
    assert poses[1].car != poses[2].car
    assert near_pose(7, seed=3).car != poses[1].car


def test_random_scenes_are_of_every_mechanism_kind_set_of_inputs_and_law() -> None:
    drawn = [random_scene(number) for number in range(11, 66)]  # the fewest that show all of it
    assert {one.kind for one in drawn} == set(KINDS)
    assert {one.variant for one in drawn} == set(variants())
    assert {one.scene.mechanism.side for one in drawn} == {"left", "right"}
    for variant in variants():
        chassis = set(variant.chassis_motions)
        mine = [frozenset(one.scene.inputs) for one in drawn if one.variant == variant]
        assert {names - chassis for names in mine} <= set(map(frozenset, variant.input_sets))
        assert {bool(names & chassis) for names in mine} == ({True, False} if chassis else {False})
    laws = [law for one in drawn for law in one.scene.inputs.values()]
    given = {key for law in laws for key, value in law.model_dump().items() if value is not None}
    assert given == {"constant", "polynomial", "sine", "table"}
    assert sum(one.scene.mechanism.up == (0.0, 0.0, 1.0) for one in drawn) in range(14, 41)
    sizes = [Car.of(one.scene).size for one in drawn]
    assert min(sizes) < 10.0
    assert max(sizes) > 1e5
