"""Positions, rates and assemblies held to closed forms that were written apart from the package."""

from __future__ import annotations

from fractions import Fraction

import pytest
from exact_vectors import Points, number, numbers
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mpf
from stencils import OFF, close, derivatives, seven
from suspensions_in_closed_form import PHASES, PLAIN, RANDOM, ExactCar

from validate.reference import InfeasibleError
from validate.reference.vectors import cross, minus, plus

WITHIN = mpf("1e-100")  # rounding of the closed form with 150 digits, next to a dead point too

travels = st.fractions(-30, 30, max_denominator=64)
angles = st.fractions(Fraction(-1, 4), Fraction(1, 4), max_denominator=512)
rates = st.fractions(-3, 3, max_denominator=16)


def apart(one: Points, other: Points) -> mpf:
    """Greatest difference of a coordinate, mm."""
    return max(abs(x) for name in one for x in minus(one[name], numbers(other[name])))


def drawn(kind: str, data: st.DataObject) -> ExactCar:
    """A random car."""
    return data.draw(RANDOM[kind])


@pytest.mark.parametrize("kind", RANDOM)
@given(data=st.data(), turn=angles, travel=travels, heave=travels)
@settings(max_examples=8, deadline=None, phases=PHASES)
def test_the_pose_is_the_closed_form_s_to_the_proven_radius(
    kind: str, data: st.DataObject, turn: Fraction, travel: Fraction, heave: Fraction
) -> None:
    car = drawn(kind, data)
    theta, rack = car.drawn[0] + number(turn), car.drawn[1] + number(travel)
    inputs = {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0), "heave": (heave, 0, 0)}
    pose = car.drawn_pose(theta, rack, number(heave))
    if pose is None:
        with pytest.raises(InfeasibleError):
            car.solve(inputs)
        return
    reference = car.solve(inputs)
    assert set(reference.position) == set(pose)
    assert apart(reference.position, pose) <= reference.error_bound["position"] + WITHIN
    assert reference.error_bound["position"] < reference.radius < mpf("1e-55")


@pytest.mark.parametrize("kind", RANDOM)
@given(data=st.data())
@settings(max_examples=8, deadline=None, phases=PHASES)
def test_what_is_drawn_comes_back(kind: str, data: st.DataObject) -> None:
    car = drawn(kind, data)
    closed = car.close()
    bound = closed.instant.error_bound["position"]
    assert apart(closed.instant.position, car.points) <= bound + WITHIN
    for got, want in zip((closed.inputs["arm_angle"], closed.inputs["rack"]), car.drawn, strict=True):
        assert abs(got - want) < mpf("1e-70")
    again = car.solve({name: (value, 0, 0) for name, value in closed.inputs.items()})
    assert apart(again.position, car.points) <= again.radius


@pytest.mark.parametrize("kind", RANDOM)
@given(data=st.data(), law=st.tuples(*[rates] * 6), heave=st.tuples(*[rates] * 3))
@settings(max_examples=5, deadline=None, phases=PHASES)
def test_velocities_and_accelerations_are_the_derivatives_of_the_closed_form(
    kind: str, data: st.DataObject, law: tuple[Fraction, ...], heave: tuple[Fraction, ...]
) -> None:
    car = drawn(kind, data)
    theta, rack = car.drawn
    w, a, v, b, *_ = numbers(law[:3]) + numbers(law[3:])
    values = {
        "arm_angle": (theta + w / 64, w, a),
        "rack": (rack + 8 * v, 40 * v, 30 * b),
        "heave": tuple(10 * x for x in numbers(heave)),
    }

    def at(t: mpf) -> Points | None:
        inputs = [x + y * t + z * t * t / 2 for x, y, z in values.values()]
        return car.drawn_pose(*inputs)

    moments = seven(at)
    assume(None not in moments)
    reference = car.solve(values, digits=100)
    # Next to a dead point the points are fast, and the eighth derivative is no longer small.
    assume(max(abs(x) for v in reference.velocity.values() for x in v) < 1e4)
    for name in car.points:
        rate, bend = derivatives([moment[name] for moment in moments])
        assert close(reference.velocity[name], rate, OFF)
        assert close(reference.acceleration[name], bend, OFF)


@pytest.mark.parametrize("kind", RANDOM)
@given(data=st.data(), law=st.tuples(*[rates] * 6))
@settings(max_examples=5, deadline=None, phases=PHASES)
def test_one_turn_explains_all_points_of_a_body(
    kind: str, data: st.DataObject, law: tuple[Fraction, ...]
) -> None:
    car = drawn(kind, data)
    theta, rack = car.drawn
    now = car.solve({"arm_angle": (theta, *law[:2]), "rack": (rack, *law[2:4]), "heave": (0, *law[4:])})
    assert set(now.angular_velocity) == set(car.bodies)
    for body, points in car.bodies.items():
        omega, alpha = now.angular_velocity[body], now.angular_acceleration[body]
        for name in points[1:]:
            r, v, a = (minus(q[name], q[points[0]]) for q in (now.position, now.velocity, now.acceleration))
            assert close(v, cross(omega, r), mpf("1e-45"))
            assert close(a, plus(cross(alpha, r), cross(omega, cross(omega, r))), mpf("1e-45"))


@pytest.mark.parametrize("kind", PLAIN)
@pytest.mark.parametrize("turn", ["-0.3", "-0.1", "0", "0.1", "0.3"])
def test_the_search_finds_the_closed_form_s_assemblies_and_no_other(kind: str, turn: str) -> None:
    car = PLAIN[kind]
    theta, rack = car.drawn[0] + mpf(turn), car.drawn[1] + 11
    inputs = {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)}
    listed = car.count(inputs, starts=600)
    known = [*car.poses(theta, rack)]
    # The strut's rod may also point the other way along its axis, which the closed form leaves out.
    ways = 2 if car.suspension == "macpherson" else 1
    assert len(listed.found) == ways * len(known) > 0
    for one in listed.found:
        place = {name: p for name, p in one.position.items() if name != "strut_rod_end"}
        assert min(apart(place, other) for other in known) <= one.error_bound["position"] + WITHIN
