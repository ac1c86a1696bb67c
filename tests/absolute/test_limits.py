"""At the ends of the motion: a pose is given where rows close to rounding, and nowhere else."""

from collections.abc import Callable

import exact_form as exact
import numpy as np
import pytest
from numpy.typing import NDArray
from reach_of_accuracy import off

import absolute

Array = NDArray[np.float64]
Table = dict[str, tuple[float, float, float]]
Held = Callable[[float, float], dict[str, Array]]
EPS = float(np.finfo(float).eps)
# Two rows of the tie rod's ends, each closed to 4 eps of the vectors in it: these add up to less
# than three times the 400 mm from the middle of the car to its furthest point.
CLOSED = 2 * 4 * EPS * 3 * 400.0
# Ends of the motion of the paper's car: (arm angle, rack) and the way out of it.
ENDS = [
    ((np.pi / 2, 130.100768319815), (0.0, 219.0)),
    ((0.5624915120982854, 0.0), (-1.0, 0.0)),
    ((2.653128692580990, 0.0), (1.0, 0.0)),
    # Just beyond arm angles where two branches meet near the middle of the rack.
    ((0.6143, -0.029827062709444303), (0.0, -219.0)),
    ((0.6144, -0.03386460105999157), (0.0, -219.0)),
    ((0.6145, -0.03818180922672851), (0.0, -219.0)),
]
BEYOND = [1e-13, 3e-13, 1e-12, 3e-12, 1e-11, 1e-10, 1e-9]


def check_closed(table: Table, motion: absolute.Solution) -> None:
    """Tie rod and arm keep their lengths in the points given, at every instant."""
    for a, b in (("tie_rod_outer", "tie_rod_inner"), ("lower_ball_joint", "lower_arm_front")):
        drawn = np.linalg.norm(np.subtract(table[a], table[b]))
        lengths = np.linalg.norm(motion.position[a] - motion.position[b], axis=1)
        assert np.abs(lengths - drawn).max() <= CLOSED
    assert motion.residual.max() <= CLOSED


@pytest.mark.parametrize(("end", "out"), ENDS)
@pytest.mark.parametrize("beyond", BEYOND)
def test_nothing_stands_beyond_the_end_of_an_input_by_a_little(
    strut: absolute.Model,
    table: Table,
    held: Held,
    end: tuple[float, float],
    out: tuple[float, float],
    beyond: float,
) -> None:
    goal = end[0] + beyond * out[0], end[1] + beyond * out[1]
    # 1e-13 is far beyond the rounding of the end itself, so there is no pose.
    assert exact.exact_form(table, *goal) is None
    with pytest.raises(absolute.PoseError):
        absolute.solve(strut, held(*goal))


@pytest.mark.parametrize(("end", "out"), ENDS)
@pytest.mark.parametrize("inside", BEYOND)
def test_just_inside_the_end_of_an_input_the_pose_is_the_exact_one(
    strut: absolute.Model,
    table: Table,
    held: Held,
    end: tuple[float, float],
    out: tuple[float, float],
    inside: float,
) -> None:
    goal = end[0] - inside * out[0], end[1] - inside * out[1]
    expected = exact.exact_form(table, *goal)
    assert expected is not None
    motion = absolute.solve(strut, held(*goal), rates=False, conditions=True)
    check_closed(table, motion)
    assert motion.condition is not None
    tolerance = 8 * EPS * 400 * motion.condition[0]
    for name, place in expected[0].items():
        assert exact.distance(place, motion.position[name][0]) <= tolerance, name
        assert exact.distance(place, motion.position[name][0]) <= off(motion)[0], name


@pytest.mark.parametrize("angle", np.linspace(0.6143, 0.6145, 9).tolist())
def test_where_branches_nearly_meet_rows_are_closed_or_the_pose_is_refused(
    strut: absolute.Model, table: Table, angle: float
) -> None:
    racks = np.linspace(-15.0, 15.0, 121)
    still = np.zeros_like(racks)
    inputs = {
        "arm_angle": np.stack([np.full_like(racks, angle), still, still], -1),
        "rack": np.stack([racks, still, still], -1),
    }
    for order in (slice(None), slice(None, None, -1), slice(60, None), slice(60, None, -1)):
        part = {name: series[order] for name, series in inputs.items()}
        try:
            motion = absolute.solve(strut, part, rates=False)
        except absolute.PoseError as error:
            if error.partial is None:
                continue
            motion = error.partial
        check_closed(table, motion)


def test_an_instant_that_does_not_close_leaves_the_instants_before_it(
    strut: absolute.Model, table: Table
) -> None:
    # Twenty good instants and one beyond the end by rounding of the way there.
    racks = np.append(np.linspace(0.0, 130.0, 20), 130.100768319815 + 1e-13 * 219)
    still = np.zeros_like(racks)
    inputs = {
        "arm_angle": np.stack([np.full_like(racks, np.pi / 2), still, still], -1),
        "rack": np.stack([racks, still, still], -1),
    }
    with pytest.raises(absolute.PoseError) as caught:
        absolute.solve(strut, inputs)
    assert caught.value.instant == 20
    assert caught.value.partial is not None
    assert len(caught.value.partial.residual) == 20
    check_closed(table, caught.value.partial)
