"""What is told of a sweep in a line."""

from pointcoord.effects.registry import QUANTITIES
from validate.output.sweep_summary import Extremes, _range

CAR = next(quantity.name for quantity in QUANTITIES.values() if quantity.of == "car")


def test_a_number_that_all_designs_share_is_told_once_and_of_none_of_them() -> None:
    assert _range(Extremes(-1e-19, 45, 2e-18, 8), (CAR, "toe")) == "0 in all designs"
    assert _range(Extremes(0.0, 45, 0.1, 8), (CAR, "toe")) == "0 (design 45) to 5.7296 (design 8)"
