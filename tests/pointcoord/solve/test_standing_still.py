"""What stands still is taken from a pose as exactly as rounding allows, and nothing is done for it twice."""

from dataclasses import replace

import numpy as np

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.partial_map import PartialMap
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.solve.standing_still import starting_place, whole_place
from pointcoord.time_functions import Polynomial, TimeFunction

STEER: dict[str, TimeFunction] = {"arm_angle": Polynomial((1.5,)), "rack": Polynomial((0.0, 10.0))}
BOTH: dict[str, TimeFunction] = {"arm_angle": Polynomial((1.5, 0.1)), "rack": Polynomial((0.0, 10.0))}


def steered(strut: Mechanism) -> tuple[PartialMap, Pose]:
    """What moves when the rack does, and six poses."""
    part = strut.moving_part(STEER)
    assert not part.is_whole
    return part, assemble(
        strut, {"arm_angle": np.full((2, 3), 1.5), "rack": np.linspace(-5.0, 5.0, 6).reshape(2, 3)}
    )


def same_factors(factors: Factors, matrices: np.ndarray) -> None:
    rows = np.linspace(-1.0, 1.0, matrices.shape[-1]) * np.ones(matrices.shape[:-1])
    np.testing.assert_array_equal(factors.solve(rows), factorise(matrices).solve(rows))


def test_exact_poses_are_taken_as_they_are_and_cost_their_factors_only(strut: Mechanism) -> None:
    part, poses = steered(strut)
    place = starting_place(part, poses)
    np.testing.assert_array_equal(place.y, part.taken(poses.y))
    np.testing.assert_array_equal(place.left, np.zeros((2, 3)), strict=True)
    assert place.work == Work(factorisations=6)
    same_factors(place.factors, part.system.jacobian(place.y))


def test_a_pose_among_exact_ones_that_a_tolerance_left_off_is_solved_to_rounding(strut: Mechanism) -> None:
    part, poses = steered(strut)
    y, left, n = poses.y.copy(), np.zeros((2, 3)), strut.map.unknowns
    y[1, 1, :n] += 1e-6 * np.random.default_rng(2).uniform(-1.0, 1.0, n)
    left[1, 1] = 1e-5
    place = starting_place(part, replace(poses, y=y, left=left))
    # The same pose twice, each to rounding, of coordinates up to 2.
    off = np.abs(place.y - part.taken(poses.y)).max(axis=-1)
    assert (off <= 4.0 * np.finfo(float).eps * poses.condition).all()
    np.testing.assert_array_equal(place.left, np.zeros((2, 3)), strict=True)


def test_poses_of_a_part_are_poses_of_the_whole(strut: Mechanism) -> None:
    part, poses = steered(strut)
    y = part.taken(poses.y)
    place = whole_place(part, y, factorise(part.system.jacobian(y)))
    np.testing.assert_array_equal(place.y, poses.y)
    same_factors(place.factors, strut.map.jacobian(poses.y))
    np.testing.assert_array_equal(place.left, np.zeros((2, 3)), strict=True)
    assert place.work == Work(factorisations=6)


def test_where_all_moves_nothing_is_done(strut: Mechanism) -> None:
    _, poses = steered(strut)
    part = strut.moving_part(BOTH)
    assert part.is_whole
    begun, there = starting_place(part, poses), whole_place(part, poses.y, poses.factors)
    for place in (begun, there):
        assert place.y is poses.y
        assert place.factors is poses.factors
        assert place.work == Work()
        np.testing.assert_array_equal(place.left, np.zeros((2, 3)), strict=True)
