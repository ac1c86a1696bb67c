"""Where a drawing stands and how far its inputs go, against closed forms and the reference."""

from collections.abc import Callable

import numpy as np
import pytest
from sample_cars import SampleCar, by_drawn_car

from pointcoord import Scene, simulate, standing
from pointcoord.drawing_stands import End
from validate.formulations.reference_solution import design_of
from validate.reference import pose_exists


def test_the_paper_s_arm_reaches_as_far_as_its_dead_points_allow() -> None:
    found = standing(Scene.load("bounce"))
    low, high = (np.rad2deg(end.value) for end in found.reach["arm_angle"])
    # Closed form: the ball joint's circle crosses the vertical plane through the arm's axis (rack at 0).
    assert low == pytest.approx(32.228, abs=1e-3)
    assert high == pytest.approx(152.013, abs=1e-3)
    for end in found.reach["arm_angle"]:
        assert "rise of lower_ball_joint over lower_arm_front" in end.limits


@pytest.mark.parametrize("name", ["slider-crank", "spatial-four-bar", "andrews-squeezer"])
def test_a_crank_that_goes_all_the_way_round_has_no_end(name: str) -> None:
    low, high = standing(Scene.load(name)).reach["crank"]
    assert (low, high) == (End(-np.inf, ()), End(np.inf, ()))


@by_drawn_car
@pytest.mark.parametrize("name", ["arm_angle", "rack"])
def test_an_input_reaches_as_far_as_the_reference_has_an_assembly(
    make_scene: Callable[..., Scene], car: SampleCar, name: str
) -> None:
    scene, inputs = make_scene(car=car), car.drawn_inputs
    low, high = standing(scene).reach[name]
    for end, outwards in ((low, -1.0), (high, 1.0)):
        # Both are right to 1e-12 of the way; doubles round the drawn inputs and the car's numbers.
        near = 1e-9 * (high.value - low.value)
        inside, outside = (
            {n: (v, 0.0, 0.0) for n, v in (inputs | {name: end.value + side * outwards * near}).items()}
            for side in (-1.0, 1.0)
        )
        assert pose_exists(design_of(scene), inside)
        assert not pose_exists(design_of(scene), outside)
        assert end.limits


def test_bricard_s_mechanism_turns_as_far_as_its_neighbouring_hinge() -> None:
    # Of six hinges at right angles two neighbours turn by cos a + cos b + cos a cos b = 0, so that cos a is
    # -1/2 or more: a goes from -120 to 120 degrees. It is 90 as drawn, from where it is counted backwards.
    low, high = standing(Scene.load("bricard")).reach["turn"]
    # A motion stops where rounding could hide the fold: where the determinant, in proportion to the root of
    # the distance from it, is some hundred times the root of EPS.
    assert low.value == pytest.approx(np.deg2rad(-30.0), abs=1e-11)
    assert high.value == pytest.approx(np.deg2rad(210.0), abs=1e-11)


@by_drawn_car
def test_the_drawn_inputs_and_angles_are_those_of_the_motion_there(
    make_scene: Callable[..., Scene], car: SampleCar
) -> None:
    scene = make_scene(car=car)
    found = standing(scene)
    assert found.inputs == pytest.approx(car.drawn_inputs, abs=1e-15)
    inputs = {name: [value] for name, value in found.inputs.items()}
    motion = simulate(make_scene(**inputs, car=car, stop=0.0, samples=1))
    assert found.angles.keys() == motion.wheel.keys()
    for name, angle in found.angles.items():
        assert motion.wheel[name][0] == pytest.approx(angle, abs=1e-13)
    assert found.closing == motion.closing
    p = {name: np.array(place) for name, place in car.points.items()}
    outboard = np.array([0.0, -1.0 if car.side == "left" else 1.0, 0.0])
    spindle = p["wheel_centre"] - p["wheel_axis_inner"]
    assert found.angles["camber"] == pytest.approx(-np.arctan(spindle[2] / (spindle @ outboard)), abs=1e-13)
