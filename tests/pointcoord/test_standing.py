"""Where a drawing stands and how far its inputs go, against closed forms and the reference."""

from collections.abc import Callable

import numpy as np
import pytest
from sample_cars import by_drawn_car
from three_mechanics import scene_of

from pointcoord import Scene, simulate, standing
from validate.formulations.reference_solution import design_of
from validate.reference import pose_exists

CLOSED = {
    # The ball joint's circle crosses the vertical plane through the arm's axis (rack at 0).
    ("bounce", "arm_angle"): (32.228, 152.013, 1e-3),
    # Of six hinges at right angles two neighbours turn by cos a + cos b + cos a cos b = 0, so that cos a is
    # -1/2 or more: a goes from -120 to 120 degrees. It is 90 as drawn, from where it is counted backwards.
    # A motion stops where rounding could hide the fold: where the determinant, in proportion to the root of
    # the distance from it, is some hundred times the root of EPS.
    ("bricard", "turn"): (-30.0, 210.0, 1e-9),
    # A crank that goes all the way round.
    ("slider-crank", "crank"): (-np.inf, np.inf, 0.0),
    ("spatial-four-bar", "crank"): (-np.inf, np.inf, 0.0),
    ("andrews-squeezer", "crank"): (-np.inf, np.inf, 0.0),
}


@pytest.mark.parametrize(("name", "input"), CLOSED)
def test_an_input_reaches_as_far_as_a_closed_form_says(name: str, input: str) -> None:
    low, high, within = CLOSED[name, input]
    ends = standing(Scene.load(name)).reach[input]
    assert [np.rad2deg(end.value) for end in ends] == pytest.approx([low, high], abs=within)
    for end in ends:
        assert bool(end.limits) == np.isfinite(end.value)
        arm = {f"link lower_ball_joint - lower_arm_{end}" for end in ("front", "rear")}
        assert name != "bounce" or {*end.limits} == arm


def test_the_rod_that_comes_into_line_stops_a_wide_link() -> None:
    # A centre link of 600 mm hangs on a stub of 25 mm. The rod pulls the knuckle's arm into line with itself.
    # Forces in the stub are far larger than in the rod, but only rod and arm cannot go on.
    bodies = {
        "chassis": ["pitman_low", "pitman_high", "idler_low", "idler_high", "king_low", "king_high"],
        "pitman": ["pitman_low", "pitman_high", "pitman_ball"],
        "idler": ["idler_low", "idler_high", "idler_ball", "idler_tip"],
        "centre_link": ["pitman_ball", "idler_ball", "idler_tip", "tie_inner"],
        "knuckle": ["king_low", "king_high", "tie_outer"],
    }
    points = {
        "pitman_low": [0, -300, 300],
        "pitman_high": [0, -300, 400],
        "pitman_ball": [150, -300, 300],
        "idler_low": [0, 300, 300],
        "idler_high": [0, 300, 400],
        "idler_ball": [150, 300, 300],
        "idler_tip": [150, 300, 325],
        "tie_inner": [150, 250, 300],
        "king_low": [0, 600, 300],
        "king_high": [0, 600, 400],
        "tie_outer": [150, 550, 300],
    }
    mechanism = {
        "bodies": bodies,
        "rods": {"tie": ["tie_inner", "tie_outer"]},
        "inputs": {"pitman": {"angle": "pitman", "from": "drawing"}},
        "points": points,
    }
    low = standing(scene_of(mechanism, [], pitman=0.0)).reach["pitman"][0]
    inner = np.array([150.0 * np.cos(low.value), 250.0 + 150.0 * np.sin(low.value)])
    # In plan: the rod of 300 mm and the arm of the knuckle in one line.
    assert np.hypot(*(inner - [0.0, 600.0])) == pytest.approx(300.0 + np.hypot(150.0, 50.0), abs=1e-9)
    assert {*low.limits} == {"link tie_inner - tie_outer", "link tie_outer - king_low"}


def drawn_inputs(scene: Scene) -> dict[str, float]:
    """The inputs at which a car is drawn, from its points: arm angle, rad, and rack, mm."""
    p = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    arm = p["lower_ball_joint"] - p["lower_arm_front"]
    centre = p.get("rack_centre", p["tie_rod_inner"])
    return {
        "arm_angle": float(np.arccos(arm[2] / np.linalg.norm(arm))),
        "rack": float(centre[1] - p["tie_rod_inner"][1]),
    }


@by_drawn_car
@pytest.mark.parametrize("name", ["arm_angle", "rack"])
def test_an_input_reaches_as_far_as_the_reference_has_an_assembly(
    make_scene: Callable[..., Scene], car: str, name: str
) -> None:
    scene = make_scene(car=car)
    inputs = drawn_inputs(scene)
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


@by_drawn_car
def test_the_drawn_inputs_and_angles_are_those_of_the_motion_there(
    make_scene: Callable[..., Scene], car: str
) -> None:
    scene = make_scene(car=car)
    found = standing(scene)
    assert found.inputs == pytest.approx(drawn_inputs(scene), abs=1e-15)
    inputs = {name: [value] for name, value in found.inputs.items()}
    motion = simulate(make_scene(**inputs, car=car, stop=0.0, samples=1))
    assert found.angles.keys() == motion.wheel.keys()
    for name, angle in found.angles.items():
        assert motion.wheel[name][0] == pytest.approx(angle, abs=1e-13)
    assert found.closing == motion.closing
    p = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    outboard = np.array([0.0, -1.0 if scene.mechanism.side == "left" else 1.0, 0.0])
    spindle = p["wheel_centre"] - p["wheel_axis_inner"]
    assert found.angles["camber"] == pytest.approx(-np.arctan(spindle[2] / (spindle @ outboard)), abs=1e-13)
