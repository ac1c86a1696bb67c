"""Laws of the inputs, rounded once, however their terms cancel."""

import math
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from changed_scenes import scene_with
from hypothesis import given
from hypothesis import strategies as st

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


def exact_not_a_knot(times: list[Fraction], values: list[Fraction]) -> list[list[Fraction]]:
    """Cubics of every interval, lowest power of t - t_i first, in rational arithmetic.

    Second derivatives M solve the usual equations of a cubic spline; not-a-knot makes the third derivative
    continuous at the second time and at the last but one.
    """
    n = len(times)
    h = [b - a for a, b in pairwise(times)]
    slope = [(b - a) / s for a, b, s in zip(values[:-1], values[1:], h, strict=True)]
    rows = [[Fraction(0)] * n for _ in range(n)]
    right = [Fraction(0)] * n
    rows[0][:3] = [h[1], -(h[0] + h[1]), h[0]]
    rows[-1][-3:] = [h[-1], -(h[-2] + h[-1]), h[-2]]
    for i in range(1, n - 1):
        rows[i][i - 1 : i + 2] = [h[i - 1], 2 * (h[i - 1] + h[i]), h[i]]
        right[i] = 6 * (slope[i] - slope[i - 1])
    for i in range(n):
        pivot = next(k for k in range(i, n) if rows[k][i])
        rows[i], rows[pivot], right[i], right[pivot] = rows[pivot], rows[i], right[pivot], right[i]
        for k in range(n):
            if k != i and rows[k][i]:
                factor = rows[k][i] / rows[i][i]
                rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i], strict=True)]
                right[k] -= factor * right[i]
    m = [right[i] / rows[i][i] for i in range(n)]
    return [
        [
            values[i],
            slope[i] - h[i] * (2 * m[i] + m[i + 1]) / 6,
            m[i] / 2,
            (m[i + 1] - m[i]) / (6 * h[i]),
        ]
        for i in range(n - 1)
    ]


@pytest.mark.parametrize("seed", range(2))
def test_a_table_is_the_not_a_knot_spline_of_exact_arithmetic(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 12))
    times = np.cumsum(rng.uniform(0.05, 0.5, count))
    values = rng.uniform(-30.0, 30.0, count)
    cubics = exact_not_a_knot([Fraction(t) for t in times], [Fraction(v) for v in values])
    laws = {"rack": {"table": {"times": times.tolist(), "values": values.tolist()}}}
    time = {"start": float(times[0]), "stop": float(times[-1]), "samples": 23}
    scene = scene_with("off-axis-strut", laws=laws, time=time)
    instants = scene.instants
    found = rates(scene.inputs["rack"], instants)
    series = scene.functions["rack"].series(instants, 2) * np.array([1.0, 1.0, 2.0])
    for t, ours, theirs in zip(instants.tolist(), found, series, strict=True):
        i = min(int(np.searchsorted(times, t, side="right")) - 1, count - 2)
        s = Fraction(t) - Fraction(times[i])
        a, b, c, d = cubics[i]
        exact = (a + s * (b + s * (c + s * d)), b + s * (2 * c + 3 * s * d), 2 * c + 6 * s * d)
        for order, meant in enumerate(exact):
            # The spline's equations have a condition number below 10 times the ratio of its intervals, and a
            # derivative divides by the shortest one.
            limit = 1e3 * np.finfo(float).eps * 30.0 / 0.05**order
            assert abs(Fraction(float(ours[order])) - meant) <= limit
            assert abs(Fraction(float(theirs[order])) - meant) <= limit
