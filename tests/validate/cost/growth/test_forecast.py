"""What a larger size is foreseen to cost."""

import pytest

from validate.cost.growth.forecast import foreseen

SIZES = (10.0, 100.0, 1000.0)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_a_power_law_is_carried_on(exponent: float) -> None:
    costs = [2e-3 * size**exponent for size in SIZES]
    assert foreseen(SIZES, costs, 1e4) == pytest.approx(2e-3 * 1e4**exponent)


def test_a_fixed_part_does_not_hide_what_grows() -> None:
    costs = [1.0 + 1e-3 * size for size in SIZES]
    assert foreseen(SIZES, costs, 1e6) == pytest.approx(1001.0)


def test_a_cost_that_falls_is_taken_for_one_that_stays() -> None:
    assert foreseen(SIZES, [1.0, 3.0, 2.0], 1e6) == pytest.approx(2.0)


def test_nothing_is_foreseen_from_one_size_or_from_costs_that_were_not_seen() -> None:
    assert foreseen((10.0,), (1.0,), 1e6) is None
    assert foreseen(SIZES, (0.0, 0.0, 1.0), 1e6) is None
    assert foreseen((), (), 1e6) is None
