"""What a map covers is on the branch of the suspension's closed form, in 60 digits and written apart."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from mpmath import mpf
from numpy.typing import NDArray
from suspensions_in_closed_form import FORMS, ExactCar, Suspension, rounded

from pointcoord import KinematicMap, NotCovered, Scene, kinematic_map

Array = NDArray[np.float64]
DIGITS = 60


def scene_of(car: ExactCar) -> Scene:
    return Scene.from_mapping(
        {
            "effects": ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster"),
            "mechanism": car.part,
            "inputs": {"arm_angle": {"constant": 1.0}, "rack": {"constant": 0.0}},
            "time": {"start": 0.0, "stop": 0.0, "samples": 1},
        }
    )


def map_near_the_drawing(car: ExactCar, angle: float, travel: float, tolerance: float = 1e-9) -> KinematicMap:
    with mpmath.workdps(DIGITS):
        drawn = [float(value) for value in car.drawn]
    middle = round(drawn[0] * 64) / 64, round(drawn[1] * 8) / 8
    ranges = {
        "arm_angle": (middle[0] - angle, middle[0] + angle),
        "rack": (middle[1] - travel, middle[1] + travel),
    }
    return kinematic_map(scene_of(car), ranges, tolerance)


def at_shares(map: KinematicMap, share: tuple[float, float]) -> tuple[float, float]:
    """Inputs inside a map's range, from -1 to 1 of it to either side of its middle."""
    middles = [0.5 * (low + high) for low, high in map.ranges.values()]
    halves = [0.5 * (high - low) for low, high in map.ranges.values()]
    one, other = (m + s * h for m, s, h in zip(middles, share, halves, strict=True))
    return one, other


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
def test_every_covered_pose_of_a_wide_range_is_on_the_branch_of_the_drawing(form: Suspension) -> None:
    # So wide that assemblies end inside it.
    car = rounded(form.sample_car)
    map = map_near_the_drawing(car, 0.625, 160.0, 1e-6)
    assert 0.3 < map.share_covered < 1.0
    generator = np.random.default_rng(5)
    shares = generator.integers(-1024, 1025, (60, 2)) / 1024
    refused = 0
    for share in shares:
        angle, travel = at_shares(map, tuple(share))
        value = {"arm_angle": angle, "rack": travel}
        with mpmath.workdps(DIGITS):
            pose = car.drawn_pose(angle, travel)
            if not map.covers(value):
                refused += 1
                with pytest.raises(NotCovered):
                    map(value)
                continue
            assert pose is not None
            found = map(value).position
            for name, place in pose.items():
                error = max(abs(mpf(float(a)) - e) for a, e in zip(found[name], place, strict=True))
                assert error <= map.bound.position, (name, float(error))
    assert 0 < refused < len(shares)
