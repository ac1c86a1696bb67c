"""The tree's closure equations and their Jacobian are those of the linkage."""

import numpy as np
import pinocchio
import pytest
from mechanism_files import SCENES, plain_scene
from relative_cars import model_of, plain_car, swing
from sample_cars import SampleCar, by_car

from validate.relative.errors import HardpointsError
from validate.relative.follow import targets_at
from validate.relative.model import build

TIMES = np.linspace(0.0, 1.0, 9)


@pytest.mark.parametrize("name", SCENES)
def test_the_jacobian_is_the_derivative_of_the_rows(name: str) -> None:
    """Of every row there is, away from the drawing."""
    tree = build(plain_scene(name)).tree
    rng, step = np.random.default_rng(1), 1e-5
    q = pinocchio.integrate(tree._model, tree.neutral, 0.05 * rng.standard_normal(tree.size))
    tree.matrices(q)
    found = tree.jacobian()

    def rows(change: np.ndarray) -> np.ndarray:
        near = pinocchio.integrate(tree._model, q, change)
        return tree.rows.values(tree.matrices(near), near, np.zeros(tree.size))

    for column, change in enumerate(step * np.eye(tree.size)):
        slope = (rows(change) - rows(-change)) / (2.0 * step)
        # Central differences leave step^2 of third derivatives, some ten, and rounding over the step.
        np.testing.assert_allclose(slope, found[:, column], atol=1e-8)


@by_car
def test_a_solved_pose_closes_every_loop_and_meets_every_input(car: SampleCar) -> None:
    """By the places of the points that it reports, which no row was evaluated from."""
    model = model_of(car)
    laws = swing(car, TIMES)
    places = model.positions(model.poses(laws, TIMES))
    p = {name: np.array(place, dtype=float) for name, place in car.points.items()}
    p.setdefault("rack_centre", p["tie_rod_inner"])
    links = [
        ("lower_arm_front", "lower_ball_joint"),
        ("lower_arm_rear", "lower_ball_joint"),
        ("lower_ball_joint", "tie_rod_outer"),
        ("tie_rod_outer", "tie_rod_inner"),
        ("lower_ball_joint", "wheel_centre"),
    ]
    if car.type == "double_wishbone":
        links += [(a, "upper_ball_joint") for a in ("upper_arm_front", "upper_arm_rear", "lower_ball_joint")]
    for one, other in links:
        now = np.linalg.norm(places[one] - places[other], axis=-1)
        # A hundred roundings of a car of a metre.
        np.testing.assert_allclose(
            now, np.linalg.norm(p[one] - p[other]), atol=2e-11, err_msg=f"{one} {other}"
        )
    rise = (places["lower_ball_joint"] - p["lower_arm_front"])[:, 2]
    reach = np.linalg.norm(p["lower_ball_joint"] - p["lower_arm_front"])
    np.testing.assert_allclose(rise, reach * np.cos(laws["arm_angle"][:, 0]), atol=2e-11)
    rack = p["rack_centre"] - laws["rack"][:, :1] * np.array([0.0, 1.0, 0.0])
    np.testing.assert_allclose(places["tie_rod_inner"], rack, atol=2e-11)


@by_car
def test_a_drawing_that_closes_comes_back_at_its_own_inputs_and_another_moves_as_it_must(
    car: SampleCar,
) -> None:
    largest = max(model_of(car).closing.values())
    # The paper's Table 1 is up to 17 mm from closing.
    assert largest == pytest.approx(16.8, abs=0.05) if car.closure == "collinear" else largest < 1e-11


@by_car
@pytest.mark.parametrize(
    ("moved", "onto"),
    [
        ("lower_arm_rear", "lower_arm_front"),
        ("lower_ball_joint", "lower_arm_front"),
        ("tie_rod_outer", "tie_rod_inner"),
    ],
)
def test_points_in_one_place_are_refused_by_name(car: SampleCar, moved: str, onto: str) -> None:
    with pytest.raises(HardpointsError, match="allowed") as caught:
        build(plain_car(car, **{moved: car.points[onto]}))
    assert caught.value.name in (moved, onto)
    assert moved in str(caught.value)


@by_car
def test_targets_are_those_of_the_drawing_in_the_reference_pose(car: SampleCar) -> None:
    tree = model_of(car).tree
    targets = targets_at(tree, np.array([drive.drawn for drive in tree.drives]))
    rows = tree.rows.values(tree.matrices(tree.neutral), tree.neutral, targets)
    # The collinear strut is drawn beside its line.
    assert np.abs(rows[tree.rows.drives] if car.closure == "collinear" else rows).max() < 4e-15


def test_inputs_that_do_not_drive_the_mechanism_are_refused_by_name() -> None:
    with pytest.raises(HardpointsError, match="is free to move"):
        build(plain_scene("double-wishbone", ["rack"]))
    with pytest.raises(HardpointsError, match="does not move the mechanism as drawn"):
        build(plain_scene("double-wishbone", ["rack", "arm_angle", "wheel_travel"]))
