"""The pieces of error bounds, each against what it bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from pointcoord.bounds.solved_coordinates import Summed
from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.in_body import Normal, carrier_weights
from pointcoord.linkage.drawing import Drawing
from pointcoord.numerics.rounding import EPS
from pointcoord.results.states import StatesOfChain

Array = NDArray[np.float64]
BODY = Normal("", "base", "first", "second")


def cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


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


@pytest.mark.parametrize("thin", [(-15.0, -14.0), (-14.0, -6.0), (-6.0, 0.0)])
def test_weights_of_carriers_however_nearly_in_line_are_within_their_doubt(thin: tuple[float, float]) -> None:
    closest, told = 0.0, 0
    for seed in range(200):
        rng = np.random.default_rng(seed)
        base, e1, rider = rng.normal(size=(3, 3))
        e2 = e1 * rng.uniform(0.5, 2.0) + 10.0 ** rng.uniform(*thin) * rng.normal(size=3)
        vectors = {"base": base, "first": base + e1, "second": base + e2, "rider": rider}
        try:
            found = carrier_weights(Drawing(vectors, np.array(1.0)), "rider", BODY)
        except MechanismError:
            continue
        told += 1
        for exact, *parts in zip(by_cramer(vectors), *(part.tolist() for part in found), strict=True):
            value, lacks, doubt = map(Fraction, parts)
            assert abs(exact - value - lacks) <= doubt, seed
            closest = max(closest, float(abs(exact - value - lacks) / doubt))
    assert told > 50
    assert closest > 1e-4


def by_cramer(vectors: Mapping[str, Array]) -> list[Fraction]:
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
