"""The printed omega is a quotient that vanishes in common motions; the turn of two edges does not."""

from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.hard.cars import PAPER_CAR, scene_content
from validate.hard.case import Case
from validate.hard.cases.body_rates import CASES, PLANE_ANGLE
from validate.hard.run import examine
from validate.hard.trial import Trial

BY_NAME = {case.name: case for case in CASES}
OURS = ("pointcoord", "pointcoord-newton", "absolute", "relative")


def at(case: str, *values: float) -> Case:
    """A case at some values of its parameter only."""
    return replace(BY_NAME[case], values=values)


def solution_of(came: object) -> Solution:
    """What came, which is no refusal."""
    assert isinstance(came, Solution)
    return came


def omega_error(trial: Trial, name: str) -> float:
    """Of the knuckle's angular velocity, in parts of it."""
    both = map(solution_of, (trial.reference, trial.came[name]))
    true, found = (one.angular_velocity["knuckle"] for one in both)
    return float(np.abs(found - true).max() / np.abs(true).max())


@pytest.mark.parametrize("name", ["arm-all-but-held", "omega-in-the-knuckle-plane"])
def test_the_printed_omega_loses_its_digits_and_ours_keeps_them(name: str) -> None:
    near, nearer, there = examine(at(name, 1e-3, 1e-9, 0.0)).trials
    assert omega_error(nearer, "printed") > max(1e-8, 1e4 * omega_error(near, "printed"))
    assert not omega_error(there, "printed") < 1e-3
    for trial in (nearer, there):
        assert all(omega_error(trial, ours) < 1e-12 for ours in OURS)


def across_the_plane(arm_angle: float) -> float:
    """Sine of the angle of the true omega with the plane of the knuckle's points; the rack is held."""
    scene = Scene.from_mapping(scene_content(PAPER_CAR, [arm_angle, 1.0]))
    pose = reference_instant(scene, inputs_at(scene, 0.0))
    knuckle = ("lower_ball_joint", "tie_rod_outer", "strut_lower")
    first, second, third = (np.array(pose.position_as_float(name)) for name in knuckle)
    normal = np.cross(second - first, third - first)
    omega = np.array([float(x) for x in pose.angular_velocity["knuckle"]])
    return float(omega @ normal) / float(np.linalg.norm(omega) * np.linalg.norm(normal))


def test_omega_of_the_turning_arm_passes_the_knuckle_plane_where_it_was_worked_out() -> None:
    # One rounding of the angle is 2e-16 rad, and the sine changes by about 0.3 per rad there.
    assert abs(across_the_plane(PLANE_ANGLE)) < 1e-15
    assert across_the_plane(PLANE_ANGLE - 1e-3) < -1e-4
    assert across_the_plane(PLANE_ANGLE + 1e-3) > 1e-4


@pytest.mark.parametrize("name", ["at-rest", "arm-hardly-moves", "rack-hardly-moves"])
def test_a_car_at_rest_has_rates_of_exactly_zero(name: str) -> None:
    (trial,) = examine(at(name, 0.0)).trials
    assert set(trial.came) == set(OURS)
    for came in trial.came.values():
        for quantity in ("velocity", "acceleration", "angular_velocity", "angular_acceleration"):
            assert all(not array.any() for array in solution_of(came).numbers[quantity].values())
