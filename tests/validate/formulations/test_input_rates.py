"""Laws of the inputs, rounded once, however their terms cancel."""

import math

import mpmath
import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline

from pointcoord.scene.input_part import InputPart, SinePart
from validate.formulations.input_rates import rates

EPS = float(np.finfo(float).eps)


SIZES = st.floats(-1e3, 1e3)
WAVES = st.builds(
    SinePart,
    amplitude=SIZES,
    angular_frequency=st.floats(1e-6, 1e6),
    # Of many turns every digit is kept.
    phase=SIZES | st.sampled_from([2e12 * math.pi, 1e300]),
    offset=SIZES,
)


@given(
    wave=WAVES,
    coefficients=st.lists(SIZES, min_size=1, max_size=9),
    instants=st.lists(SIZES, min_size=8, max_size=8),
)
@example(  # about a crest, where the terms cancel
    wave=SinePart(amplitude=1e3, angular_frequency=3.0, phase=0.5, offset=-1e3),
    coefficients=[0.0, 1e-9],
    instants=np.linspace(0.35, 0.36, 40).tolist(),
)
def test_waves_polynomials_and_their_sums_are_rounded_once(
    wave: SinePart, coefficients: list[float], instants: list[float]
) -> None:
    laws = {"sine": wave}, {"polynomial": tuple(coefficients)}
    parts = [InputPart.model_validate(law) for law in laws]
    found = [rates(law, np.array(instants)).tolist() for law in (*parts, InputPart(sum=tuple(parts)))]
    with mpmath.workdps(400):
        a, w, p = (mpmath.mpf(x) for x in (wave.amplitude, wave.angular_frequency, wave.phase))
        for at, instant in enumerate(instants):
            t = mpmath.mpf(instant)
            sine, cosine = mpmath.sin(w * t + p), mpmath.cos(w * t + p)
            swing = [wave.offset + a * sine, a * w * cosine, -a * w * w * sine]
            powers = [
                sum(math.perm(k, d) * mpmath.mpf(c) * t ** max(k - d, 0) for k, c in enumerate(coefficients))
                for d in range(3)
            ]
            exact = swing, powers, [one + other for one, other in zip(swing, powers, strict=True)]
            assert [rows[at] for rows in found] == [[float(x) for x in row] for row in exact]


def test_rates_too_large_for_a_double_are_infinite_with_their_sign() -> None:
    """Of 10^200 rad/s even the turn is known by fractions alone, and its square is beyond the doubles."""
    instants = [1.0, 2.0, 3.0, 4.0]
    found = rates(InputPart(sine=SinePart(amplitude=1.0, angular_frequency=1e200)), np.array(instants))
    with mpmath.workdps(300):
        signs = [float(mpmath.sign(mpmath.sin(mpmath.mpf(1e200) * t))) for t in instants]
    assert found[:, 2].tolist() == [-math.inf * sign for sign in signs]


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
