"""Beyond the ends of the inputs a search finds no pose, and what is said to lock there does."""

import brute_force
import numpy as np
import pytest

from validate.cars.input_limits import ARM, TIE_ROD, Linkage
from validate.cars.near_singular import car_with_ends
from validate.cars.random_cars import random_car
from validate.cars.registry import SUSPENSIONS

LOCKS = [(name, lock) for name, s in SUSPENSIONS.items() for lock in (ARM, s.upper_lock, TIE_ROD)]


@pytest.mark.parametrize(("suspension", "lock"), LOCKS)
def test_an_input_ends_where_brute_force_finds_no_further_pose(suspension: str, lock: str) -> None:
    """A share of 1e-3 of the range inside its end there is a pose, and as much beyond it there is none."""
    tried, rng = 0, np.random.default_rng(3)
    while tried < 6:
        car = car_with_ends(rng)
        linkage = Linkage.of(car)
        if car.suspension != suspension or not linkage.sound or not 200.0 < linkage.size < 1e3:
            continue
        for driven in linkage.home:
            low, high = (linkage.end(linkage.home, driven, ahead) for ahead in (False, True))
            if low is None or high is None:
                continue
            for this, other in ((low, high), (high, low)):
                if this[1] != lock:
                    continue
                step = 1e-3 * (other[0] - this[0])
                inside, beyond = (linkage.home | {driven: this[0] + step * s} for s in (1.0, -1.0))
                if lock == TIE_ROD and not linkage.form.upper_spare(np.array(beyond["arm_angle"])) > 1e-2:
                    continue  # right after the tie rod the upper end locks as well
                assert brute_force.look_for_pose(car, inside["arm_angle"], inside["rack"]) == (True, True)
                upper, rod = brute_force.look_for_pose(car, beyond["arm_angle"], beyond["rack"])
                assert not rod
                assert upper == (lock == TIE_ROD)
                tried += 1


def locked_ends(suspension: str, count: int) -> list[tuple[Linkage, float]]:
    """Random cars with an arm angle at which the knuckle's upper end locks."""
    rng, found = np.random.default_rng(7), []
    while len(found) < count:
        car, _ = random_car(rng, "upper lock")
        linkage = Linkage.of(car)
        if car.suspension == suspension and linkage.sound:
            ends = linkage.ends(linkage.home, "arm_angle")
            found += [(linkage, angle) for angle, lock in ends if lock == linkage.suspension.upper_lock]
    return found[:count]


def test_the_slide_runs_out_where_the_ball_joint_is_as_near_to_the_top_as_beside_the_axis() -> None:
    for linkage, angle in locked_ends("macpherson", 10):
        near = float(np.linalg.norm(linkage.p["strut_top"] - linkage.form.ball_joint(angle)))
        top, lower = linkage.p["strut_top"], linkage.p["strut_lower"]
        axis = (top - lower) / np.linalg.norm(top - lower)
        beside = float(np.linalg.norm(np.cross(linkage.p["lower_ball_joint"] - lower, axis)))
        assert near == pytest.approx(beside, rel=1e-12)


def test_the_upper_arm_locks_where_both_ball_joints_lie_in_one_plane_with_its_pivots() -> None:
    for linkage, angle in locked_ends("double_wishbone", 10):
        p, ball = linkage.p, linkage.form.ball_joint(angle)
        axis = p["upper_arm_rear"] - p["upper_arm_front"]
        axis = axis / np.linalg.norm(axis)
        upper = p["upper_ball_joint"] - p["upper_arm_front"]
        climb, radius = upper @ axis, np.linalg.norm(np.cross(axis, upper))
        reach = ball - p["upper_arm_front"]
        climbs, far = reach @ axis, np.linalg.norm(np.cross(axis, reach))
        # In one plane the kingpin is as high as the sum, or the difference, of both distances from the axis.
        heights = [np.hypot(climbs - climb, far + sign * radius) for sign in (1.0, -1.0)]
        kingpin = np.linalg.norm(p["upper_ball_joint"] - p["lower_ball_joint"])
        assert min(abs(h / kingpin - 1.0) for h in heights) < 1e-9
