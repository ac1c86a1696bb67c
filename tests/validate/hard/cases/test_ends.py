"""The ends of the inputs: where they are, and that each is a fold."""

from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.hard.cars import CARS, SQUARE, scene_content
from validate.hard.cases.ends import CASES, End, near_end
from validate.hard.last_values import ends_of, last_value, reachable
from validate.hard.run import as_expected, examine
from validate.hard.subjects import NAMED, OTHERS, PAPER
from validate.reference import InfeasibleError, Instant

BY_NAME = {case.name: case for case in CASES}
WAYS = (False, True)
CarEnd = tuple[str, str, bool, float | None]
ENDS: list[CarEnd] = [
    *((car, "arm_angle", up, None) for car in ("paper", "other", "short-arm") for up in WAYS),
    *((car, "rack", up, SQUARE) for car in ("paper", "other", "wishbone") for up in WAYS),
    ("wide", "arm_angle", False, None),
    ("wishbone", "arm_angle", True, None),
    ("wishbone", "arm_angle", False, None),
    *((subject.name, driven, up, None) for subject in OTHERS for driven, up in ends_of(subject)[:1]),
]


def pose(end: CarEnd, value: float, law: str = "held") -> Instant:
    """The reference near an end, or beyond it."""
    name, driven, ahead, arm_angle = end
    scene = Scene.from_mapping(near_end(End(driven, ahead, ""), arm_angle, law, NAMED[name], value))
    return reference_instant(scene, inputs_at(scene, 0.0))


@pytest.mark.parametrize("end", ENDS, ids=str)
def test_an_end_separates_poses_from_none_to_a_trillionth_of_the_range(end: CarEnd) -> None:
    assert pose(end, 1e-12).condition > 1e5
    with pytest.raises(InfeasibleError):
        pose(end, 1e-12, "beyond")


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


def test_the_ends_are_those_of_the_papers_car() -> None:
    """Found by continuation: 32.2 to 152.0 degrees at rack 0, -89 to 130 mm at a right angle."""
    arm = [float(last_value(PAPER, "arm_angle", ahead).value) for ahead in WAYS]
    assert np.allclose(np.degrees(arm), (32.2, 152.0), rtol=0, atol=0.1)
    for ahead, wanted in ((True, 130.101), (False, -89.066)):
        end, outward = last_value(PAPER, "rack", ahead), 1 if ahead else -1
        assert round(float(end.value), 3) == wanted
        near = outward * Fraction(1, 10**15) * Fraction(end.reach)
        assert reachable(PAPER, {**PAPER.home, "rack": end.value - near})
        assert not reachable(PAPER, {**PAPER.home, "rack": end.value + near})


def test_a_mirrored_and_turned_car_has_the_same_range() -> None:
    for driven in ("arm_angle", "rack"):
        plain, turned = (
            last_value(NAMED[car], driven, ahead)
            for car, ahead in (("beside", driven != "rack"), ("turned", True))
        )
        # Its coordinates, up to 4e6 mm, were rounded by 2^-31 mm when it was turned; the rack's end moves
        # by some ten times as much.
        assert plain.reach == pytest.approx(turned.reach, rel=0.0, abs=1e-7)


@pytest.mark.parametrize("car", ["paper", "wishbone"])
def test_rates_grow_as_the_inverse_root_of_the_distance(car: str) -> None:
    low, high = (float(last_value(NAMED[car], "rack", ahead).value) for ahead in WAYS)
    distances = np.array([1e-6, 1e-8, 1e-10])
    speeds = []
    for distance in distances.tolist():
        rack = [low + distance * (high - low), 1.0]
        scene = Scene.from_mapping(scene_content(CARS[car], SQUARE, rack))
        velocity = reference_instant(scene, inputs_at(scene, 0.0)).velocity["tie_rod_outer"]
        speeds.append(max(float(abs(x)) for x in velocity))
    slope = np.polyfit(np.log(distances), np.log(speeds), 1)[0]
    assert abs(slope + 0.5) < 1e-3


@pytest.mark.parametrize(
    "name", [name for name, case in BY_NAME.items() if "-held" in name and len(case.values) > 1]
)
def test_the_condition_number_shows_the_fold(name: str) -> None:
    result = examine(replace(BY_NAME[name], values=(1e-2, 1e-5, 1e-8, 1e-11)))
    assert as_expected([result]), result.unexpected
    conditions = [answer.condition for _, answer in result.answers("pointcoord")]
    growth = np.diff(np.log10(np.array(conditions, dtype=float)))
    # A thousandth of the distance makes 1e1.5 of it; the first step still feels the rest of the car.
    assert np.allclose(growth[1:], 1.5, rtol=0, atol=0.1)
