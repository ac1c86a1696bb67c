"""The tree's closure equations and their Jacobian are those of the linkage."""

import numpy as np
import pinocchio
import pytest
from relative_cars import model_of, swing
from sample_cars import SampleCar, by_car

from validate.relative.errors import HardpointsError
from validate.relative.follow import row_targets
from validate.relative.linkage import Coincide
from validate.relative.model import build
from validate.relative.rates import row_jacobian, screws_by_joint
from validate.relative.tree import Tree

TIMES = np.linspace(0.0, 1.0, 9)


@by_car
def test_the_jacobian_is_the_derivative_of_the_rows(car: SampleCar) -> None:
    model = model_of(car)
    poses = model.poses(swing(car, TIMES), TIMES)
    tree = model.tree
    targets, step = np.zeros(tree.size), 1e-5
    batch = row_jacobian(tree, screws_by_joint(poses), poses)
    for k, q in enumerate(poses.q):
        tree.rows(q, targets)
        found = tree.jacobian().copy()
        for column in range(tree.size):
            change = np.zeros(tree.size)
            change[column] = step
            ahead, behind = (
                tree.rows(pinocchio.integrate(tree._model, q, s * change), targets).copy()
                for s in (1.0, -1.0)
            )
            # Central differences leave step^2 of third derivatives, some ten, and rounding over the step.
            np.testing.assert_allclose((ahead - behind) / (2.0 * step), found[:, column], atol=1e-8)
        np.testing.assert_allclose(batch[k], found, atol=1e-14)


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
def test_a_linkage_has_as_many_rows_as_joint_coordinates(car: SampleCar) -> None:
    linkage = model_of(car).linkage
    rows = sum(3 if isinstance(c, Coincide) else 1 for c in linkage.closures) + len(linkage.drives)
    assert rows == sum(3 if joint.kind == "spherical" else 1 for joint in linkage.joints)
    with pytest.raises(ValueError, match="rows for"):
        Tree(type(linkage)(**{**vars(linkage), "drives": linkage.drives[:1]}))


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
    points = dict(car.points) | {moved: car.points[onto]}
    with pytest.raises(HardpointsError, match="allowed") as caught:
        build(car.type, points, side=car.side, closure=car.closure)
    assert caught.value.name in (moved, onto)
    assert moved in str(caught.value)


@by_car
def test_targets_are_those_of_the_drawing_in_the_reference_pose(car: SampleCar) -> None:
    tree = model_of(car).tree
    drawn = np.array([drive.drawn for drive in tree.linkage.drives])
    gaps = [closure.gap for closure in tree.linkage.closures]
    rows = tree.rows(tree.neutral, row_targets(tree, drawn), gaps)
    assert np.abs(rows).max() < 4e-15
