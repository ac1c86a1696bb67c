"""What roundings add up to."""

import numpy as np
import pytest

from absolute.rounding import ARM, DIRECTION, DRIFT, RATE, REACH, TARGET, spread

EPS = float(np.finfo(float).eps)


def test_a_rounding_in_a_vector_spreads_as_roundings_to_single_precision_do() -> None:
    # Numbers even between powers of two, rounded to single precision: the root of the mean square of their
    # relative errors, in one component of three, of which 5 add up; four times that.
    exact = np.random.default_rng(1).uniform(1.0, 2.0, 400_000)
    off = (exact.astype(np.float32) - exact) / exact / float(np.finfo(np.float32).eps)
    four_deviations = 4.0 * np.sqrt(5.0 * np.mean(off * off) / 3.0)
    # 400,000 samples of a bounded number: the mean square within 0.2 %.
    assert spread(5) / EPS == pytest.approx(four_deviations, rel=2e-3)


@pytest.mark.parametrize(
    ("what", "roundings"),
    [
        # Difference and quotient of the drawing, eight of a rotation, three products of turning by it.
        (ARM, 2 + 8 + 3),
        # A direction: nine more for its length and the quotient by that.
        (DIRECTION, (2 + 9) + 8 + 3),
        # The row: a product with it, which has three, and a difference.
        (REACH, (2 + 9) + 8 + 3 + 3 + 1),
        # Direction and arm, the vector product of both, twelve products summed up.
        (RATE, 22 + 13 + 3 + 12),
        # The same with two more vector products, and three terms summed up.
        (DRIFT, 22 + 13 + 3 + 3 + 12 + 3),
    ],
)
def test_the_roundings_of_a_row_are_those_of_its_operations(what: float, roundings: int) -> None:
    # Independent ones add up in squares.
    assert (what / spread(1)) ** 2 == pytest.approx(roundings, rel=1e-12)


def test_a_target_is_off_by_no_more_than_its_six_roundings_at_worst() -> None:
    # The law, its factor (difference, quotient, root of a length), the quotient by the size, the product:
    # each half of an eps.
    roundings = TARGET / (0.5 * EPS)
    assert roundings == pytest.approx(6.0, rel=1e-12)
