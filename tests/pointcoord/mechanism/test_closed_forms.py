"""Every number of a motion lies within its proven bound of the suspension's closed form, rates too.

The closed forms are written apart from the package and evaluated in 60 digits; their rates are differences of
them over 1e-15 s.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from exact_vectors import number, numbers
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mpf
from suspensions_in_closed_form import FORMS, PHASES, ExactCar, Suspension, rounded

from pointcoord import AssemblyError, Scene, simulate
from pointcoord.method import METHODS
from validate.reference.vectors import cross, dot, minus

Points = dict[str, Any]
Law = tuple[float, float, float]
DIGITS, STEP = 60, mpf(10) ** -15
# Numbers of few bits, so that the laws' values and rates at the instants are doubles.
coefficients = st.integers(-32, 32).map(lambda n: n / 64)
laws = st.tuples(coefficients, coefficients)


def scene_of(car: ExactCar, inputs: dict[str, Law], samples: int) -> Scene:
    return Scene.from_mapping(
        {
            "effects": ("velocity", "acceleration", "knuckle_rates", "wheel_angles"),
            "mechanism": car.part,
            "inputs": {name: {"polynomial": law} for name, law in inputs.items()},
            "time": {"start": 0.0, "stop": 0.5 if samples > 1 else 0.0, "samples": samples},
        }
    )


def exact(
    form: Suspension, car: ExactCar, inputs: dict[str, Law], instant: float
) -> dict[str, dict[str, Any]]:
    """Every quantity by name, each a list of numbers of many digits."""

    def at(t: mpf) -> Points:
        theta, travel, heave = (
            sum((mpf(c) * t**k for k, c in enumerate(inputs[name])), mpf(0))
            for name in ("arm_angle", "rack", "heave")
        )
        pose = car.drawn_pose(theta, travel, heave)
        assert pose is not None
        return dict(pose)

    before, here, after = (at(mpf(instant) + k * STEP) for k in (-1, 0, 1))
    speed = {n: [(b - a) / (2 * STEP) for a, b in zip(before[n], after[n], strict=True)] for n in here}
    change = {
        n: [(a - 2 * p + b) / STEP**2 for a, p, b in zip(before[n], here[n], after[n], strict=True)]
        for n in here
    }
    spin, turn = body_rates(form, here, speed, change)
    up = numbers(car.up)
    side = 1 if dot(minus(here["wheel_centre"], here["lower_arm_front"]), numbers(car.right)) > 0 else -1
    outboard = tuple(side * c for c in numbers(car.right))
    spindle = minus(here["wheel_centre"], here["wheel_axis_inner"])
    lower, upper = (here[name] for name in form.steering_axis)
    axis = minus(upper, lower)
    return {
        "position": {n: list(p) for n, p in here.items()},
        "velocity": speed,
        "acceleration": change,
        "angular_velocity": {"knuckle": spin},
        "angular_acceleration": {"knuckle": turn},
        "wheel": {
            "camber": [mpmath.atan2(-dot(spindle, up), dot(spindle, outboard))],
            "kingpin": [mpmath.atan2(-dot(axis, outboard), dot(axis, up))],
        },
    }


def body_rates(form: Suspension, place: Points, speed: Points, change: Points) -> tuple[Any, Any]:
    """omega and alpha from the rates of two edges and of their normal: E' = omega x E, and once more."""

    def edges(states: Points) -> tuple[Any, Any]:
        base, first, second = (tuple(states[name]) for name in form.knuckle)
        return minus(first, base), minus(second, base)

    def turning(e: tuple[Any, Any], rate: tuple[Any, Any]) -> Any:
        """w with w x e_i = rate_i: its components along e1 x e2, e1 and e2, as in a dual frame."""
        normal = cross(*e)
        # (w x e1) . e2 = w . (e1 x e2), (w x e1) . n and (w x e2) . n give w . e2 and w . e1.
        square = dot(normal, normal)
        parts = (
            dot(rate[0], e[1]) / square,
            -dot(rate[0], normal) / square,
            dot(rate[1], normal) / square,
        )
        return tuple(
            parts[0] * n + parts[1] * second + parts[2] * first
            for n, first, second in zip(normal, e[0], e[1], strict=True)
        )

    e, rate, second = edges(place), edges(speed), edges(change)
    omega = turning(e, rate)
    pull = tuple(minus(a, cross(omega, cross(omega, edge))) for a, edge in zip(second, e, strict=True))
    return omega, turning(e, pull)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
@settings(deadline=None, max_examples=max(12, settings.default.max_examples // 8), phases=PHASES)
@given(data=st.data(), arm=laws, rack=laws, heave=laws, away=coefficients)
def test_every_number_is_within_its_proven_bound_of_the_closed_form(
    form: Suspension,
    method: Any,
    data: st.DataObject,
    arm: tuple[float, float],
    rack: tuple[float, float],
    heave: tuple[float, float],
    away: float,
) -> None:
    with mpmath.workdps(DIGITS):
        car = rounded(data.draw(form.cars))
        theta, travel = car.drawn
        first = round(float(theta) * 64) / 64 + 0.5 * away
        inputs = {
            "arm_angle": (first, *(0.5 * c for c in arm)),
            "rack": (round(float(travel)) + 20.0 * away, *(64.0 * c for c in rack)),
            "heave": (0.0, *(64.0 * c for c in heave)),
        }
        try:
            motion = simulate(scene_of(car, inputs, 3), method)
        except AssemblyError:
            assume(False)
        proven = motion.proof(rates=True).proven
        for place, instant in enumerate(motion.times.tolist()):
            for quantity, parts in exact(form, car, inputs, instant).items():
                channel = getattr(motion, quantity)
                assert set(channel) == set(parts)
                for name, values in parts.items():
                    reported = np.atleast_1d(channel[name][place])
                    bounds = np.atleast_1d(proven[quantity][name][place])
                    for value, found, bound in zip(values, reported, bounds, strict=True):
                        # The bound takes each law's value rounded once; these laws round nothing. What the
                        # differences leave out is STEP^2 of a rate's own size, far below a double's digits.
                        assert abs(value - number(float(found))) <= mpf(float(bound)) + 1e-25
