"""The pieces of error bounds, each against what it bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import GENERAL_STRUT, SampleCar, by_car

from pointcoord import Scene, simulate
from pointcoord.bounds.body_fixed import carried_errors
from pointcoord.bounds.certified_poses import CertifiedPoses, Certifier
from pointcoord.bounds.enclosed_points import _weights
from pointcoord.bounds.enclosed_rates import Summed
from pointcoord.bounds.proof import _reported_bound, _sharpened
from pointcoord.linkage.drives import Travel
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import Pair
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.rounding import UNIT_ROUNDOFF as U
from pointcoord.results.states import StatesOfChain
from pointcoord.solve.assembly import assemble

Array = NDArray[np.float64]
Local = Mapping[str, Pair]


def pose_and_carried(car: SampleCar) -> tuple[Mechanism, Array, dict[str, Pair]]:
    """A pose, (size, 1), and its carried points as they are computed."""
    mechanism = car.mechanism()
    y = assemble(mechanism, {name: np.array(value) for name, value in near(car).items()}).y
    places = mechanism.places(y)
    local = {name: (places[name][:, None], np.zeros((3, 1))) for name in mechanism.topology.carried}
    return mechanism, y[:, None], local


def near(car: SampleCar) -> dict[str, float]:
    drawn = car.drawn_inputs
    return {"arm_angle": drawn["arm_angle"] + 0.03, "rack": drawn["rack"] + 5.0}


def certified(unknowns: int, **parts: Any) -> CertifiedPoses:
    found = CertifiedPoses(np.zeros((unknowns, 1)), np.zeros((unknowns, 1)), *(np.zeros(1) for _ in range(4)))
    for name, part in parts.items():
        setattr(found, name, part)
    return found


def by_coordinate(mechanism: Mechanism, y: Array, name: str) -> Array:
    """How a carried point moves with each unknown coordinate, (3, unknowns): of squares exactly."""
    columns = []
    for k in range(mechanism.map.unknowns):
        ends = []
        for step in (0.25, -0.25):
            moved = y[:, 0].copy()
            moved[k] += step
            ends.append(mechanism.places(moved)[name])
        columns.append((ends[0] - ends[1]) / 0.5)
    return np.stack(columns, axis=-1)


def bound_of(
    mechanism: Mechanism, y: Array, local: Local, found: CertifiedPoses, shifted: float = 0.0
) -> tuple[float, float]:
    bound, gain = carried_errors(mechanism, y, local, found, np.full((3, 1), shifted))
    return float(bound[0]), float(gain[0])


@by_car
def test_a_carried_point_is_off_by_what_its_carriers_are_and_no_more(car: SampleCar) -> None:
    mechanism, y, local = pose_and_carried(car)
    unknowns = mechanism.map.unknowns
    generator = np.random.default_rng(3)
    nothing = certified(unknowns)
    for name, place in local.items():
        one = {name: place}
        table = by_coordinate(mechanism, y, name)
        rounding, gain = bound_of(mechanism, y, one, nothing)
        assert rounding <= 60.0 * U  # of numbers below 1, beside what the weights leave
        assert gain == pytest.approx(max(1.0, np.abs(table).sum(axis=-1).max()), rel=1e-5)
        for _ in range(20):
            size = 1e-8 * 10.0 ** generator.uniform(-3.0, 0.0, (unknowns, 1))
            step = size * generator.choice([-1.0, 1.0], size.shape)
            for part, moved in (
                ({"step": step}, np.abs(table @ step)),
                ({"spread": size}, np.abs(table) @ size),
                ({"tail": size[0]}, np.abs(table).sum(axis=-1) * size[0]),
            ):
                bound, _ = bound_of(mechanism, y, one, certified(unknowns, **part))
                wanted = float(moved.max()) + rounding
                assert bound == pytest.approx(wanted, rel=1e-5, abs=100.0 * U * float(size.max()))
    # What was added to report it comes to all this, and so does what the reported place is off.
    plain, _ = bound_of(mechanism, y, local, nothing)
    assert bound_of(mechanism, y, local, nothing, 1e-9)[0] == pytest.approx(plain + 1e-9, rel=1e-5)
    for part in (0, 1):
        off = {name: list(place) for name, place in local.items()}
        for pair in off.values():
            pair[part] = pair[part] + np.array([[0.0], [0.0], [-1e-9]])
        places = {name: (pair[0], pair[1]) for name, pair in off.items()}
        assert bound_of(mechanism, y, places, nothing)[0] == pytest.approx(1e-9, rel=1e-5)


@by_car
def test_of_several_carried_points_the_worst_counts_and_none_without_a_proof(car: SampleCar) -> None:
    mechanism, y, local = pose_and_carried(car)
    unknowns = mechanism.map.unknowns
    step = 1e-6 * np.random.default_rng(5).normal(size=(unknowns, 1))
    found = certified(unknowns, step=step)
    each = [bound_of(mechanism, y, {name: place}, found) for name, place in local.items()]
    assert bound_of(mechanism, y, local, found) == tuple(map(max, zip(*each, strict=True)))
    assert bound_of(mechanism, y, {}, found) == (0.0, 1.0)
    assert bound_of(mechanism, y, local, replace(found, radius=np.array([np.inf])))[0] == np.inf


@by_car
def test_edges_that_are_far_off_turn_no_point_by_more_than_is_said(car: SampleCar) -> None:
    """Every corner of a large ball of three carriers: its square counts."""
    mechanism, y, local = pose_and_carried(car)
    unknowns, radius = mechanism.map.unknowns, 0.25
    found = certified(unknowns, tail=np.array([radius]), radius=np.array([radius]))
    for name, place in local.items():
        bound, _ = bound_of(mechanism, y, {name: place}, found)
        moving = [
            index
            for carrier in mechanism.topology.carried[name]
            for index in mechanism.layout.vector(carrier)
            if index < unknowns
        ]
        corners = np.array(list(product((-radius, radius), repeat=len(moving))))
        moved = np.repeat(y.T, len(corners), axis=0)
        moved[:, moving] += corners
        apart = np.abs(mechanism.places(moved)[name] - place[0].T).max()
        assert apart <= bound
        assert bound <= 3.0 * apart


def test_the_rounding_of_a_step_of_any_size_is_in_the_bound_of_a_carried_point() -> None:
    """|sum K_i e_i| of rational numbers, of bodies so small that only the step is rounded."""
    for seed in range(200):
        generator = np.random.default_rng(seed)
        weights = 10.0 ** generator.uniform(-4.0, 4.0, 3) * generator.choice([-1.0, 1.0], 3)
        y = generator.normal(size=(9, 1)) * 10.0 ** generator.uniform(-9.0, -6.0)
        step = generator.normal(size=(9, 1))
        bound, moved = of_a_rider(weights, y, step)
        assert moved <= Fraction(bound)
        assert bound <= float(moved) * (1.0 + 1e-5) + 1e-10 * np.abs(weights).max()


def test_a_step_that_cancels_is_bounded_by_the_roundings_of_its_products() -> None:
    """Bodies are so small beside the step that nothing else is rounded."""
    far = 1e6
    for seed in range(200):
        generator = np.random.default_rng(seed)
        weights = 10.0 ** generator.uniform(-4.0, 2.0, 3) * generator.choice([-1.0, 1.0], 3)
        y = generator.normal(size=(9, 1))
        step = far * generator.uniform(-1.0, 1.0, size=(9, 1))
        e1, e2 = y[3:6, 0] - y[:3, 0], y[6:, 0] - y[:3, 0]
        # The point by the first carrier is what the two others are by the second and third, taken back.
        a, b, c = weights
        tables = [a * np.eye(3) - c * skew(e2), b * np.eye(3) + c * skew(e1)]
        first = np.eye(3) - sum(tables)
        rest = tables[0] @ step[3:6, 0] + tables[1] @ step[6:, 0]
        step[:3, 0] = -np.linalg.solve(first, rest)
        bound, moved = of_a_rider(weights, y, step)
        assert moved <= Fraction(bound)
        largest = np.abs(step).max()
        products = 1.0 + 2.0 * (abs(a) + abs(b) + 2.0 * abs(c) * (np.abs(e1) + np.abs(e2)).max())
        # 32 of them, and what is left of the step itself.
        assert bound <= 1.001 * float(moved) + 44.0 * U * products * largest


def of_a_rider(weights: Array, y: Array, step: Array) -> tuple[float, Fraction]:
    """The bound of a point that three others carry, and how far a step of theirs moves it."""
    base, first, second = (y[k : k + 3, 0] for k in (0, 3, 6))
    exact = [[Fraction(float(v)) for v in part] for part in (base, first, second)]
    edges = [[p - q for p, q in zip(end, exact[0], strict=True)] for end in exact[1:]]
    e1, e2 = first - base, second - base
    a, b, c = weights
    drawn = {"base": base, "first": first, "second": second}
    drawn["rider"] = base + a * e1 + b * e2 + c * np.cross(e1, e2)
    mechanism = SimpleNamespace(
        topology=SimpleNamespace(carried={"rider": ("base", "first", "second")}),
        carrier_weights={"rider": weights},
        layout=SimpleNamespace(
            vector=lambda name: {"base": range(3), "first": range(3, 6)}.get(name, range(6, 9))
        ),
        drawing=SimpleNamespace(vectors=drawn),
    )
    steps = [[Fraction(float(v)) for v in step[k : k + 3, 0]] for k in (0, 3, 6)]
    d1, d2 = ([p - q for p, q in zip(end, steps[0], strict=True)] for end in steps[1:])
    turned = [p + q for p, q in zip(cross(d1, edges[1]), cross(edges[0], d2), strict=True)]
    w = [Fraction(float(v)) for v in weights]
    moved = max(abs(steps[0][i] + w[0] * d1[i] + w[1] * d2[i] + w[2] * turned[i]) for i in range(3))
    bound, _ = bound_of(
        cast(Mechanism, mechanism),
        y,
        {"rider": (drawn["rider"][:, None], np.zeros((3, 1)))},
        certified(9, step=step),
    )
    return bound, moved


def skew(v: Array) -> Array:
    """The table of v x ."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


@dataclass(frozen=True)
class Lacking(Travel):
    """A travel of which the coordinate lacks a part that changes."""

    def rounding(self, coordinate: Array, drawing: Any, law: Array | float) -> tuple[Array, Array]:
        """Some 1e-4 of it, known to 1e-12."""
        return 1e-4 * (coordinate + coordinate**2), np.full_like(coordinate, 1e-12)


def test_what_driven_coordinates_lack_is_seen_by_neighbours_as_by_each_alone() -> None:
    mechanism = GENERAL_STRUT.mechanism()
    arm, travel = mechanism.topology.drives
    lacking = Lacking(travel.coordinate, travel.input, travel.origin, travel.point, travel.direction)
    mechanism = replace(mechanism, topology=replace(mechanism.topology, drives=(arm, lacking)))
    count = 64
    drawn = GENERAL_STRUT.drawn_inputs
    inputs = {
        "arm_angle": drawn["arm_angle"] + np.linspace(0.0, 1e-3, count),
        "rack": drawn["rack"] + np.linspace(5.0, 5.5, count),
    }
    y = np.ascontiguousarray(assemble(GENERAL_STRUT.mechanism(), inputs).y.T)
    certifier = Certifier(mechanism)
    exact = {name: np.zeros(count) for name in inputs}
    together = certifier.certify(np.arange(float(count)), y, exact)
    ones = [
        Certifier(mechanism).certify(np.zeros(1), y[:, [i]], {n: np.zeros(1) for n in exact})
        for i in range(count)
    ]
    step, spread = (
        np.concatenate([getattr(one, name) for one in ones], axis=1) for name in ("step", "spread")
    )
    assert not np.array_equal(together.step, step)  # they were proven together
    # The pose is off by some of what the coordinate lacks.
    assert np.abs(step).max() > 1e-7
    tail = np.array([one.tail[0] for one in ones])
    assert (np.abs(together.step - step) <= together.tail + tail + 100.0 * U).all()
    assert (together.spread <= 1.01 * spread + 100.0 * U).all()
    assert (together.spread >= 0.99 * spread - 100.0 * U).all()
    assert spread.max() > 1e-13


@pytest.mark.parametrize("relative", [1e-5, 1e-4])
def test_a_coefficient_that_is_far_off_is_in_the_bounds_with_what_curvature_makes_of_it(
    make_scene: Callable[..., Scene], relative: float
) -> None:
    sine = {"sine": {"amplitude": 0.3, "angular_frequency": 2.3, "phase": 0.4, "offset": 1.5}}
    motion = simulate(make_scene(sine, [0.0, 5.0]))
    states = motion.solved.states
    assert isinstance(states, StatesOfChain)
    segments = list(states.chain.segments)
    coefficients = segments[0].coefficients.copy()
    layout = states.readout.mechanism.layout
    for name, sign in (("lower_ball_joint", 1.0), ("tie_rod_outer", -1.0)):
        coefficients[1, layout.vector(name)[1]] += sign * relative
    segments[0] = replace(segments[0], coefficients=coefficients)
    wrong_states = replace(states, chain=replace(states.chain, segments=tuple(segments)))
    wrong = replace(motion, solved=replace(motion.solved, states=wrong_states))
    instants = np.linspace(motion.times[0], segments[0].stop, 400)[:-1]
    right, samples = motion.at(instants), wrong.at(instants)
    names = states.readout.mechanism.topology.moving
    error = np.max([np.abs(samples.position[n] - right.position[n]).max(axis=-1) for n in names], axis=0)
    proof, before = wrong.proof_of(samples), motion.proof_of(right).bound
    assert np.isfinite(proof.bound).all()
    assert (proof.bound >= error - before).all()
    assert (proof.pose_bound >= error - before).all()
    assert (proof.bound <= 1.1 * (error + before)).all()


def test_what_a_driven_coordinate_lacks_is_known_however_far_off_it_was_computed() -> None:
    generator = np.random.default_rng(8)
    count = 400
    high = generator.normal(size=count)
    low = U * high * generator.uniform(-1.0, 1.0, count)
    y = generator.normal(size=(count, 3))
    y[: count // 2, 1] = high[: count // 2] * (1.0 + 4.0 * U)
    value = Enclosed(high, low, np.zeros((2, count)))
    lacking, uncertainty = _sharpened(y, {1: (value, value, value)}, np.ones((count, 3)), np.ones((count, 3)))
    for i in range(count):
        exact = Fraction(high[i]) + Fraction(low[i]) - Fraction(y[i, 1])
        assert abs(exact - Fraction(lacking[i, 1])) <= Fraction(uncertainty[i, 1])
    assert (uncertainty[:, 1] <= 4.0 * U * np.abs(lacking[:, 1]) + 4.0 * U**2).all()
    assert (lacking[:, [0, 2]] == 1.0).all()
    assert (uncertainty[:, [0, 2]] == 1.0).all()


@by_car
def test_of_the_points_that_are_reported_the_worst_counts_wherever_it_stands(car: SampleCar) -> None:
    mechanism, y, _ = pose_and_carried(car)
    topology = mechanism.topology
    places = mechanism.places(y[:, 0])
    errors = np.zeros((mechanism.map.unknowns, 1))
    for name in (*topology.moving, *topology.chassis):
        far = places[name][:, None] + np.array([[0.0], [1e-3], [0.0]])
        for other in (*topology.moving, *topology.chassis):
            local = {other: (places[other][:, None], np.zeros((3, 1)))}
            near_by = float(_reported_bound(mechanism, y, local, errors, np.zeros((3, 1)))[0])
            assert near_by <= 1e-15
            local[name] = (far, np.zeros((3, 1)))
            found = float(_reported_bound(mechanism, y, local, errors, np.zeros((3, 1)))[0])
            assert found == pytest.approx(1e-3, rel=1e-5)


def test_a_proof_of_no_instants_says_nothing_that_is_off() -> None:
    motion = simulate(Scene.load("steer"))
    none = motion.proof_of(motion.at(np.empty(0)))
    assert repr(none) == "<Proof of 0 instants: solved points within 0 mm, carried ones within 0 mm>"


def test_terms_that_fall_as_before_leave_out_the_rest_of_a_geometric_series() -> None:
    """Of terms x^k, of which the last two and the two before them are known, x^2 = q."""
    for q in (0.1, 0.5, 0.9):
        last, before = np.full((1, 2), q), np.ones((1, 2))
        summed = Summed(last, before, np.zeros((1, 2)))
        found = summed.expected(np.zeros((1, 2)), np.ones(1), np.ones(1))
        # q + q^2 + ..: what is left out is q less.
        np.testing.assert_allclose(found, q / (1.0 - q), rtol=1e-12)
        np.testing.assert_allclose(
            summed.expected(np.zeros((1, 2)), np.ones(1), np.full(1, 4.0)), 4.0 * found
        )
    # Terms that do not fall are counted twenty times; none at all leave out nothing.
    level = Summed(np.ones((1, 2)), np.ones((1, 2)), np.zeros((1, 2)))
    np.testing.assert_allclose(level.expected(np.zeros((1, 2)), np.ones(1), np.ones(1)), 20.0)
    nothing = Summed(*np.zeros((3, 1, 2)))
    assert not nothing.expected(np.zeros((1, 2)), np.ones(1), np.ones(1)).any()


def test_terms_that_cancel_are_rounded_with_the_condition_number() -> None:
    terms, value = np.array([[3.0, 1.0], [3.0, 1.0]]), np.array([[1.0, 1.0], [-3.0, 1.0]])
    summed = Summed(np.zeros((2, 2)), np.zeros((2, 2)), terms)
    found = summed.expected(value, np.array([100.0, 100.0]), np.ones(2))
    # Of the first pose 3 - 1 of the first coordinate has cancelled, of the second nothing.
    np.testing.assert_allclose(found, EPS * np.array([[203.0, 201.0], [3.0, 1.0]]), rtol=1e-12)


def test_weights_of_carriers_nearly_in_line_are_within_their_radius() -> None:
    """The inverse of their frame is off by up to a half; what it makes of the rest still is a bound."""
    closest, sound = 0.0, 0
    for seed in range(400):
        generator = np.random.default_rng(seed)
        e1 = generator.normal(size=3)
        beside = 10.0 ** generator.uniform(-15.5, -14.0) * generator.normal(size=3)
        e2 = e1 * generator.uniform(0.5, 2.0) + beside
        base = np.zeros(3)
        vectors = {"base": base, "first": e1, "second": e2, "rider": generator.normal(size=3)}
        frame = np.stack([e1, e2, np.cross(e1, e2)], axis=-1)
        lengths = np.linalg.norm(frame, axis=0)
        if not lengths.all() or np.linalg.cond(frame / lengths) > 1e17:
            continue
        try:
            first = np.linalg.solve(frame, vectors["rider"])
        except np.linalg.LinAlgError:
            continue
        mechanism = SimpleNamespace(
            drawing=SimpleNamespace(vectors=vectors), carrier_weights={"rider": first}
        )
        found = _weights(cast(Mechanism, mechanism), "rider", ("base", "first", "second"))
        if not np.isfinite(found.radius[0]).all():
            continue
        sound += 1
        exact = exact_weights(vectors)
        for i in range(3):
            off = abs(exact[i] - Fraction(float(found.high[i])) - Fraction(float(found.low[i])))
            bound = Fraction(float(found.radius[0, i]))
            assert off <= bound, seed
            closest = max(closest, float(off / bound))
    assert sound > 50
    assert closest > 0.1


def exact_weights(vectors: Mapping[str, Array]) -> list[Fraction]:
    """By Cramer's rule."""
    p = {name: [Fraction(float(c)) for c in place] for name, place in vectors.items()}
    e1, e2, target = (
        [a - b for a, b in zip(p[name], p["base"], strict=True)] for name in ("first", "second", "rider")
    )
    frame = [e1, e2, cross(e1, e2)]

    def volume(*columns: list[Fraction]) -> Fraction:
        a, b, c = columns
        return sum((x * y for x, y in zip(a, cross(b, c), strict=True)), Fraction(0))

    whole = volume(*frame)
    return [volume(*(target if i == j else frame[j] for j in range(3))) / whole for i in range(3)]
