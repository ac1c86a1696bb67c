"""What holds for every effect of the registry: its value, its bounds, and the laws of turned cars."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from effects_by_hand import BY_HAND, DIFFERENTIATED, DIGITS, Car, Vector, by_hand, cross, plus
from every_effect import NUMBERS_OF_A_CAR, OF_A_WHEEL
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf, workdps
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from pointcoord import Scene
from pointcoord.bounds.enclosed_points import EnclosedPoses
from pointcoord.bounds.proof import ROUNDINGS
from pointcoord.effects.angle import WHEEL
from pointcoord.effects.car_number import CarNumbers
from pointcoord.effects.effect import Effect, Poses
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES, ByEdges
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import ByInput
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.simulation import scene_mechanism

Array = NDArray[np.float64]

Array = NDArray[np.float64]
Numbers = Mapping[str, Mapping[str, Array]]
U = 2.0**-53
RADIUS = 300.0  # mm, of the wheel
DATA = {"axle": 1.0, **NUMBERS_OF_A_CAR}
TIME = 2.0**-3  # s, a unit of time other than a second
# What two wheels make is in test_axles, and what loads do in test_loads. One code differentiates all numbers:
# of those that differ in what they are made of.
EVERY = {
    effect.name: effect
    for effect in (*ALWAYS, *(EFFECTS[name] for name in OF_A_WHEEL))
    if effect.base in ("", *DIFFERENTIATED)
}
each_effect = pytest.mark.parametrize("name", EVERY)
ORDERS = range(len(STATES))


@cache
def mechanism_of(scene: str) -> Mechanism:
    """Far from the user's origin; of a car without a damper its wheel's axis stands for one."""
    mechanism = scene_mechanism(Scene.load(scene))
    topology = mechanism.topology
    topology = replace(topology, roles={"damper": topology.wheel_axis, **topology.roles})
    return replace(mechanism, topology=topology, origin=np.array([4096.0, -2048.0, 1024.0]))


def exactly(values: Array) -> Vector:
    x, y, z = (mpf(float(v)) for v in values)
    return x, y, z


def moving_car(rng: np.random.Generator, mechanism: Mechanism) -> Car:
    """A car of a drawing's shape, turned anyhow against axes of its own, in a rigid motion at an instant."""
    topology, unit = mechanism.topology, float(mechanism.unit)
    axes = Rotation.random(random_state=rng).as_matrix()  # columns: rearward, right, up
    tilt = Rotation.from_rotvec(rng.normal(size=3) * 0.2).as_matrix()
    own = np.random.default_rng(int(1e9 * abs(tilt[0, 1])))
    further = np.random.default_rng(int(1e9 * abs(tilt[0, 2])))
    roll = Rotation.from_rotvec(own.normal(size=3) * 0.2).as_matrix()
    with workdps(DIGITS):
        omega, alpha, speed, hard, place = (exactly(v) for v in 10.0 * rng.normal(size=(5, 3)))
        jolts, jolted = (
            [exactly(v) for v in size * further.normal(size=(len(ORDERS) - 3, 3))] for size in (10.0, 1000.0)
        )
        # The knuckle moves as one body by an input, and every other point by itself.
        turn, other_turn = (exactly(1e-3 * v) for v in own.normal(size=(2, 3)))
        knuckle = (*topology.role("knuckle"), *topology.wheel_axis)
        shifts, other_shifts = (
            {n: v if n in knuckle else plus(v, exactly(own.normal(size=3))) for n in topology.points}
            for v in (exactly(3.0 * axes[:, 2] + own.normal(size=3)), exactly(own.normal(size=3)))
        )
        origin = exactly(mechanism.origin)
        points = {}
        for name in topology.points:
            turned = axes @ tilt @ mechanism.drawing.vectors[name]
            # More digits than a double has, so that its rounding counts.
            p = plus(exactly(unit * turned), exactly(unit * U * rng.normal(size=3)))
            velocity = plus(cross(omega, p), speed)
            acceleration = plus(plus(cross(alpha, p), cross(omega, cross(omega, p))), hard)
            # A car that turns on with this acceleration: p' = omega x p, and so on, each apart.
            carried = [p, cross(omega, p)]
            for n in ORDERS[1:-1]:
                carried.append(plus(cross(omega, carried[n]), cross(alpha, carried[n - 1]), mpf(n)))
            higher = [plus(turned, jolt) for turned, jolt in zip(carried[3:], jolts, strict=True)]
            points[name] = (plus(p, place), velocity, acceleration, *higher)
        in_chassis = {
            name: exactly(unit * (axes @ roll @ mechanism.drawing.vectors[name])) for name in points
        }
        places = {name: state[0] for name, state in points.items()}
        return Car(
            points=points,
            added=[*(exactly(v) for v in 1000.0 * rng.normal(size=(3, 3))), *jolted],
            turn=(omega, alpha),
            bodies=tuple(topology.bodies),
            damper=topology.role("damper"),
            wheel_radius=mpf(RADIUS),
            in_chassis=in_chassis,
            rates_in_chassis={n: plus(cross(alpha, p), speed) for n, p in in_chassis.items()},
            moving={n: plus(shifts[n], cross(turn, p)) for n, p in places.items()},
            moving_in_chassis={n: plus(other_shifts[n], cross(other_turn, p)) for n, p in in_chassis.items()},
            driven_turn=turn,
            origin=origin,
            data={name: mpf(number) for name, number in DATA.items()},
            drawn={name: exactly(unit * mechanism.drawing.vectors[name]) for name in points},
            wheel_axis=topology.wheel_axis,
            steering_axis=topology.steering_axis,
            up=exactly(axes[:, 2]),
            right=exactly(axes[:, 1]),
            outboard=exactly(rng.choice([-1.0, 1.0]) * axes[:, 1]),
        )


def rounded(vector: Vector) -> Array:
    return np.array([float(c) for c in vector])


def axes_of(car: Car) -> CarAxes:
    directions = (rounded(one) for one in (car.up, car.right, car.outboard))
    return CarAxes(*directions, float(car.wheel_radius), {n: float(v) for n, v in car.data.items()})


def poses_of(car: Car, mechanism: Mechanism) -> Poses:
    """The car as a solver would report it, at one instant."""
    states = [{name: rounded(p[d])[None] for name, p in car.points.items()} for d in ORDERS]
    in_chassis = [
        {name: rounded(p)[None] for name, p in of.items()} for of in (car.in_chassis, car.rates_in_chassis)
    ]
    added = [rounded(v)[None] for v in car.added]
    one = tuple({n: rounded(p)[None] for n, p in of.items()} for of in (car.moving, car.moving_in_chassis))
    slopes = dict.fromkeys(map(ByInput, mechanism.topology.required_inputs), one)
    return Poses(mechanism, axes_of(car), states, in_chassis, added, slopes)


def enclosed(vector: Vector, factor: float, off: float = 0.0) -> Enclosed:
    """Where a vector is, to twice the working precision; a double's rounding is expected of it.

    Args:
        off: how far from the middle it is said to be, in a corner of its box.
    """
    with workdps(DIGITS):
        parts = [(float(c), float(c - mpf(float(c)))) for c in vector]
    high, low = (factor * np.array([part]) for part in zip(*parts, strict=True))
    corner = off * np.sign(high[..., ::-1])
    return Enclosed.of(high + corner, low, 8 * U**2 * np.abs(high) + off * (1.0 + 1e-9), U * np.abs(high))


def exact_poses_of(
    car: Car, mechanism: Mechanism, off: Sequence[float] = (0.0,) * len(ORDERS)
) -> EnclosedPoses:
    """The car where it exactly is, or by derivative so far off, in units."""
    unit = float(mechanism.unit)
    points = [{n: enclosed(p[d], TIME**d / unit, off[d]) for n, p in car.points.items()} for d in ORDERS]
    added = [enclosed(v, 1.0) for v in car.added]
    in_chassis = [
        {n: enclosed(p, TIME**d / unit) for n, p in of.items()}
        for d, of in enumerate((car.in_chassis, car.rates_in_chassis))
    ]
    one = tuple(
        {n: enclosed(p, 1.0 / unit) for n, p in of.items()} for of in (car.moving, car.moving_in_chassis)
    )
    slopes = dict.fromkeys(map(ByInput, mechanism.topology.required_inputs), one)
    powers = [np.array([TIME**d]) for d in ORDERS]
    return EnclosedPoses(mechanism, axes_of(car), points, in_chassis, added, powers, slopes)


def parts(numbers: Numbers) -> Iterator[tuple[str, str, Array]]:
    for quantity, arrays in numbers.items():
        for name, array in arrays.items():
            yield quantity, name, array


def apart(found: Array, exact: Sequence[mpf]) -> Array:
    """How far each component is off."""
    with workdps(DIGITS):
        return np.array([float(abs(mpf(float(v)) - x)) for v, x in zip(found.ravel(), exact, strict=True)])


def test_every_effect_is_defined_by_hand_too() -> None:
    assert BY_HAND.keys() == EVERY.keys()


def size_of(effect: Effect, car: Car, mechanism: Mechanism, true: Sequence[mpf]) -> float:
    """What roundings of a number are of: the number, and what it is made of."""
    largest = max(1.0, *(float(abs(c)) for c in true))
    if effect.way and not effect.base:
        # A roll centre is a ratio times how far the wheel is from the user's origin.
        largest = max(largest, float(np.abs(mechanism.origin).max()))
    if effect.base and effect.derivative:
        # A rate is what is left of the points' speeds.
        largest = max(largest, *(float(abs(c)) for states in car.points.values() for c in states[1]))
    if isinstance(effect, CarNumbers) and effect.nowhere:
        # How far a centre is hangs on a turn, which is so much smaller than those it is made of.
        largest *= max(1.0, largest / RADIUS)
    return largest


@each_effect
@settings(deadline=None, max_examples=max(4, settings.default.max_examples // 20))
@given(
    seed=st.integers(0, 2**32 - 1),
    scene=st.sampled_from(["off-axis-strut", "pushrod"]),
    far=st.sampled_from([1e-13, 1e-6, 1.0]),
)
def test_an_effect_is_what_its_definition_says_to_within_its_bounds_and_a_wrong_one_is_not(
    name: str, seed: int, scene: str, far: float
) -> None:
    """Of the points that it names and of no others; what is expected of it does not follow what was found."""
    mechanism, effect, rng = mechanism_of(scene), EVERY[name], np.random.default_rng(seed)
    car = moving_car(rng, mechanism)
    poses, exact, true = poses_of(car, mechanism), exact_poses_of(car, mechanism), by_hand(name, car)
    found = effect.evaluate(poses)
    right = effect.errors(exact, found)
    assert found.keys() == right.keys() == true.keys() == effect.gives_numbers(mechanism.topology).keys()
    for quantity, part, array in parts(found):
        off = apart(array, true[quantity][part])
        proven, expected = right[quantity][part].reshape(2, -1)
        most = 1e-11 * size_of(effect, car, mechanism, true[quantity][part])
        assert (off <= proven).all(), (quantity, part, off, proven)
        assert (off <= ROUNDINGS * expected).all(), (quantity, part, off, expected)
        assert (proven <= most).all(), (quantity, part)
        assert (expected <= most).all(), (quantity, part)
    # An angle that is wrong by a sine above 1/2 is only proven to lie somewhere on the circle.
    wrong = {
        quantity: {
            n: a + far * rng.uniform(0.5, 1.0, a.shape) * np.clip(a, -limit, limit) for n, a in arrays.items()
        }
        for quantity, arrays in found.items()
        for limit in (0.5 if quantity == WHEEL.name else np.inf,)
    }
    bounds = effect.errors(exact, wrong)
    for quantity, part, array in parts(wrong):
        off = apart(array, true[quantity][part])
        proven, expected = bounds[quantity][part].reshape(2, -1)
        assert (off <= proven).all(), (quantity, part)
        assert (proven <= 2.0 * off + 1e-11 * np.abs(array).max()).all(), (quantity, part)
        if far < 1e-3:
            assert expected == pytest.approx(right[quantity][part].reshape(2, -1)[1], rel=1e-3)
    needed = effect.needs(mechanism.topology)
    states, in_chassis = (
        [{n: state for n, state in of.items() if n in needed} for of in every]
        for every in (poses.states[: effect.derivative + 1], poses.in_chassis)
    )
    alone = effect.evaluate(replace(poses, states=states, in_chassis=in_chassis))
    for quantity, part, array in parts(alone):
        assert np.array_equal(array, found[quantity][part])
        assert QUANTITIES[quantity] in effect.quantities
        assert not effect.own_names or part in effect.own_names


@each_effect
def test_its_proof_covers_points_that_may_be_anywhere_in_their_boxes(name: str) -> None:
    """By derivative, what is made of it is as unsure as the points are, and what is not stays as it is."""
    mechanism, effect = mechanism_of("pushrod"), EVERY[name]
    for derivative in ORDERS[: effect.derivative + 2]:
        car, off = moving_car(np.random.default_rng(derivative), mechanism), [0.0] * len(ORDERS)
        off[derivative] = 1e-7
        found, true = effect.evaluate(poses_of(car, mechanism)), by_hand(name, car)
        unsure, most = effect.errors(exact_poses_of(car, mechanism, off), found), 0.0
        for quantity, part, array in parts(found):
            proven = unsure[quantity][part].reshape(2, -1)[0]
            assert (apart(array, true[quantity][part]) <= proven).all(), (quantity, part)
            if derivative > effect.derivative or (effect.reports_states and derivative < effect.derivative):
                assert (proven <= 1e-11 * max(4096.0, np.abs(array).max())).all()
            most = max(most, proven.max())
        assert derivative != effect.derivative or most >= 1e-9


class Lossless(ByEdges):
    """As if the formula lost nothing."""

    def loss(self, edges: tuple[Array, Array], rates: tuple[Array, Array]) -> Array:
        return np.ones((len(edges[0]), 1))


def test_of_a_needle_that_turns_as_much_more_is_expected_as_its_formula_loses() -> None:
    mechanism = mechanism_of("double-wishbone")
    (body,) = mechanism.topology.bodies
    first, second, third, *_ = mechanism.topology.bodies[body]
    rng = np.random.default_rng(8)
    for thin, least in ((1e-7, 50.0), (1e-6, 1.5), (0.3, 1.0)):
        car = moving_car(rng, mechanism)
        start, end = (rounded(car.points[name][0]) for name in (first, second))
        off = 0.4 * (end - start) + thin * np.cross(end - start, rng.normal(size=3))
        place, (omega, alpha) = exactly(start + off), car.turn
        with workdps(DIGITS):
            position, speed, hard, *rest = car.points[first]
            arm = plus(place, position, -1)
            velocity = plus(speed, cross(omega, arm))
            acceleration = plus(plus(hard, cross(alpha, arm)), cross(omega, cross(omega, arm)))
        car.points[third] = (place, velocity, acceleration, *rest)
        poses, numbers = exact_poses_of(car, mechanism), KNUCKLE_RATES.evaluate(poses_of(car, mechanism))
        edges = rounded(car.points[second][0]) - start, rounded(place) - start
        k = (np.dot(edges[0], edges[0]) + np.dot(edges[1], edges[1])) / np.linalg.norm(np.cross(*edges))
        loss = 1.0 + 4e3 * 2.0 * U * k**2
        assert loss >= least
        said, plain = (
            replace(KNUCKLE_RATES, formula=formula).errors(poses, numbers)["angular_velocity"][body][1]
            for formula in (ByEdges(), Lossless())
        )
        off = apart(numbers["angular_velocity"][body], car.turn[0])
        assert (off <= ROUNDINGS * said).all()
        np.testing.assert_allclose(said, loss * plain, rtol=1e-3)
