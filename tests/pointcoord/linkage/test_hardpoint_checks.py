"""Hardpoints put on a topology: what is refused, and that neither place nor size costs a digit."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_cars import GENERAL_STRUT, SampleCar, by_car

from pointcoord import MechanismError, Scene, simulate
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.mechanism import mechanism_file
from pointcoord.method import NEWTON, SERIES, Method

COLLINEAR = mechanism_file("macpherson").topology("collinear", points=Scene.load("bounce").mechanism.points)
Points = dict[str, tuple[float, float, float]]
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}


def test_a_point_that_is_missing_or_no_number_is_refused_by_name(table: Points) -> None:
    for place in ((1.0, np.nan, 2.0), (1.0, 2.0)):
        with pytest.raises(MechanismError, match=r"point 'strut_top'.*three finite numbers") as caught:
            build_mechanism(COLLINEAR, table | {"strut_top": place}, AXES)
        assert caught.value.names == ("strut_top",)
    without = {name: place for name, place in table.items() if name != "strut_top"}
    with pytest.raises(MechanismError, match="point 'strut_top' is missing; needed: "):
        build_mechanism(COLLINEAR, without, AXES)


@by_car
def test_a_link_without_length_is_refused_by_name(car: SampleCar) -> None:
    start, end = next(ends for c in car.topology.constraints for ends in c.squared_lengths)
    points = {**car.points, start: car.points[end]}
    with pytest.raises(MechanismError, match=r"no length|lie in one line") as caught:
        build_mechanism(car.topology, points, AXES)
    assert {start, end} <= set(caught.value.names)


@pytest.mark.parametrize("size", [0.0, 1e-110, 1e308])
def test_car_without_a_usable_size_is_refused(table: Points, size: float) -> None:
    points = {name: tuple(size * np.sign(place)) for name, place in table.items()}
    with pytest.raises(MechanismError, match="the points span"):
        build_mechanism(COLLINEAR, points, AXES)


far = st.floats(-1e12, 1e12, allow_subnormal=False)


@settings(deadline=None)
@given(shift=st.tuples(far, far, far), seed=st.integers(0, 2**32 - 1))
def test_origin_and_size_are_taken_off_without_rounding(
    table: Points, shift: tuple[float, float, float], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    # What the user gives is rounded at its distance; from there on nothing is lost.
    points = {name: np.array(p) + rng.normal(size=3) + np.array(shift) for name, p in table.items()}
    try:
        mechanism = build_mechanism(COLLINEAR, points, AXES)
    except MechanismError:
        # so far out that rounding has put two points together or in line
        assert max(abs(s) for s in shift) > 1e11
        return
    unit, origin = Fraction(float(mechanism.unit)), mechanism.origin
    for name, place in points.items():
        own = mechanism.drawing.vectors[name]
        for axis in range(3):
            assert Fraction(own[axis]) * unit + Fraction(origin[axis]) == Fraction(place[axis])
        assert np.abs(own).max() < 8.0  # the origin lies near the car, within four of its sizes


@pytest.mark.parametrize(("power", "method"), [(-300, SERIES), (300, NEWTON)], ids=str)
def test_car_scaled_by_a_power_of_two_gives_the_scaled_bits(
    make_scene: Callable[..., Scene], power: int, method: Method
) -> None:
    car, rack = GENERAL_STRUT, np.array([10.0, 30.0, 5.0])
    plain = simulate(make_scene(car=car, rack=rack, samples=5), method)
    scaled = simulate(
        make_scene(
            car=car,
            rack=np.ldexp(rack, power),
            samples=5,
            tolerance=float(np.ldexp(1e-9, power)),
            points={name: np.ldexp(p, power) for name, p in car.points.items()},
        ),
        method,
    )
    for quantity in ("position", "velocity", "acceleration"):
        for name, array in plain.numbers[quantity].items():
            assert np.array_equal(scaled.numbers[quantity][name], np.ldexp(array, power))
    for quantity in ("angular_velocity", "angular_acceleration", "wheel"):
        for name, array in plain.numbers[quantity].items():
            assert np.array_equal(scaled.numbers[quantity][name], array)
