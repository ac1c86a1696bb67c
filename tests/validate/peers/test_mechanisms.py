"""Mechanisms in trees of joints: how they are driven, where they end and what none of them is.

What the reference says of every shipped one is in tests/mechanisms/test_formulations.py.
"""

from typing import Any

import numpy as np
import pytest
from mechanism_files import mechanism_file, plain, plain_scene
from numpy.typing import NDArray
from relative_cars import plain_car
from sample_cars import GENERAL_STRUT, PAPER_STRUT, SampleCar, by_car

from validate.cars.car import Car
from validate.cars.input_ends import drawn_inputs, end
from validate.peers.errors import HardpointsError, InputError, PoseError
from validate.peers.in_exudyn import InExudyn
from validate.peers.in_mujoco import InMujoco
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.linkage import Linkage, linkage_of
from validate.peers.motion import Poses, numbers

Array = NDArray[np.float64]


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
    points = {point: np.array(place) for point, place in plain_scene("five-link")["points"].items()}
    points["wheel_axis_inner"] = points["wheel_centre"] + (0.0, 100.0, -8.0)
    tables, radius = mechanism_file("five_link"), 305.0
    tables["inputs"] = {
        "lift": {"contact": ["wheel_axis_inner", "wheel_centre"]},
        "strut": {"distance": ["wheel_centre", "upper_front_inner"]},
    }
    part = {"points": points, "wheel_radius": radius}
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


@by_car
@pytest.mark.parametrize(("driven", "ahead"), [("arm_angle", False), ("rack", True)])
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
    laws = {name: held(np.full(9, value)) for name, value in PAPER_STRUT.drawn_inputs.items()}
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


def parallelogram(apart: float) -> Any:
    """Two cranks of 1 m that a coupler keeps parallel, or crossed from where all lie in one line."""
    mechanism = plain_scene("n-four-bar")
    del mechanism["bodies"]["crank_2"], mechanism["rods"]["coupler_2"]
    mechanism["bodies"]["chassis"] = ["A0", "A0_pin", "A1", "A1_pin"]
    kept = {name for points in mechanism["bodies"].values() for name in points}
    moved = {"A1": [apart, 0, 0], "A1_pin": [apart, 0, 1000], "B1": [apart, 1000, 0]}
    mechanism["points"] = {n: moved.get(n, p) for n, p in mechanism["points"].items() if n in kept}
    return mechanism


@pytest.mark.parametrize("program_of", [InPinocchio, InMujoco, InExudyn])
@pytest.mark.parametrize("apart", [500.0, 1000.0, 2000.0])
@pytest.mark.parametrize("count", [2, 5, 7, 13, 21, 101])
def test_a_way_does_not_go_over_to_a_branch_that_crosses_it(
    program_of: Any, apart: float, count: int
) -> None:
    """The determinant changes its sign where cranks stay parallel, and keeps it where they cross."""
    turns = np.linspace(0.0, 3.0, count)
    with pytest.raises(PoseError, match="cannot be reached") as caught:
        solved(parallelogram(apart), {"crank": held(turns)}, program_of)
    assert caught.value.reached["crank"] == pytest.approx(0.5 * np.pi, abs=1e-6)
    assert caught.value.partial is None or len(caught.value.partial.inputs) == np.sum(turns < 0.5 * np.pi)


@pytest.mark.parametrize("program_of", [InPinocchio, InMujoco, InExudyn])
def test_a_way_that_turns_back_before_a_fold_is_followed_back(program_of: Any) -> None:
    """The stroke stops 1e-11 mm short of its dead point, where branches meet to rounding, and goes back."""
    mechanism = plain_scene("slider-crank", ["stroke"])
    with pytest.raises(PoseError) as caught:
        solved(mechanism, {"stroke": held(np.array([15.0, 75.0]))}, program_of)
    strokes = np.array([15.0, caught.value.reached["stroke"] - 1e-11, 15.0])
    _, poses = solved(mechanism, {"stroke": held(strokes)}, program_of)
    assert np.abs(poses.coordinates[0] - poses.coordinates[2]).max() < 1e-11


def test_what_makes_no_mechanism_is_told_by_name() -> None:
    strut = GENERAL_STRUT
    with pytest.raises(HardpointsError, match="lower_arm_front is where lower_arm_rear is"):
        linkage_of(plain_car(strut, lower_arm_rear=strut.points["lower_arm_front"]))
    with pytest.raises(HardpointsError, match="strut_lower is where strut_top is"):
        linkage_of(plain_car(strut, strut_lower=strut.points["strut_top"]))


def test_an_angle_outside_half_a_turn_is_refused_at_its_instant() -> None:
    theta = np.stack([np.linspace(1.6, 0.1, 5), np.zeros(5), np.zeros(5)], axis=-1)
    theta[2, 0] = 3.2
    with pytest.raises(InputError, match="an angle from 0 to pi") as caught:
        linkage_of(plain_car(GENERAL_STRUT)).inputs({"arm_angle": theta, "rack": np.zeros((5, 3))})
    assert caught.value.instant == 2
