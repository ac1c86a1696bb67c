"""Laws of the inputs, rounded once, however their terms cancel."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pointcoord.scene.scene_file import InputPart, SinePart
from validate.formulations import input_rates
from validate.formulations.input_rates import rates

EPS = float(np.finfo(float).eps)


def test_a_polynomial_near_its_rest_keeps_every_digit() -> None:
    # 16 t^2 (1 - t)^2 and its rates 2^-40 before it comes to rest; terms of 16 to 192 cancel.
    h = 2.0**-40
    (found,) = rates(InputPart(polynomial=(0.0, 0.0, 16.0, -32.0, 16.0)), np.array([1.0 - h]))
    t, rest = 1 - Fraction(h), Fraction(h)
    exact = (16 * t**2 * rest**2, 32 * t * rest * (rest - t), 32 * (rest**2 - 4 * t * rest + t**2))
    assert found.tolist() == [float(x) for x in exact]


@pytest.mark.parametrize("turns", [0, 1, 10**6, 10**12, 10**300])
def test_a_sine_of_many_turns_keeps_every_digit(turns: int) -> None:
    # sin(w t + p) with a phase near `turns` turns is that of what is left of the phase.
    phase = 2.0 * math.pi * turns
    wave = SinePart(amplitude=2.0, angular_frequency=3.0, phase=phase)
    (found,) = rates(InputPart(sine=wave), np.array([0.5]))
    left = math.sin(phase) * math.cos(1.5) + math.cos(phase) * math.sin(1.5)
    # The C library reduces any angle exactly; four roundings here.
    assert abs(found[0] - 2.0 * left) <= 4 * EPS
    assert abs(found[2] + 9.0 * found[0]) <= 2 * EPS * 9.0 * 2.0


def test_laws_too_large_for_the_arithmetic_come_out_infinite() -> None:
    (high,) = rates(InputPart(polynomial=(1.0, 0.0, -1e308)), np.array([100.0]))
    assert high.tolist() == [-math.inf, -math.inf, -math.inf]
    (wave,) = rates(InputPart(sine=SinePart(amplitude=1.0, angular_frequency=1e200)), np.array([1.0]))
    assert math.isfinite(wave[1])
    assert math.isinf(wave[2])


def test_a_tiny_term_decides_a_tie() -> None:
    # Two terms lie amid two doubles, and the third, of 1e-134, leads below that.
    law = (257.0, -2.1947536446381277e-134, -1.4566006230903668)
    (found,) = rates(InputPart(polynomial=law), np.array([0.5]))
    terms = [Fraction(c) * Fraction(1, 2) ** k for k, c in enumerate(law)]
    assert 2 * (terms[0] + terms[2]) == sum(
        Fraction(x) for x in (found[0], math.nextafter(found[0], math.inf))
    )


def test_ties_are_known_without_many_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    # The rate 1/4 + t/8 has three bits more than t: every fourth one or so is halfway between two doubles.
    law, instants = (0.8, 0.25, 0.0625), np.linspace(0.0, 2.6, 3001)
    exact = [
        [sum(math.perm(k, d) * Fraction(law[k]) * t ** (k - d) for k in range(d, 3)) for d in range(3)]
        for t in map(Fraction, instants.tolist())
    ]
    ties = sum(
        2 * rate == Fraction(near) + Fraction(math.nextafter(near, math.inf if rate > near else -math.inf))
        for _, rate, _ in exact
        if (near := float(rate)) != rate
    )
    assert ties > 300
    decided = []
    monkeypatch.setattr(
        input_rates,
        "_sum",
        lambda law, t: decided.append(t) or float(sum(c * Fraction(t) ** k for k, c in enumerate(law))),
    )
    found = rates(InputPart(polynomial=law), instants)
    assert found.tolist() == [[float(x) for x in row] for row in exact]
    # Where a value of 64 digits is a tie and something small is left out: one in 2^10.
    assert len(decided) <= 3 * len(instants) / 2**8


@pytest.mark.parametrize("power", [5, 6, 7])
def test_values_that_lie_within_the_doubt_of_a_tie_are_rounded_by_many_digits(power: int) -> None:
    # (t - 1)^n written out: its terms cancel by up to 2^70 here, so that of the two long numbers' 128 bits
    # few are left, and the doubt of one value in ten or so has halfway between two doubles in it.
    law = tuple(math.comb(power, k) * (-1.0) ** (power - k) for k in range(power + 1))
    instants = 1.0 + np.random.default_rng(power).uniform(-1.0, 1.0, 500) * 2.0**-9
    found = rates(InputPart(polynomial=law), instants)
    for row, t in zip(found.tolist(), map(Fraction, instants.tolist()), strict=True):
        assert row == [float(math.perm(power, d) * (t - 1) ** (power - d)) for d in range(3)]


@pytest.mark.parametrize("phase", [0.5, 300.5])
def test_sines_that_lie_within_the_doubt_of_a_tie_are_rounded_by_many_digits(phase: float) -> None:
    # Near its trough a wave about its amplitude cancels; its rates near their zeros keep the angle's error.
    wave = SinePart(amplitude=1.0, angular_frequency=3.0, phase=phase, offset=1.0)
    lowest = (-0.5 * math.pi - phase % (2.0 * math.pi)) / 3.0
    near = np.random.default_rng(1).uniform(-1.0, 1.0, 500) * 0.01
    instants = np.concatenate([lowest + near, lowest + math.pi / 6.0 + near])
    found = rates(InputPart(sine=wave), instants)
    with mpmath.workdps(60):
        for row, t in zip(found.tolist(), instants.tolist(), strict=True):
            angle = 3 * mpmath.mpf(t) + mpmath.mpf(phase)
            exact = [1 + mpmath.sin(angle), 3 * mpmath.cos(angle), -9 * mpmath.sin(angle)]
            assert row == [float(x) for x in exact]


@given(
    coefficients=st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=9),
    instants=st.lists(st.floats(-1e3, 1e3), min_size=40, max_size=40),
)
def test_polynomials_are_rounded_once(coefficients: list[float], instants: list[float]) -> None:
    found = rates(InputPart(polynomial=tuple(coefficients)), np.array(instants))
    for row, t in zip(found.tolist(), map(Fraction, instants), strict=True):
        for d, value in enumerate(row):
            terms = (math.perm(k, d) * Fraction(c) * t ** max(k - d, 0) for k, c in enumerate(coefficients))
            assert value == float(sum(terms))


@given(
    wave=st.builds(
        SinePart,
        amplitude=st.floats(-1e3, 1e3),
        angular_frequency=st.floats(1e-6, 1e6),
        phase=st.floats(-1e3, 1e3),
        offset=st.floats(-1e3, 1e3),
    ),
    instants=st.lists(st.floats(-1e3, 1e3), min_size=40, max_size=40),
)
def test_sines_are_rounded_once(wave: SinePart, instants: list[float]) -> None:
    found = rates(InputPart(sine=wave), np.array(instants))
    with mpmath.workdps(80):
        a, w, p = (mpmath.mpf(x) for x in (wave.amplitude, wave.angular_frequency, wave.phase))
        for row, t in zip(found.tolist(), instants, strict=True):
            sine, cosine = mpmath.sin(w * t + p), mpmath.cos(w * t + p)
            exact = [wave.offset + a * sine, a * w * cosine, -a * w * w * sine]
            assert row == [float(x) for x in exact]
