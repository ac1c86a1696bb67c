"""Where the ends of the inputs are; that each parts poses from none the hard cases next to it say."""

import mpmath
import pytest

from validate.hard.cars import CARS
from validate.hard.last_values import last_value
from validate.hard.subjects import NAMED


@pytest.mark.parametrize("car", ["paper", "turned"])
def test_the_arm_ends_where_its_ball_joint_is_highest_or_lowest_on_its_circle(car: str) -> None:
    # With u the axis and d the arm: height u_z (u . d) +- |d - u (u . d)| |z - u u_z|, worked out in
    # 50 digits from the coordinates as they are.
    names = ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
    with mpmath.workdps(50):
        front, rear, ball = (mpmath.matrix(CARS[car].points[n]) for n in names)
        z = mpmath.matrix(CARS[car].up)
        axis, arm = rear - front, ball - front
        u = axis / mpmath.norm(axis)
        along, rise = (u.T * arm)[0], (u.T * z)[0]
        half = mpmath.norm(arm - along * u) * mpmath.norm(z - rise * u)
        for ahead, sign in ((True, -1), (False, 1)):
            expected = mpmath.acos((rise * along + sign * half) / mpmath.norm(arm))
            found = last_value(NAMED[car], "arm_angle", ahead)
            value = mpmath.mpf(found.value.numerator) / found.value.denominator
            # halved down to 1e-16 of the range
            assert abs(value - expected) <= 2e-16 * found.reach
