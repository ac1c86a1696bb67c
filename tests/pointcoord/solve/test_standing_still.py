"""What stands still is taken from a pose as exactly as rounding allows, and nothing is done for it twice."""

from dataclasses import replace

import numpy as np

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.partial_map import PartialMap
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.solve.place import starting_place
from pointcoord.time_functions import Polynomial, TimeFunction

STEER: dict[str, TimeFunction] = {"arm_angle": Polynomial((1.5,)), "rack": Polynomial((0.0, 10.0))}


def steered(strut: Mechanism) -> tuple[PartialMap, Pose]:
    """What moves when the rack does, and six poses."""
    part = strut.moving_part(STEER)
    assert not part.is_whole
    return part, assemble(
        strut, {"arm_angle": np.full((2, 3), 1.5), "rack": np.linspace(-5.0, 5.0, 6).reshape(2, 3)}
    )


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
