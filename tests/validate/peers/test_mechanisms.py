"""Mechanisms are where other people's tables and closed forms have them.

What the reference says of every shipped one is in tests/mechanisms/test_formulations.py.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanism_files import mechanism_file, plain, plain_scene
from numpy.typing import NDArray
from relative_cars import plain_car, sine, swing
from sample_cars import PAPER_STRUT, SampleCar, by_car

from validate.cars.car import Car
from validate.cars.input_ends import drawn_inputs, end
from validate.peers.errors import HardpointsError, InputError, PoseError
from validate.peers.in_exudyn import InExudyn
from validate.peers.in_mujoco import InMujoco
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.linkage import Linkage, linkage_of
from validate.peers.motion import Poses, numbers
from validate.spanning_tree.chassis import ChassisMotion
from validate.spanning_tree.wheels import OF_CAR

Array = NDArray[np.float64]
TABLES = json.loads((Path(__file__).parent / "vdsim_rear_axles.json").read_text("utf-8"))
CAR = {"right": (0.0, -1.0, 0.0)}  # x forward, y left


def held(values: Array) -> Array:
    """An input that goes through values, without rates."""
    return np.stack([values, 0.0 * values, 0.0 * values], axis=-1)


def solved(mechanism: Any, laws: dict[str, Array], program_of: Any = InPinocchio) -> tuple[Linkage, Poses]:
    linkage = linkage_of(mechanism)
    program = program_of(linkage)
    return linkage, program.poses(linkage.inputs(laws).values, 1e-12, program.closed(1e-12))


def everything(mechanism: Any, laws: dict[str, Array], program_of: Any = InPinocchio) -> tuple[Any, Array]:
    """Numbers of a motion but for the chassis' own, and how exactly points are placed."""
    linkage = linkage_of(mechanism)
    program, inputs = program_of(linkage), linkage.inputs(laws)
    poses = program.poses(inputs.values, 1e-12, program.closed(1e-12))
    found = numbers(linkage, None, poses, program.rates(poses, inputs.series))
    return found, linkage.accuracy(poses.last_step)


@pytest.mark.parametrize("name", TABLES["cars"])
def test_a_rear_axle_moves_as_vdsim_says(name: str) -> None:
    car = TABLES["cars"][name]
    points = {point: 1000.0 * np.array(place) for point, place in car["points"].items()}
    points["wheel_axis_inner"] = points["wheel_centre"] - (0.0, 100.0, 0.0)
    table = np.array(car["table"])
    mechanism = plain(mechanism_file(name), {"points": points, **CAR}, ["wheel_travel"])
    there, _ = everything(mechanism, {"wheel_travel": held(1000.0 * table[:, 0])})
    track = (there["position"]["wheel_centre"][:, 1] - points["wheel_centre"][1]) / 1000.0
    found = np.stack([there[OF_CAR]["camber"], there[OF_CAR]["toe"], track], axis=-1)
    assert np.abs(found - table[:, 1:]).max() < car["accuracy"]
    # Any other angle would be seen.
    assert np.abs(table[:, 1:]).max(axis=0).min() > 1e4 * car["accuracy"]


def test_a_slider_crank_is_its_closed_form_over_three_turns() -> None:
    mechanism = plain_scene("slider-crank")
    p = {name: np.array(place, dtype=float) for name, place in mechanism["points"].items()}
    turn = np.linspace(0.0, 6.0 * np.pi, 121)
    x, z = p["crank_pin"][0], p["crank_pin"][2]
    pin = np.stack([x * np.cos(turn) + z * np.sin(turn), z * np.cos(turn) - x * np.sin(turn)], axis=-1)
    rod = np.linalg.norm(p["piston"] - p["crank_pin"])
    height = pin[:, 1] + np.sqrt(rod**2 - (pin[:, 0] - p["piston"][0]) ** 2)
    found, accuracy = everything(mechanism, {"crank": held(turn)})
    error = np.abs(found["position"]["piston"][:, 2] - height)
    # The closed form's own roundings, some ten of 145 mm.
    assert (error <= 4.0 * accuracy + 3e-13).all()


def test_a_dead_point_is_not_passed_where_the_stroke_is_driven() -> None:
    mechanism = plain_scene("slider-crank", ["stroke"])
    reach = 145.0 - 130.0
    with pytest.raises(PoseError, match="hold each other") as caught:
        solved(mechanism, {"stroke": held(np.array([reach, reach + 5.0, reach + 60.0]))})
    assert {*caught.value.links} == {"connecting_rod", "stroke"}
    p = {name: np.array(place, dtype=float) for name, place in mechanism["points"].items()}
    length = np.linalg.norm(p["piston"] - p["crank_pin"]) + np.hypot(40.0, 5.0)
    top = np.sqrt(length**2 - 10.0**2) - 130.0
    # A fold is found to the root of rounding squared away: the way is halved to 2^-44 of itself.
    assert caught.value.reached["stroke"] == pytest.approx(top, abs=1e-9)


@pytest.mark.parametrize("program_of", [InPinocchio, InMujoco, InExudyn])
@pytest.mark.parametrize("contact", [False, True])
def test_a_wheel_is_lifted_by_its_contact_point_or_a_distance(contact: bool, program_of: Any) -> None:
    car = TABLES["cars"]["five_link"]
    points = {point: 1000.0 * np.array(place) for point, place in car["points"].items()}
    points["wheel_axis_inner"] = points["wheel_centre"] - (0.0, 100.0, 8.0)
    tables, radius = mechanism_file("five_link"), 305.0
    tables["inputs"] = {
        "lift": {"contact": ["wheel_axis_inner", "wheel_centre"]},
        "strut": {"distance": ["wheel_centre", "upper_front_inner"]},
    }
    part = {"points": points, "wheel_radius": radius, **CAR}
    drawn = np.linalg.norm(points["wheel_centre"] - points["upper_front_inner"])
    law = np.linspace(-30.0, 30.0, 5) + (0.0 if contact else drawn)
    name = "lift" if contact else "strut"
    there, accuracy = everything(plain(tables, part, [name]), {name: held(law)}, program_of)
    centre, inner = (there["position"][n] for n in ("wheel_centre", "wheel_axis_inner"))

    def lowest(centre: Array, inner: Array) -> Array:
        axis = (centre - inner) / np.linalg.norm(centre - inner, axis=-1, keepdims=True)
        return centre[..., 2] - radius * np.sqrt(1.0 - axis[..., 2] ** 2)

    found = (
        lowest(centre, inner) - lowest(points["wheel_centre"], points["wheel_axis_inner"])
        if contact
        else np.linalg.norm(centre - points["upper_front_inner"], axis=-1)
    )
    assert np.abs(found - law).max() < 1e-11
    assert accuracy.max() < 1e-11
    if not contact:
        with pytest.raises(InputError, match="a distance above 0"):
            everything(plain(tables, part, [name]), {name: held(np.array([-1.0]))})


def test_rows_that_depend_on_others_are_left_out_and_looked_at_in_every_pose() -> None:
    """The Bricard mechanism moves although its rows are as many as its joints."""
    mechanism = plain_scene("bricard")
    laws = {name: held(np.linspace(0.0, 0.5, 6)) for name in mechanism["inputs"]}
    everything(mechanism, laws)
    # Points that are off by 1e-7 mm leave the drawing dependent to rounding, and the motion not.
    rng = np.random.default_rng(3)
    for point, place in mechanism["points"].items():
        mechanism["points"][point] = (np.array(place) + 1e-7 * rng.standard_normal(3)).tolist()
    with pytest.raises(PoseError, match="misses closures that depend on others as drawn"):
        everything(mechanism, laws)


def test_a_hinge_that_closes_a_loop_cannot_be_driven_by_its_turn() -> None:
    """All four hinges of a planar four-bar: the loop's last hinge is cut, and a driven one is not."""
    pins = {"A": (0, 0, 0), "B": (0, 0, 100), "C": (200, 0, 120), "D": (180, 0, 0)}
    points = pins | {f"{name}2": (x, 30, z) for name, (x, _, z) in pins.items()}
    tables = {
        "title": "four-bar",
        "bodies": {
            "chassis": ["A", "A2", "D", "D2"],
            "crank": ["A", "A2", "B", "B2"],
            "coupler": ["B", "B2", "C", "C2"],
            "rocker": ["C", "C2", "D", "D2"],
        },
        "inputs": {"turn": {"angle": "crank", "from": "drawing"}},
    }
    mechanism = plain(tables, {"points": points}, ["turn"])
    places = everything(mechanism, {"turn": held(np.linspace(0.0, 0.6, 7))})[0]["position"]
    for one, other in (("B", "C"), ("C", "D"), ("A", "B")):
        drawn = np.linalg.norm(np.subtract(points[one], points[other]))
        np.testing.assert_allclose(np.linalg.norm(places[one] - places[other], axis=-1), drawn, atol=1e-11)
    assert np.abs(places["C"][:, 1]).max() < 1e-11


def test_a_car_turns_right_handed_about_a_direction() -> None:
    mechanism = plain_scene("double-wishbone")
    mechanism["inputs"] |= {"roll": {"turns": "chassis", "about": "lower_arm_front", "along": "forward"}}
    quarter = np.array([[0.5 * np.pi, 0.0, 0.0]])
    chassis = ChassisMotion.of(mechanism, {"roll": quarter})
    assert chassis is not None
    # About forward, which is -x of this car, y goes to -z and z to y.
    for before, after in (([0.0, 1.0, 0.0], [0.0, 0.0, -1.0]), ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0])):
        np.testing.assert_allclose(chassis.directions(np.array([before]))[0], after, atol=1e-15)


def test_every_scene_of_a_moved_chassis_is_moved_as_a_whole() -> None:
    mechanism = plain_scene("double-wishbone")
    mechanism["inputs"] |= {
        "roll": {"turns": "chassis", "about": "lower_arm_front", "along": "forward"},
        "heave": {"moves": "chassis", "along": "up"},
    }
    linkage, step, times = linkage_of(mechanism), 1e-3, 0.4 + 1e-3 * np.arange(-2.0, 3.0)
    laws = {
        drive.input: sine(drive.drawn * (1.0 if drive.is_angle else linkage.unit), 0.1, 2.0, times)
        for drive in linkage.driven
    }
    laws |= {"roll": sine(0.02, 0.1, 3.0, times), "heave": sine(0.0, 20.0, 1.0, times)}
    program, inputs = InPinocchio(linkage), linkage.inputs(laws)
    poses = program.poses(inputs.values, 1e-12, program.closed(1e-12))
    moved = numbers(linkage, inputs, poses, program.rates(poses, inputs.series))
    for name, place in moved["position"].items():
        first = (place[0] - 8.0 * place[1] + 8.0 * place[3] - place[4]) / (12.0 * step)
        second = (-place[0] + 16.0 * place[1] - 30.0 * place[2] + 16.0 * place[3] - place[4]) / (
            12.0 * step**2
        )
        # step^4 of fifth derivatives, below 1e6 mm/s^5; rounding of 1e-13 mm over step and step^2.
        np.testing.assert_allclose(moved["velocity"][name][2], first, atol=1e-6)
        np.testing.assert_allclose(moved["acceleration"][name][2], second, atol=1e-5)
    # The knuckle's turn is that of its points.
    spin, rate = (moved[q]["knuckle"] for q in ("angular_velocity", "angular_acceleration"))
    r, v, a = (
        moved[q]["wheel_centre"] - moved[q]["tie_rod_outer"] for q in ("position", "velocity", "acceleration")
    )
    np.testing.assert_allclose(v, np.cross(spin, r), atol=1e-9)
    np.testing.assert_allclose(a, np.cross(rate, r) + np.cross(spin, np.cross(spin, r)), atol=1e-9)


@by_car
@pytest.mark.parametrize("driven", ["arm_angle", "rack"])
@pytest.mark.parametrize("ahead", [False, True])
def test_an_input_beyond_its_end_is_refused_with_the_end(car: SampleCar, driven: str, ahead: bool) -> None:
    drawn = Car(car.points, car.side, closure=car.closure, suspension=car.type)
    home = drawn_inputs(drawn)
    last = end(drawn, home, driven, ahead)
    assert last is not None
    goal = {name: np.full(5, value) for name, value in home.items()}
    goal[driven] = home[driven] + np.array([0.0, 0.5, 0.9, 1.1, 1.2]) * (last.value - home[driven])
    if driven == "arm_angle" and not 0.0 < goal[driven][3] < np.pi:
        return
    with pytest.raises(PoseError) as caught:
        solved(plain_car(car), {name: held(law) for name, law in goal.items()})
    error = caught.value
    assert error.instant == 3
    assert error.wanted[driven] == goal[driven][3]
    # A way is followed until its steps shrink below 2^-44 of it, or the fold's rounding, root of 1e-15, is
    # at 1e-9 of a range at the most.
    assert error.reached[driven] == pytest.approx(last.value, abs=1e-9 * abs(last.value - home[driven]))
    assert f"{driven} = {error.reached[driven]:.10g}" in str(error)
    assert len(error.partial.coordinates) == 3


def test_a_way_that_is_blocked_between_two_poses_is_refused_and_the_way_round_is_taken() -> None:
    """Below a rack travel of -0.0029 mm the paper's arm cannot pass 35.1 degrees, above it can."""

    def reached(*places: tuple[float, float]) -> Poses:
        angles, racks = np.array(places).T
        return solved(plain_car(PAPER_STRUT), {"arm_angle": held(np.deg2rad(angles)), "rack": held(racks)})[1]

    assert len(reached((37.0, -0.1), (37.0, 0.1), (34.0, 0.1), (34.0, -0.1)).inputs) == 4
    with pytest.raises(PoseError, match="hold each other") as caught:
        reached((37.0, -0.1), (34.0, -0.1))
    assert caught.value.instant == 1
    assert "tie_rod" in caught.value.links
    # The arm ends at 35.27 degrees there.
    assert np.rad2deg(caught.value.reached["arm_angle"]) == pytest.approx(35.27, abs=0.005)


@by_car
def test_rates_are_difference_quotients_of_what_is_solved(car: SampleCar) -> None:
    step, times = 1e-3, 0.4 + 1e-3 * np.arange(-2.0, 3.0)
    there, _ = everything(plain_car(car), swing(car, times))
    for name, place in there["position"].items():
        first = (place[0] - 8.0 * place[1] + 8.0 * place[3] - place[4]) / (12.0 * step)
        second = (-place[0] + 16.0 * place[1] - 30.0 * place[2] + 16.0 * place[3] - place[4]) / (
            12.0 * step**2
        )
        # step^4 of fifth derivatives, below 1e6 mm/s^5; rounding of 1e-13 mm over step and step^2.
        np.testing.assert_allclose(there["velocity"][name][2], first, atol=1e-6)
        np.testing.assert_allclose(there["acceleration"][name][2], second, atol=1e-5)


def test_inputs_that_are_too_many_or_too_few_are_refused() -> None:
    mechanism = plain_car(PAPER_STRUT)
    mechanism["inputs"]["again"] = dict(mechanism["inputs"]["arm_angle"])
    with pytest.raises(HardpointsError, match="does not move the mechanism beside the others"):
        InPinocchio(linkage_of(mechanism)).closed(1e-12)
    del mechanism["inputs"]["again"], mechanism["inputs"]["rack"]
    with pytest.raises(HardpointsError, match="is free to move as drawn"):
        InPinocchio(linkage_of(mechanism)).closed(1e-12)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, None])
def test_an_input_that_is_no_number_or_missing_is_refused_with_its_instant(wrong: float | None) -> None:
    laws = swing(PAPER_STRUT, np.linspace(0.0, 1.0, 9))
    if wrong is None:
        del laws["rack"]
    else:
        laws["rack"][7, 0] = wrong
    with pytest.raises(InputError, match="rack") as caught:
        linkage_of(plain_car(PAPER_STRUT)).inputs(laws)
    assert caught.value.instant == (None if wrong is None else 7)


def test_two_branches_that_cross_at_once_are_not_exchanged() -> None:
    """With its cranks in line both loops change the sign of a determinant, and not that of their product."""
    with pytest.raises(PoseError, match="cannot be reached"):
        solved(plain_scene("n-four-bar"), {"crank": held(np.array([-1.0, -1.6]))})
