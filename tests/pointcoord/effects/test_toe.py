"""Toe of a wheel that is turned by hand, and of a car that is steered."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pointcoord import Scene, simulate
from pointcoord.effects.toe import TOE
from pointcoord.linkage.car_axes import CarAxes

EPS = np.finfo(float).eps
UP, RIGHTWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])  # x rearward
(ANGLE,) = TOE.numbers


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["left wheel", "right wheel"])
@pytest.mark.parametrize("degrees", [-40.0, -2.0, 0.0, 0.1, 3.0, 40.0])
@pytest.mark.parametrize("camber", [-8.0, 0.0, 5.0])
def test_toe_is_positive_where_the_front_edge_is_nearer_the_middle(
    side: float, degrees: float, camber: float
) -> None:
    outboard = side * RIGHTWARD
    centre = np.array([100.0, 700.0 * side, 300.0])
    # Leaned about the car's long axis first, then turned about the vertical, which is what toe sees.
    lean = Rotation.from_euler("x", -side * camber, degrees=True)
    turn = Rotation.from_euler("z", side * degrees, degrees=True)
    axle, forward = turn.apply(lean.apply(outboard)), turn.apply([-1.0, 0.0, 0.0])
    front, rear = centre + 300.0 * forward, centre - 300.0 * forward
    nearer = abs(rear[1]) - abs(front[1])
    toe = ANGLE.value(centre - 90.0 * axle, centre, CarAxes(UP, RIGHTWARD, outboard))
    # A few roundings of coordinates up to 700 over the length of 90.
    assert toe == pytest.approx(np.deg2rad(degrees), abs=16 * EPS * 700 / 90)
    assert np.sign(nearer) == np.sign(degrees)
    assert np.sin(toe) == pytest.approx(nearer / 600.0, abs=1e-12)


def test_a_tie_rod_pushed_outward_behind_the_axle_turns_either_wheel_in() -> None:
    scene = Scene.load("off-axis-strut")
    points = scene.mechanism.points
    assert points["tie_rod_outer"][0] > points["lower_ball_joint"][0]  # behind it
    mirrored = {name: (x, -y, z) for name, (x, y, z) in points.items()}
    toes = {}
    # The rack's travel is along the car's left, which is outward for the left wheel.
    for side, drawn, outward in (("left", dict(points), 1.0), ("right", mirrored, -1.0)):
        content = scene.model_dump(mode="json", exclude_none=True) | {"effects": ["toe"]}
        content["mechanism"] |= {"side": side, "points": drawn}
        content["inputs"]["rack"] = {"polynomial": [0.0, 10.0 * outward]}
        content["inputs"]["arm_angle"] = {"constant": 1.63}
        content["time"] = {"start": 0.0, "stop": 1.0, "samples": 5}
        toes[side] = simulate(Scene.from_mapping(content)).wheel["toe"]
        assert (np.diff(toes[side]) > 0.01).all()
    # A change of sign rounds nothing but the order of sums.
    assert toes["left"] == pytest.approx(toes["right"], abs=1e-14)


def test_axes_that_are_not_right_handed_are_told_where_the_front_is() -> None:
    content = Scene.load("off-axis-strut").model_dump(mode="json", exclude_none=True) | {"effects": ["toe"]}
    right_handed = simulate(Scene.from_mapping(content))
    assert not any("wrong sign" in note for note in right_handed.notes)
    # y to the left and z up, but x still rearward: the mirror image of a car in right-handed axes.
    points = {name: [x, -y, z] for name, (x, y, z) in content["mechanism"]["points"].items()}
    content["mechanism"] |= {"points": points, "right": [0.0, -1.0, 0.0]}
    left_handed = simulate(Scene.from_mapping(content))
    assert any(
        "toe and caster" in note and "may have the wrong sign" in note and "towards [1.0, 0.0, 0.0]" in note
        for note in left_handed.notes
    )
    assert left_handed.wheel["toe"] == pytest.approx(-right_handed.wheel["toe"], abs=1e-13)
    # x forward, y to the left and z up, which is right-handed: a half turn of the first axes.
    points = {name: [-x, y, z] for name, (x, y, z) in points.items()}
    content["mechanism"]["points"] = points
    turned = simulate(Scene.from_mapping(content))
    assert not any("wrong sign" in note for note in turned.notes)
    assert turned.wheel["toe"] == pytest.approx(right_handed.wheel["toe"], abs=1e-13)
