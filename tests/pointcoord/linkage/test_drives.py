"""How an input becomes a known coordinate: against many digits, with all that is said of what is lost."""

import math

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import InputOutOfRange
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.drives import ArmAngle, Travel
from pointcoord.numerics.enclosure import Enclosed

Array = NDArray[np.float64]
U = 2.0**-53
ARM = ArmAngle("rise", "arm_angle", "pivot", "ball", "up")
RACK = Travel("travel", "rack", "centre", "inner", "right")
UNIT = 256.0


def drawn(seed: int) -> Drawing:
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (4, 3))
    vectors = dict(zip(("pivot", "ball", "centre", "inner"), points, strict=True))
    return Drawing(
        {**vectors, "up": np.array([0.0, 0.0, 1.0]), "right": np.array([0.0, 1.0, 0.0])}, np.array(UNIT)
    )


def length_of(drawing: Drawing) -> mpmath.mpf:
    ends = (drawing.vectors["pivot"].tolist(), drawing.vectors["ball"].tolist())
    return mpmath.sqrt(sum((mpmath.mpf(p) - mpmath.mpf(q)) ** 2 for p, q in zip(*ends, strict=True)))


@pytest.mark.parametrize("seed", range(10))
def test_the_rise_of_an_arm_is_right_to_its_stated_doubt(seed: int) -> None:
    drawing = drawn(seed)
    for angle in np.random.default_rng(seed).uniform(0.0, np.pi, 20).tolist():
        (rise,) = ARM.series(np.array([angle]), drawing)
        lacks, doubt = (float(part) for part in ARM.rounding(np.array(rise), drawing, 0.0))
        with mpmath.workdps(50):
            exact = length_of(drawing) * mpmath.cos(mpmath.mpf(angle))
            assert abs(mpmath.mpf(float(rise)) + mpmath.mpf(lacks) - exact) <= doubt
            # A length is the root of a rounded sum: some two roundings; a cosine and a product are three.
            assert abs(lacks) <= 4.0 * U * abs(rise)
            assert doubt <= 3.1 * U * abs(rise)
            law = 1e-3
            _, wide = ARM.rounding(np.array(rise), drawing, law)
            for off in (-law, law):
                assert abs(length_of(drawing) * mpmath.cos(mpmath.mpf(angle) + off) - rise) <= float(wide)
            assert float(wide) <= 1.02 * law * length_of(drawing)


@pytest.mark.parametrize("order", [4, 7, 12])
def test_the_series_of_an_arm_over_a_range_is_as_near_as_it_says_with_its_derivatives(order: int) -> None:
    drawing, middle, half = drawn(3), 1.2, 0.5
    series, doubts = ARM.series_over(np.array([middle]), np.array([half]), order, drawing)
    assert series.shape == (1, order + 1)
    s = np.linspace(-1.0, 1.0, 41)
    with mpmath.workdps(50):
        arm, turned = length_of(drawing), [mpmath.mpf(middle) + half * mpmath.mpf(x) for x in s.tolist()]
        exact = (
            [arm * mpmath.cos(a) for a in turned],
            [-arm * half * mpmath.sin(a) for a in turned],
            [-arm * half**2 * mpmath.cos(a) for a in turned],
        )
        for derivative, (true, doubt) in enumerate(zip(exact, doubts, strict=True)):
            terms = np.polynomial.polynomial.polyder(series[0], derivative)
            values = np.polynomial.polynomial.polyval(s, terms).tolist()
            off = max(float(abs(mpmath.mpf(v) - t)) for v, t in zip(values, true, strict=True))
            # Evaluating the polynomial here rounds too: each term some 2 k times, 2^-53 of numbers below 2.
            assert off <= float(doubt[0]) + 4 * order * U
            if order == 4:
                assert float(doubt[0]) <= 5.0 * off
            # What 13 terms leave out of the second derivative is below 2 * 0.5^13 / 11!.
            elif order == 12:
                assert float(doubt[0]) <= 2.0 * 0.5**13 / math.factorial(11)


def test_the_exact_rise_of_an_arm_has_the_rates_of_the_chain_rule() -> None:
    drawing = drawn(4)
    angles, rates, seconds = np.random.default_rng(4).uniform(0.1, 3.0, (3, 20))
    found = ARM.enclosed([Enclosed.of(law) for law in (angles, rates, seconds)], drawing)
    with mpmath.workdps(60):
        arm = length_of(drawing)
        for i, law in enumerate(zip(angles.tolist(), rates.tolist(), seconds.tolist(), strict=True)):
            angle, rate, second = (mpmath.mpf(x) for x in law)
            c, s = mpmath.cos(angle), mpmath.sin(angle)
            exact = (arm * c, -arm * s * rate, -arm * (s * second + c * rate**2))
            for true, part in zip(exact, found, strict=True):
                off = abs(true - mpmath.mpf(float(part.high[i])) - mpmath.mpf(float(part.low[i])))
                assert off <= float(part.radius[0, i]) <= 1e-27


def test_an_arm_turns_from_straight_up_to_straight_down_and_its_rise_tells_the_angle() -> None:
    drawing = drawn(5)
    arm = float(length_of(drawing))
    for angle, rise in ((0.0, arm), (np.pi / 2, 0.0), (np.pi, -arm)):
        (found,) = ARM.series(np.array([angle]), drawing)
        assert found == pytest.approx(rise, abs=4.0 * U)
    assert [float(x) for x in ARM.extremes(drawing)] == pytest.approx([arm, -arm], rel=4.0 * U)
    angles = np.array([0.0, 0.4, 1.7, 3.0])
    assert ARM.input_value(arm * np.cos(angles), drawing) == pytest.approx(angles, abs=1e-7)
    # A rounding beyond the end is the end.
    assert ARM.input_value(np.array([1.0001, -1.0001]) * arm, drawing).tolist() == [0.0, np.pi]
    height = drawing.vectors["ball"][2] - drawing.vectors["pivot"][2]
    assert float(ARM.drawn(drawing)) == height


@pytest.mark.parametrize("angle", [-1e-3, 3.2, 90.0, 180.0, 181.0, 6.0, np.nan])
def test_an_angle_that_no_rise_tells_is_refused_and_degrees_are_seen(angle: float) -> None:
    drawing = drawn(6)
    for law in (np.array([angle, 1.0]), np.array([[1.0, 2.0], [angle, 1.0], [-5.0, 0.0]])):
        with pytest.raises(InputOutOfRange, match="0 to pi rad") as caught:
            ARM.series(law, drawing)
        assert caught.value.name == "arm_angle"
        assert np.array_equal(caught.value.value, angle, equal_nan=True)
        # More than a turn cannot be meant in radians, nor more than half a turn in degrees.
        in_degrees = angle in (90.0, 180.0)
        assert ("degrees" in str(caught.value)) == in_degrees
        if in_degrees:
            assert f"it is {np.pi * angle / 180.0:.10g} rad" in str(caught.value)


def test_many_laws_of_an_arm_are_each_of_them() -> None:
    drawing, laws = drawn(7), np.random.default_rng(7).uniform(0.2, 1.5, (6, 5))
    together = ARM.series(laws, drawing)
    for one, law in zip(together, laws, strict=True):
        # The same sums in another order: of the series of cosh, whose terms are below 5^k here.
        assert one == pytest.approx(ARM.series(law, drawing), abs=64 * U * 5.0**4)


def test_a_rack_goes_in_units_of_the_car_along_its_direction() -> None:
    drawing = drawn(8)
    law = np.array([[32.0, -8.0, 2.0], [1.0, 0.0, 0.0]])
    assert RACK.series(law, drawing).tolist() == [[0.125, -0.03125, 0.0078125], [1.0 / 256.0, 0.0, 0.0]]
    series, doubts = RACK.series_over(np.array([32.0]), np.array([8.0]), 3, drawing)
    assert series.tolist() == [[0.125, 0.03125, 0.0, 0.0]]
    assert [float(d[0]) for d in doubts] == [0.0, 0.0, 0.0]
    lacks, doubt = RACK.rounding(np.array([0.125, 1.0]), drawing, 16.0)
    assert (lacks.tolist(), doubt.tolist()) == ([0.0, 0.0], [0.0625, 0.0625])
    exact = RACK.enclosed([Enclosed.of(np.array([x])) for x in (32.0, -8.0, 2.0)], drawing)
    assert [float(part.high[0]) for part in exact] == [0.125, -0.03125, 0.0078125]
    assert float(RACK.drawn(drawing)) == drawing.vectors["inner"][1] - drawing.vectors["centre"][1]
    assert float(RACK.input_value(np.array(0.125), drawing)) == 32.0
    # No rod that is drawn within the car, of the size of 1, reaches as far.
    assert [float(x) for x in RACK.extremes(drawing)] == [-8.0, 8.0]
    assert (ARM.unit, ARM.pushes, RACK.unit, RACK.pushes) == ("rad", "", "mm", "inner")
