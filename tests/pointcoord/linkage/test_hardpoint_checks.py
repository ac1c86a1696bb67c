"""Hardpoints put on a topology: what is refused, and that neither place nor size costs a digit."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_cars import SAMPLES, SampleCar, by_car

from pointcoord import MechanismError, Scene, UnknownName, simulate
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file
from pointcoord.method import NEWTON, SERIES, Method
from pointcoord.numerics.linear import null_directions

COLLINEAR = mechanism_file("macpherson").topology("collinear", points=Scene.load("bounce").mechanism.points)

Points = dict[str, tuple[float, float, float]]
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
LINKS = [c for c in COLLINEAR.constraints if isinstance(c, Link)]
EVERY_LINK = [(car, c) for car in SAMPLES for c in car.topology.constraints if isinstance(c, Link)]
by_link = pytest.mark.parametrize(
    ("car", "link"), EVERY_LINK, ids=[f"{car.name} {link.name}" for car, link in EVERY_LINK]
)


def without(*left_out: Link, topology: Topology = COLLINEAR) -> Topology:
    return replace(topology, constraints=tuple(c for c in topology.constraints if c not in left_out))


def doubled(topology: Topology, link: Link) -> Topology:
    return replace(topology, constraints=(*topology.constraints, Link(link.end, link.start)))


@by_link
def test_missing_link_is_under_determined_and_the_free_coordinates_are_named(
    car: SampleCar, link: Link
) -> None:
    whole = car.topology
    n = whole.layout.unknowns
    expected = f"under-determined: {n} unknowns, {n - 1} equations; free"
    with pytest.raises(MechanismError, match=expected) as caught:
        build_mechanism(without(link, topology=whole), car.points, AXES)
    # An own null space from the drawing: with that row gone exactly one direction is free.
    mechanism = car.mechanism()
    jacobian = np.delete(mechanism.map.jacobian(mechanism.drawn), whole.labels.index(link.name), axis=0)
    free = np.abs(np.linalg.svd(jacobian)[2][-1])
    moving = {whole.layout.describe(i) for i in np.flatnonzero(free > 0.1 * free.max())}
    assert set(caught.value.names) == moving
    assert all(name in str(caught.value) for name in moving)


def test_without_the_tie_rod_the_knuckle_is_free_to_turn_and_the_arm_is_not(table: Points) -> None:
    tie_rod = next(link for link in LINKS if "tie_rod_inner" in (link.start, link.end))
    with pytest.raises(MechanismError) as caught:
        build_mechanism(without(tie_rod), table, AXES)
    assert any("tie_rod_outer" in name for name in caught.value.names)
    assert not any("lower_ball_joint" in name.split(" of ")[-1] for name in caught.value.names)


@by_link
def test_doubled_link_is_over_determined_and_both_rows_are_named(car: SampleCar, link: Link) -> None:
    n = car.topology.layout.unknowns
    with pytest.raises(MechanismError, match=f"over-determined: {n} unknowns, {n + 1} equations") as caught:
        build_mechanism(doubled(car.topology, link), car.points, AXES)
    assert set(caught.value.names) == {f"link {link.start} - {link.end}", f"link {link.end} - {link.start}"}


def test_as_many_equations_as_unknowns_but_one_twice_is_not_determined(table: Points) -> None:
    tie_rod = next(link for link in LINKS if "tie_rod_inner" in (link.start, link.end))
    arm = LINKS[0]
    with pytest.raises(MechanismError, match="not determined: 17 unknowns, 17 equations") as caught:
        build_mechanism(doubled(without(tie_rod), arm), table, AXES)
    assert "free at the drawing" in str(caught.value)
    assert any("tie_rod_outer" in name for name in caught.value.names)
    assert {arm.name, f"link {arm.end} - {arm.start}"} <= set(caught.value.names)


@by_car
def test_drawn_mechanism_is_determined(car: SampleCar) -> None:
    mechanism = car.mechanism()
    free, redundant = null_directions(mechanism.map.jacobian(mechanism.drawn))
    assert len(free) == len(redundant) == 0


@by_link
def test_link_without_length_is_refused_by_name(car: SampleCar, link: Link) -> None:
    points = {**car.points, link.start: car.points[link.end]}
    with pytest.raises(MechanismError, match=r"no length|lie in one line") as caught:
        build_mechanism(car.topology, points, AXES)
    assert {link.start, link.end} <= set(caught.value.names)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", ["strut_top", "tie_rod_outer", "wheel_centre"])
def test_number_that_is_not_finite_is_refused_by_name(table: Points, name: str, bad: float) -> None:
    with pytest.raises(MechanismError, match=f"point '{name}'.*three finite numbers") as caught:
        build_mechanism(COLLINEAR, table | {name: (1.0, bad, 2.0)}, AXES)
    assert caught.value.names == (name,)


def test_point_with_two_coordinates_is_refused_by_name(table: Points) -> None:
    with pytest.raises(MechanismError, match=r"point 'strut_top'.*three finite numbers"):
        build_mechanism(COLLINEAR, {**table, "strut_top": (1.0, 2.0)}, AXES)


@by_car
def test_missing_point_is_refused_by_name(car: SampleCar) -> None:
    for name in car.topology.required_points:
        points = {other: place for other, place in car.points.items() if other not in (name, "rack_centre")}
        if name == car.topology.stand_ins["rack_centre"]:
            points["rack_centre"] = car.points[name]
        with pytest.raises(MechanismError, match=f"point '{name}' is missing; needed: ") as caught:
            build_mechanism(car.topology, points, AXES)
        assert all(point in str(caught.value) for point in car.topology.required_points)


def test_missing_and_unknown_directions_are_refused_by_name(table: Points) -> None:
    with pytest.raises(MechanismError, match="direction 'right' is missing"):
        build_mechanism(COLLINEAR, table, {"up": AXES["up"]})
    with pytest.raises(UnknownName, match=r"direction.*'forward'.*up, right"):
        build_mechanism(COLLINEAR, table, AXES | {"forward": (1.0, 0.0, 0.0)})


def test_unknown_point_is_refused_with_the_names_that_exist(table: Points) -> None:
    with pytest.raises(UnknownName, match="did you mean 'strut_top'") as caught:
        build_mechanism(COLLINEAR, {**table, "strut_topp": (0.0, 0.0, 0.0)}, AXES)
    assert set(caught.value.valid) == set(COLLINEAR.points)


def test_carriers_in_line_are_refused_by_name(table: Points) -> None:
    lower, upper = (np.array(table[name]) for name in ("lower_ball_joint", "strut_lower"))
    with pytest.raises(MechanismError, match="in one line, so they cannot carry wheel_centre") as caught:
        build_mechanism(COLLINEAR, table | {"tie_rod_outer": tuple(lower + 4.0 * (upper - lower))}, AXES)
    assert set(caught.value.names) == {"lower_ball_joint", "tie_rod_outer", "strut_lower"}


@pytest.mark.parametrize("size", [0.0, 1e-110, 1e110, 1e308])
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


def test_car_a_thousand_kilometres_away_moves_as_at_home(
    table: Points, make_scene: Callable[..., Scene]
) -> None:
    shift = np.array([1e9, -1e9, 3e9])  # whole millimetres: the moved table is exact
    home = simulate(make_scene())
    away = simulate(make_scene(points={name: np.array(p) + shift for name, p in table.items()}))
    near, out = home.proof(), away.proof()
    for name in table:
        for axis in range(3):
            # Both poses are within their proven bounds, which hold the shift's rounding at that distance.
            gap = np.abs(away.position[name][:, axis] - (home.position[name][:, axis] + shift[axis]))
            assert (gap <= near.bound + out.bound + np.spacing(np.abs(shift[axis]))).all()
        # Rates know nothing of the distance. Both cars lie differently in their units, so the poses
        # differ by rounding: eps, times the condition number, twice for the two solves in a row.
        rounding = 8 * np.finfo(float).eps * (near.condition.max() + out.condition.max())
        for quantity in ("velocity", "acceleration"):
            fast = max(np.abs(v).max() for v in getattr(home, quantity).values())
            gap = np.abs(getattr(away, quantity)[name] - getattr(home, quantity)[name])
            # and the series' truncation, the tolerance relative to the size of the car
            assert gap.max() <= (rounding * near.condition.max() + 1e-9 / 512) * max(fast, 1.0)


@pytest.mark.parametrize("power", [-300, -40, -1, 1, 10, 300])
@pytest.mark.parametrize("method", [SERIES, NEWTON], ids=str)
@by_car
def test_car_scaled_by_a_power_of_two_gives_the_scaled_bits(
    car: SampleCar, make_scene: Callable[..., Scene], power: int, method: Method
) -> None:
    rack = np.array([10.0, 30.0, 5.0])
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
        for name in car.points:
            expected = np.ldexp(getattr(plain, quantity)[name], power)
            assert np.array_equal(getattr(scaled, quantity)[name], expected)
    for quantity in ("angular_velocity", "angular_acceleration"):
        assert np.array_equal(getattr(scaled, quantity)["knuckle"], getattr(plain, quantity)["knuckle"])
    for angle in plain.wheel:
        assert np.array_equal(scaled.wheel[angle], plain.wheel[angle])


@by_car
@pytest.mark.parametrize("size", [1.0, 1e-3, 7e5])
def test_the_unit_is_the_next_power_of_two_above_the_longest_side_of_the_car(
    car: SampleCar, size: float
) -> None:
    places = {name: size * np.array(place) for name, place in car.points.items()}
    longest = float(np.ptp(np.array([*places.values()]), axis=0).max())
    unit = float(car.mechanism(places).unit)
    assert np.frexp(unit)[0] == 0.5
    assert unit / 2.0 <= longest < unit


@by_car
def test_batch_of_cars_is_each_of_them(car: SampleCar) -> None:
    factors = np.array([0.5, 1.0, 3.0])
    batch = car.mechanism({name: factors[:, None] * np.array(p) for name, p in car.points.items()})
    for i, factor in enumerate(factors):
        one = car.mechanism({name: factor * np.array(p) for name, p in car.points.items()})
        assert np.array_equal(batch.drawn[i], one.drawn)
        assert np.array_equal(batch.origin[i], one.origin)
        assert batch.unit[i] == one.unit
        # Directions are the same for all of them, points are not.
        alone = batch.taken(i)
        for name, place in one.drawing.vectors.items():
            assert np.array_equal(alone.drawing.vectors[name], place)
        for part in ("drawn", "drawn_lacks", "drawn_doubt", "origin", "unit"):
            assert np.array_equal(getattr(alone, part), getattr(one, part))
        some = batch.taken(np.array([i, 0]))
        assert np.array_equal(some.drawn, batch.drawn[[i, 0]])
