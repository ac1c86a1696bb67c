"""What keeps a path and a series on their branch, on the parabola u^2 = w, whose branches meet at w = 0."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from parabola import PARABOLA

from pointcoord.numerics.arrays import Array
from pointcoord.solve import proven_step
from pointcoord.solve.proven_step import PARTS, ROOM, prove_box, prove_segment


def along_the_parabola(u: Array) -> Array:
    """The series of all coordinates, (order + 1, size), whose w follows u^2 up to the order of u's."""
    series = np.zeros((len(u), 4))
    series[:, 0], series[:, 1], series[0, 3] = u, np.convolve(u, u)[: len(u)], 1.0
    return series


@given(
    u=st.floats(1e-3, 1e3),
    shares=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    off=st.tuples(*[st.sampled_from([0.0, 0.1, 0.4])] * 2),
    exact=st.sampled_from([None, 1, 2, 3]),
)
def test_a_box_is_proven_as_far_as_the_condition_holds(
    u: float, shares: tuple[float, float, float], off: tuple[float, float], exact: int | None
) -> None:
    """X = 1 / (2 u) and omega = 1 / u; one unknown, so that no estimate loses anything.

    Nor does a large map's of the powers above `exact` by their magnitudes.
    """
    series = along_the_parabola(u * np.array([1.0, *shares]))
    a, b, c = np.abs(shares)
    lacking, defect = off
    z, eta = a + b + c + defect, (2.0 * a * c + b * b + 2.0 * b * c + c * c + lacking) / 2.0
    condition = z + float(np.sqrt(2.0 * eta))
    assume(abs(condition - ROOM) > 1e-9)
    sizes = np.abs(series[1:, None])
    with pytest.MonkeyPatch.context() as patch:
        if exact is not None:
            patch.setattr(proven_step, "LARGE", 1)
            patch.setattr(proven_step, "EXACT_OF_LARGE", exact)
        moving, inverse = series[:, None], np.full((1, 1, 1), 0.5 / u)
        rest = np.full((1, 1), lacking * u * u)
        proof = prove_box(
            PARABOLA, inverse, moving[0], moving, slice(None), sizes, rest, np.full((1, 1, 1), defect)
        )
    assert proof.holds.tolist() == [condition < ROOM]
    # The other branch is twice as far as the fold, which is at least 1 - z of u away.
    assert proof.alone[0] * proof.weights[0, 0] <= (1.0 - z) * u * (1.0 + 1e-9) or condition > ROOM


@given(share=st.floats(0.0, 1.5), s=st.floats(1e-3, 1e3))
def test_a_segment_is_proven_by_parts_as_far_as_the_last_one_is(share: float, s: float) -> None:
    """u = 1 - k s, straight, so that nothing is cut off; the fold is at k s = 1."""
    series = along_the_parabola(np.array([1.0, -share / s, 0.0]))
    middle, half = 1.0 - 0.5 / PARTS[-1], 0.5 / PARTS[-1]
    end = ROOM / (half + ROOM * middle)
    assume(abs(share - end) > 1e-9)
    proof = prove_segment(PARABOLA, series, s)
    assert bool(proof.holds) == (share < end)
    assert share >= end or proof.alone * proof.weights[0] <= 1.0 - share + 1e-9


@pytest.mark.parametrize("lacking", [0.0, 0.05, 0.2])
def test_a_segment_is_proven_as_far_as_the_condition_holds_about_its_middle(lacking: float) -> None:
    """u = 1 + a t + b t^2, t = 0 .. 1; the powers t^3 and t^4 of u^2 are cut off."""
    s = 3.0
    a, b = (bend.ravel() for bend in np.meshgrid(*[np.linspace(-0.8, 0.8, 41)] * 2))
    middle = 1.0 + 0.5 * a + 0.25 * b
    z, cut = (0.5 * np.abs(a + b) + 0.25 * np.abs(b)) / middle, 2.0 * np.abs(a * b) + b * b
    condition = z + np.sqrt(cut + lacking) / middle
    series = np.stack(
        [along_the_parabola(np.array([1.0, *bends])) for bends in zip(a / s, b / s**2, strict=True)]
    )
    proof = prove_segment(PARABOLA, series, s, np.full((len(a), 1), -lacking), parts=(1,))
    clear = np.abs(condition - ROOM) > 1e-9
    assert (proof.holds == (condition < ROOM))[clear].all()
    assert 100 < np.count_nonzero(proof.holds) < len(a) - 100
