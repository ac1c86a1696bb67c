"""What roundings add up to."""

import numpy as np
import pytest

import absolute
from absolute.mechanism import Mechanism
from absolute.rounding import (
    ARM,
    DIRECTION,
    DRIFT,
    PLACE,
    RATE,
    REACH,
    TARGET,
    pose_doubt,
    rate_doubt,
    second_doubt,
    spread,
)
from absolute.rows import rows_of
from absolute.sensitivity import RowMotion

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
    ids=["arm", "direction", "reach", "rate", "drift"],
)
def test_the_roundings_of_a_row_are_those_of_its_operations(what: float, roundings: int) -> None:
    # Independent ones add up in squares.
    assert (what / spread(1)) ** 2 == pytest.approx(roundings, rel=1e-12)


def test_a_target_is_off_by_no_more_than_its_six_roundings_at_worst() -> None:
    # The law, its factor (difference, quotient, root of a length), the quotient by the size, the product:
    # each half of an eps.
    roundings = TARGET / (0.5 * EPS)
    assert roundings == pytest.approx(6.0, rel=1e-12)


def test_a_row_is_rounded_from_its_arms_its_places_and_its_reach(model: absolute.Model) -> None:
    # In the drawing nothing is turned: arms and directions are those of the rows as described.
    mechanism = Mechanism(model)
    poses = mechanism.poses(mechanism.drawn[None])
    placed = mechanism.stack.place(*poses)
    target = np.random.default_rng(3).normal(size=(1, mechanism.stack.count))
    doubt = pose_doubt(mechanism, placed, target)
    rows, origin, expected = rows_of(model, mechanism.drawing), poses.origin[0], []
    for angle in rows.angles:
        # Two directions and a product of them.
        expected.append(DIRECTION + REACH * np.linalg.norm(angle.partner))
    for offset in rows.offsets:
        ends = origin[offset.first] + offset.first_arm, origin[offset.second] + offset.second_arm
        arms = np.linalg.norm(offset.first_arm) + np.linalg.norm(offset.second_arm)
        places = np.linalg.norm(ends[0]) + np.linalg.norm(ends[1])
        expected.append(REACH * np.linalg.norm(ends[1] - ends[0]) + PLACE * places + ARM * arms)
    assert doubt[0] == pytest.approx(expected + TARGET * np.abs(target[0]), rel=1e-6, abs=0.0)


def test_rates_are_rounded_from_the_magnitudes_of_their_terms() -> None:
    random = np.random.default_rng(7)
    lengths = random.uniform(0.5, 2.0, size=(12, 4))
    ways = random.normal(size=(12, 1, 4, 3))
    vectors = ways / np.linalg.norm(ways, axis=-1, keepdims=True) * lengths[:, None, :, None]
    motion = RowMotion(*vectors)
    a, e, r1, r2, w1, w2, s1, s2, turned, *_ = lengths
    assert a.shape == (4,)
    target = random.normal(size=(1, 4))
    # a'.e + a.(s2 + w2 x r2 - s1 - w1 x r1) with a' = w1 x a, for directions a.
    terms = w1 * e + s2 + w2 * r2 + s1 + w1 * r1
    doubt = rate_doubt(motion, target)
    assert doubt[0] == pytest.approx(RATE * terms + TARGET * np.abs(target[0]), rel=1e-9, abs=0.0)
    # The direction of a distance turns by itself, and any by no less than its body.
    w1 = np.maximum(w1, turned)
    # (w1 x a).(2 v + w1 x (r1 + e)) and (w2 x a).(w2 x r2), with v = s2 + w2 x r2 - s1 - w1 x (r1 + e); and
    # the rate of the accelerations, which are the same here.
    bend = w1 * (2.0 * (s2 + w2 * r2 + s1 + w1 * (r1 + e)) + w1 * (r1 + e)) + w2 * w2 * r2
    doubt = second_doubt(motion, motion, target)
    expected = RATE * terms + DRIFT * bend + TARGET * np.abs(target[0])
    assert doubt[0] == pytest.approx(expected, rel=1e-9, abs=0.0)
