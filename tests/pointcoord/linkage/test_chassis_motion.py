"""What the motion of the chassis adds to every point: its value, its rates, and what they round."""

import math
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import InputOutOfRange
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.time_functions import Polynomial, Sine

Array = NDArray[np.float64]
U = 2.0**-53
LIFT, SWAY = Polynomial((3.0, -2.0, 0.5, 0.25)), Sine(12.0, 3.0, 0.4, -1.0)
UP, SIDE = np.array([0.6, 0.0, 0.8]), np.array([0.8, 0.0, -0.6])
BOTH = ChassisMotion({"heave": LIFT, "sway": SWAY}, {"heave": UP, "sway": SIDE})
T = np.linspace(0.0, 2.0, 17)


def test_every_input_moves_the_chassis_along_its_own_direction_with_its_rates() -> None:
    lift = (3.0 - 2.0 * T + 0.5 * T**2 + 0.25 * T**3, -2.0 + T + 0.75 * T**2, 1.0 + 1.5 * T)
    angle = 3.0 * T + 0.4
    sway = (12.0 * np.sin(angle) - 1.0, 36.0 * np.cos(angle), -108.0 * np.sin(angle))
    found = BOTH.states(T, 2)
    assert len(found) == 3
    for order, state in enumerate(found):
        # Ten roundings of numbers below 200.
        meant = lift[order][:, None] * UP + sway[order][:, None] * SIDE
        np.testing.assert_allclose(state, meant, rtol=0.0, atol=10 * U * 200.0)
    assert len(BOTH.states(T, 0)) == 1
    assert ChassisMotion({}, {}).states(T, 2) == []


def test_of_a_batch_of_cars_each_goes_along_its_own_direction() -> None:
    ways = np.array([UP, SIDE, [0.0, 1.0, 0.0]])
    together = ChassisMotion({"heave": LIFT}, {"heave": ways}).states(T, 2)
    for i, way in enumerate(ways):
        alone = ChassisMotion({"heave": LIFT}, {"heave": way}).states(T, 2)
        for many, one in zip(together, alone, strict=True):
            assert many.shape == (3, len(T), 3)
            assert np.array_equal(many[i], one)


def test_where_the_chassis_is_exactly_is_the_origin_and_what_each_input_adds() -> None:
    origin = np.array([1e6, -3.0, 0.1])
    rng = np.random.default_rng(2)
    laws = {name: [Enclosed.of(rng.normal(size=5)) for _ in range(3)] for name in BOTH.functions}
    found = BOTH.enclosed(laws, origin)
    for order, place in enumerate(found):
        for i in range(5):
            for axis in range(3):
                meant = Fraction(origin[axis]) if order == 0 else Fraction(0)
                for name, way in BOTH.directions.items():
                    meant += Fraction(way[axis]) * Fraction(float(laws[name][order].high[i]))
                high, low, radius = (
                    Fraction(float(np.broadcast_to(part, (5, 3))[i, axis]))
                    for part in (place.high, place.low, place.radius[0])
                )
                assert abs(high + low - meant) <= radius <= Fraction(1, 10**20)


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (700.0, 0.0, -3e5)])
def test_the_place_of_the_chassis_is_rounded_by_no_more_than_is_said(
    origin: tuple[float, float, float],
) -> None:
    start = np.array(origin)
    # Of polynomials that are rounded once, so that all that the sums lose is to be seen.
    laws = {"heave": Polynomial((0.1, 0.7)), "sway": Polynomial((-0.3, 1.1))}
    motion = ChassisMotion(laws, BOTH.directions)
    said = motion.rounding(T, start)
    computed = motion.states(T, 0)[0] + start
    largest = 0.0
    for i, t in enumerate(T.tolist()):
        for axis in range(3):
            exact = Fraction(start[axis])
            for name, law in laws.items():
                value = sum(Fraction(c) * Fraction(t) ** k for k, c in enumerate(law.coefficients))
                exact += value * Fraction(motion.directions[name][axis])
            off = float(abs(Fraction(float(computed[i, axis])) - exact))
            assert off <= said[i, axis]
            largest = max(largest, off / said[i, axis]) if axis != 1 else largest
    # Nothing moves along y, so nothing is rounded there; elsewhere the bound is some few times the worst.
    assert not said[:, 1].any()
    assert largest > 0.1


def test_what_a_law_itself_is_off_by_is_part_of_what_is_said() -> None:
    motion = ChassisMotion({"sway": SWAY}, {"sway": SIDE})
    law = SWAY.rounding(T)[:, None] * np.abs(SIDE)
    said = motion.rounding(T, np.zeros(3))
    value = np.abs(SWAY.series(T, 0)) * np.abs(SIDE)
    assert (law[:, 0] > 0.0).all()
    assert (said >= law + U * value).all()
    assert (said <= 1.02 * law + 8.0 * U * value).all()


@pytest.mark.parametrize(
    ("order", "what", "unit"), [(0, "values", "mm"), (1, "rates", "mm/s"), (2, "accelerations", "mm/s^2")]
)
def test_a_chassis_that_goes_too_far_or_too_fast_is_refused_with_when_and_what(
    order: int, what: str, unit: str
) -> None:
    # The first instant is at rest with all the others' derivatives below.
    terms = [0.0, 0.0, 0.0]
    terms[order] = 1e301 / math.factorial(order)
    motion = ChassisMotion({"heave": Polynomial(tuple(terms))}, {"heave": UP})
    with pytest.raises(
        InputOutOfRange, match=f"{what} below 1e\\+300 {unit} in size".replace("^", r"\^")
    ) as caught:
        motion.states(np.array([0.0]), 2)
    assert (caught.value.name, caught.value.instant) == ("heave", 0.0)
    assert caught.value.value == pytest.approx(1e301)
    late = ChassisMotion({"heave": Polynomial((0.0, 1e299))}, {"heave": UP})
    with pytest.raises(InputOutOfRange, match="values below") as caught:
        late.states(np.array([0.0, 5.0, 20.0, 30.0]), 0)
    assert caught.value.instant == 20.0
