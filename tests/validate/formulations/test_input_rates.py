"""Laws of the inputs, rounded once, however their terms cancel."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline

from pointcoord.scene.input_part import InputPart, SinePart
from validate.formulations.input_rates import rates

EPS = float(np.finfo(float).eps)


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


def test_sums_are_rounded_once_although_their_terms_cancel() -> None:
    wave = SinePart(amplitude=1e3, angular_frequency=3.0, phase=0.5)
    law = InputPart(sum=(InputPart(sine=wave), InputPart(constant=-1e3), InputPart(polynomial=(0.0, 1e-9))))
    instants = np.linspace(0.35, 0.36, 40)  # about a crest: 3 t + 0.5 is pi / 2 at 0.357
    found = rates(law, instants)
    with mpmath.workdps(60):
        for row, t in zip(found.tolist(), instants.tolist(), strict=True):
            angle, slow = mpmath.mpf(3) * t + mpmath.mpf("0.5"), mpmath.mpf(1e-9)
            swing = 1000 * mpmath.sin(angle)
            assert row == [
                float(swing - 1000 + slow * t),
                float(3000 * mpmath.cos(angle) + slow),
                float(-9 * swing),
            ]


def test_rates_too_large_for_a_double_are_infinite_with_their_sign() -> None:
    """Of 10^200 rad/s even the turn is known by fractions alone, and its square is beyond the doubles."""
    instants = [1.0, 2.0, 3.0, 4.0]
    found = rates(InputPart(sine=SinePart(amplitude=1.0, angular_frequency=1e200)), np.array(instants))
    with mpmath.workdps(300):
        for row, t in zip(found.tolist(), instants, strict=True):
            assert row[2] == -math.inf * float(mpmath.sign(mpmath.sin(mpmath.mpf(1e200) * t)))


@given(seed=st.integers(0, 2**32 - 1))
def test_a_table_is_the_not_a_knot_spline_in_both_formulations(seed: int) -> None:
    """As a sum of B-splines, of which not-a-knot is the default."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.5, 1.5, int(rng.integers(4, 12))))
    values = rng.uniform(-1.0, 1.0, len(times))
    law = InputPart.model_validate({"table": {"times": times.tolist(), "values": values.tolist()}})
    spline = make_interp_spline(times, values, k=3)
    # Inside the pieces, where the third derivative has one value.
    instants = np.concatenate([times[:-1] + share * np.diff(times) for share in (0.1, 0.5, 0.9)])
    ours, series = rates(law, instants), law.function.series(instants, 12)
    for order in range(4):
        # Two solves of a system of condition number below 100, steps above 0.5: the k-th derivative is below
        # 50 * 2^k times the values.
        meant, within = spline(instants, nu=order), 100 * 2**order * 50 * EPS * 20
        assert np.abs(series[:, order] * math.factorial(order) - meant).max() <= 6 * within
        if order < 3:
            assert np.abs(ours[:, order] - meant).max() <= within
    assert not series[:, 4:].any()
    assert np.abs(law.function.series(times, 0)[:, 0] - values).max() <= 100 * 50 * EPS
