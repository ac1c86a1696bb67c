"""The ends of the inputs: where they are, and that each is a fold."""

import mpmath
import pytest

from pointcoord import Scene
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.hard.cars import CARS
from validate.hard.cases.reach import End
from validate.hard.last_values import ends_of, last_value
from validate.hard.subjects import NAMED, OTHERS
from validate.reference import InfeasibleError, Instant

CarEnd = tuple[str, str, bool]
ENDS: list[CarEnd] = [
    ("paper", "arm_angle", True),
    ("wishbone", "rack", True),
    ("wide", "arm_angle", False),
    *((subject.name, driven, up) for subject in OTHERS for driven, up in ends_of(subject)[:1]),
]


def pose(end: CarEnd, value: float) -> Instant:
    """The reference near an end; beyond it for a value below 0."""
    name, driven, ahead = end
    held = End(NAMED[name], driven, ahead, moving=False)
    scene = Scene.from_mapping(held.near(held.subject, value))
    return reference_instant(scene, inputs_at(scene, 0.0))


@pytest.mark.parametrize("end", ENDS, ids=str)
def test_an_end_separates_poses_from_none_to_a_trillionth_of_the_range(end: CarEnd) -> None:
    assert pose(end, 1e-12).position
    with pytest.raises(InfeasibleError):
        pose(end, -1e-12)


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
