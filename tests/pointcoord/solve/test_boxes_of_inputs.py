"""Boxes of inputs are of the degree, the width and the fineness that their series ask for."""

from dataclasses import replace

import numpy as np
import pytest
from swinging_designs import both, by_boxes, designs, in_time, spread, swinging

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import chain_settings
from pointcoord.solve import designs_by_inputs
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.designs_by_inputs import Way, rest_of_series
from pointcoord.solve.paths_together import columns_of
from pointcoord.solve.taylor import last_and_fall


@pytest.mark.parametrize("fall", [1e-6, 0.01, 0.3, 0.9])
@pytest.mark.parametrize("degree", [8, 15, 30])
def test_the_rest_of_a_series_is_no_less_than_its_last_two_terms_nor_than_all_beyond(
    fall: float, degree: int
) -> None:
    k, speed, acceleration = np.arange(2000.0), 3.0, 0.5
    sizes = fall ** np.maximum(k - degree, -2.0)
    place, slope, bend = sizes, k * sizes, k * (k - 1.0) * sizes
    terms = np.stack([place, speed * slope, speed**2 * bend + acceleration * slope])
    last, beyond = terms[:, degree - 1 : degree + 1].sum(axis=-1), terms[:, degree + 1 :].sum(axis=-1)
    found = rest_of_series(np.array(1.0), np.array(fall), degree, speed, acceleration)
    # Of the rate of a rate the larger of each part counts.
    assert (found >= np.maximum(last, beyond) * (1.0 - 1e-12)).all()
    assert (found <= (last + beyond) * (1.0 + 1e-12)).all()


@pytest.mark.parametrize(
    ("speed", "acceleration"),
    # What is largest of the second rate: that of the input's acceleration, or of the square of its speed.
    [(1e-3, 1e-4), (1e-3, 5.0), (30.0, 1e-3), (30.0, 1e6)],
)
def test_last_degrees_are_held_to_the_size_of_each_rate(speed: float, acceleration: float) -> None:
    scene = Scene.load("bounce")
    mechanism = designs(scene, spread(3))
    course, y = course_of(scene, mechanism, speed, acceleration)
    here = course._expanded(y, 8)
    half = np.array([0.3])
    here.carry_on(course.known(np.array([0.8]), half, 8, mechanism), 8)
    n = mechanism.map.unknowns
    first, second = (np.abs(here.alone[0].y[k, :n]).max(axis=0) for k in (1, 2))
    v, a = speed / 0.3, acceleration / 0.3
    size = np.stack([np.ones(3), v * first, np.maximum(a * first, 2.0 * v**2 * second)])
    beyond = rest_of_series(*last_and_fall(here.sizes()), 8, v, a)
    for derivative in range(3):
        needed = (beyond / size)[: derivative + 1].max(axis=0)
        for share, fine in ((1.0 + 1e-9, True), (1.0 - 1e-9, False)):
            for member in range(3):
                settings = replace(course.settings, tolerance=share * needed[member], derivative=derivative)
                assert replace(course, settings=settings)._falls(here, half)[member] == fine


@pytest.mark.parametrize("fall", [0.1, 0.4, 0.6])
def test_the_degree_is_the_least_that_leaves_out_no_more_than_the_tolerance(fall: float) -> None:
    scene = Scene.load("bounce")
    course, _ = course_of(scene, designs(scene, spread(1)), 0.0, 0.0)
    course = replace(course, settings=replace(course.settings, tolerance=1e-9, derivative=0))
    order = course._needed(fall ** np.arange(9.0), (1,))
    left = [float(rest_of_series(np.array(fall**p), np.array(fall), p, 0.0, 0.0)[0]) for p in range(8, 31)]
    least = next((p for p, rest in enumerate(left, 8) if rest <= 1e-9), 31)
    assert order == least


def course_of(
    scene: Scene, mechanism: Mechanism, speed: float, acceleration: float
) -> tuple[designs_by_inputs._Course, np.ndarray]:
    """The boxes of designs of which only the arm moves, and their closed drawings, (size, members)."""
    closed, layout = close_drawing(mechanism).y, mechanism.layout
    driven = [layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    columns = columns_of(mechanism.map, ((layout.zero, 0.0), (layout.one, 1.0)), driven, closed[0])
    assert columns is not None
    drives = tuple(drive for drive in mechanism.topology.drives if drive.input == "arm_angle")
    way = Way(
        ("arm_angle",),
        np.array([[0.5]]),
        np.array([[1.1]]),
        np.array([speed]),
        np.array([acceleration]),
        1.0,
    )
    settings = chain_settings(scene, mechanism, 2)
    course = designs_by_inputs._Course(columns, mechanism, drives, way, settings)
    return course, np.ascontiguousarray(closed.T)


@pytest.mark.parametrize("chunk", [8, 256])
def test_designs_of_a_later_chunk_that_need_a_higher_degree_are_followed_in_time(
    monkeypatch: pytest.MonkeyPatch, chunk: int
) -> None:
    monkeypatch.setattr(designs_by_inputs, "CHUNK", chunk)
    # The last design comes near the end of its range: its terms fall more slowly than those of all others.
    scene = Scene.load("double-wishbone")
    mechanism = designs(scene, {"lower_ball_joint.z": np.array([*np.linspace(-2.0, 2.0, 15), 100.0])})
    solved, plain = both(scene, mechanism)
    np.testing.assert_array_equal(solved.solved, plain.alive)
    assert len(solved.mapped) == 15


@pytest.mark.parametrize("amplitude", [1e-3, 1e-12, 1e-310])
def test_an_input_that_hardly_moves_is_one_of_those_that_move(amplitude: float) -> None:
    scene = swinging("steer")
    rack = {"sine": {"amplitude": amplitude, "angular_frequency": 15.0}}
    scene = scene.model_copy(update={"inputs": {**scene.inputs, "rack": rack}})
    mechanism = designs(scene, spread(9))
    solved, plain = both(scene, mechanism, 0)
    np.testing.assert_array_equal(solved.mapped, np.arange(9))
    difference = np.abs(by_boxes(scene, mechanism, solved) - in_time(scene, mechanism, plain))
    assert (mechanism.unit[:, None, None] * difference).max() <= 2.0 * 0.1 * scene.tolerance
