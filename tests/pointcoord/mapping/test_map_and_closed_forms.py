"""What a map gives lies within its proven bounds of the suspension's closed form, rates too.

The closed forms are written apart from the package and evaluated in 60 digits; their rates are differences of
them over 1e-15 s.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from closed_forms import PHASES
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mpf
from numpy.typing import NDArray
from suspensions_in_closed_form import FORMS, ClosedForm, rounded

from pointcoord import AssemblyError, KinematicMap, NotCovered, Scene, kinematic_map

Array = NDArray[np.float64]
State = dict[str, float]
DIGITS, STEP = 60, mpf(10) ** -15
INPUTS = ("arm_angle", "rack", "heave")
# Numbers of few bits, so that sums of them are doubles.
shares = st.tuples(*[st.integers(-64, 64).map(lambda n: n / 64)] * 2)
rates = st.tuples(*[st.integers(-64, 64).map(lambda n: n / 32)] * 3)


def scene_of(form: ClosedForm, car: Any) -> Scene:
    def doubles(vector: Any) -> tuple[float, ...]:
        return tuple(float(c) for c in vector)

    p = {name: np.array(doubles(place)) for name, place in car.points.items()}
    outboard = (p["wheel_centre"] - p["lower_arm_front"]) @ np.array(doubles(car.right))
    return Scene.from_mapping(
        {
            "effects": ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster"),
            "mechanism": {
                "type": form.type,
                "side": "right" if outboard > 0.0 else "left",
                "points": {name: doubles(place) for name, place in car.points.items()},
                "up": doubles(car.up),
                "right": doubles(car.right),
            },
            "inputs": {"arm_angle": {"constant": 1.0}, "rack": {"constant": 0.0}},
            "time": {"start": 0.0, "stop": 0.0, "samples": 1},
        }
    )


def map_near_the_drawing(
    form: ClosedForm, car: Any, angle: float, travel: float, tolerance: float = 1e-9
) -> KinematicMap:
    with mpmath.workdps(DIGITS):
        drawn = [float(value) for value in car.drawn]
    middle = round(drawn[0] * 64) / 64, round(drawn[1] * 8) / 8
    ranges = {
        "arm_angle": (middle[0] - angle, middle[0] + angle),
        "rack": (middle[1] - travel, middle[1] + travel),
    }
    return kinematic_map(scene_of(form, car), ranges, tolerance)


def at_shares(map: KinematicMap, share: tuple[float, float]) -> tuple[float, float]:
    """Inputs inside a map's range, from -1 to 1 of it to either side of its middle."""
    middles = [0.5 * (low + high) for low, high in map.ranges.values()]
    halves = [0.5 * (high - low) for low, high in map.ranges.values()]
    one, other = (m + s * h for m, s, h in zip(middles, share, halves, strict=True))
    return one, other


def exact(car: Any, value: State, rate: State, acceleration: State) -> list[dict[str, Any]] | None:
    """Positions, velocities and accelerations of the closed form where the inputs move like this."""

    def at(t: mpf) -> dict[str, Any] | None:
        now = [mpf(value[n]) + t * mpf(rate[n]) + t * t * mpf(acceleration[n]) / 2 for n in INPUTS]
        pose = car.drawn_pose(*now)
        return None if pose is None else dict(pose.points)

    before, here, after = (at(k * STEP) for k in (-1, 0, 1))
    if before is None or here is None or after is None:
        return None
    speed = {n: [(b - a) / (2 * STEP) for a, b in zip(before[n], after[n], strict=True)] for n in here}
    change = {
        n: [(a - 2 * p + b) / STEP**2 for a, p, b in zip(before[n], here[n], after[n], strict=True)]
        for n in here
    }
    return [here, speed, change]


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
@given(data=st.data())
@settings(max_examples=12, deadline=None, phases=PHASES)
def test_positions_and_rates_lie_within_their_bounds_of_the_closed_form(
    form: ClosedForm, data: st.DataObject
) -> None:
    car = rounded(data.draw(form.cars), form)
    try:
        map = map_near_the_drawing(form, car, 0.125, 16.0)
    except AssemblyError:  # the range begins beyond a dead point of this car
        assume(False)
        raise
    angle, travel = at_shares(map, data.draw(shares))
    speed, change = data.draw(rates), data.draw(rates)
    value = {"arm_angle": angle, "rack": travel, "heave": 3.5}
    rate = {"arm_angle": speed[0], "rack": 16.0 * speed[1], "heave": speed[2]}
    acceleration = {"arm_angle": change[0], "rack": 16.0 * change[1], "heave": change[2]}
    assume(map.covers(value).all())
    found = map(value, rate, acceleration)
    with mpmath.workdps(DIGITS):
        wanted = exact(car, value, rate, acceleration)
        assert wanted is not None, "the map covers inputs at which the car cannot be assembled"
        b = map.bound
        limits = [
            b.position,
            sum(b.velocity[i] * abs(rate[i]) for i in map.inputs),
            sum(b.velocity[i] * abs(acceleration[i]) for i in map.inputs)
            + sum(b.acceleration[i, j] * abs(rate[i] * rate[j]) for i in map.inputs for j in map.inputs),
        ]
        quantities = (found.position, found.velocity, found.acceleration)
        for states, quantity, limit in zip(wanted, quantities, limits, strict=True):
            for name, place in states.items():
                error = max(abs(mpf(float(a)) - e) for a, e in zip(quantity[name], place, strict=True))
                # Adding heave rounds each number once more. The differences are off by some 1e-25.
                size = float(max(abs(c) for c in place))
                assert error <= limit + 2.0**-52 * (size + 8.0) + 1e-20, (name, float(error), limit)


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
def test_every_covered_pose_of_a_wide_range_is_on_the_branch_of_the_drawing(form: ClosedForm) -> None:
    # So wide that assemblies end inside it.
    car = rounded(form.sample_car, form)
    map = map_near_the_drawing(form, car, 0.625, 160.0, 1e-6)
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
            for name, place in pose.points.items():
                error = max(abs(mpf(float(a)) - e) for a, e in zip(found[name], place, strict=True))
                assert error <= map.bound.position, (name, float(error))
    assert 0 < refused < len(shares)
