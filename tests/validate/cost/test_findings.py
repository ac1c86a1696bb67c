"""What the table says: no wrong number is quick, overlapping times are a tie, planted laws come out."""

from collections.abc import Sequence
from dataclasses import replace

import pytest
from made_rows import grown, measured, study

from validate.cost.findings import growths, races, sentences
from validate.cost.table import Row, frame


def verdicts(rows: Sequence[Row], quantity: str = "position") -> dict[float, str]:
    found = races(frame(rows))
    return {one.accuracy: one.verdict for one in found[found.quantity == quantity].itertuples()}


def raced(
    series: float, other: float, errors: tuple[float, float] = (1e-12, 1e-12), spread: float = 0.02
) -> list[Row]:
    """Two ways with these times and errors."""
    ours = measured("a", "series", "", {"position": errors[0]}, series, spread=spread)
    return ours + measured("a", "relative", "", {"position": errors[1]}, other, spread=spread)


def test_the_quicker_one_wins_and_times_whose_quartiles_overlap_tie() -> None:
    assert set(verdicts(raced(1e-5, 2e-5)).values()) == {"ours"}
    assert set(verdicts(raced(2e-5, 1e-5)).values()) == {"other"}
    assert set(verdicts(raced(1.00e-5, 1.03e-5)).values()) == {"tie"}
    # Intervals that touch are no difference.
    assert set(verdicts(raced(1.0, 3.0, spread=0.5)).values()) == {"tie"}
    found = races(frame(raced(1e-5, 2e-5)))
    assert found.ratio.tolist() == pytest.approx([2.0] * 3)
    assert [one["way"] for one in found.reached[0]] == ["series", "relative"]


def test_a_wrong_number_is_never_quick() -> None:
    found = verdicts(raced(1e-9, 1e-3, errors=(1e-4, 1e-12)))
    assert found == {1e-3: "ours", 1e-6: "only others", 1e-9: "only others"}
    assert set(verdicts(raced(1e-9, 1e-3, errors=(1.0, 1.0))).values()) == {"nobody"}


def test_the_references_own_radius_counts_as_error() -> None:
    rows = [replace(row, radius=1e-9) for row in raced(1e-5, 2e-5, errors=(0.5e-9, 0.0))]
    assert verdicts(rows)[1e-9] == "only others"
    assert verdicts(rows)[1e-6] == "ours"


@pytest.mark.parametrize("power", [0.5, 1.0, 2.8])
def test_planted_exponents_come_out_of_the_largest_sizes(power: float) -> None:
    sizes = [10**k for k in range(2, 7)]
    found = growths(frame(grown("a", "series", "", "designs", sizes, 0.0, 1e-6, power=power, bytes_each=1e3)))
    time, memory = found.itertuples()
    assert (time.of, memory.of, time.largest) == ("time", "memory", 1e6)
    assert time.exponent == pytest.approx(power, abs=1e-9)
    assert time.error == pytest.approx(0.0, abs=1e-9)
    assert memory.exponent == pytest.approx(1.0, abs=1e-2)
    assert time.value == pytest.approx(1e-6 * 1e6**power)


def test_three_sentences_say_who_is_quickest_what_digits_cost_and_where_others_win() -> None:
    quickest, digits, won = sentences(frame(study()))
    assert quickest.startswith("A pose to 1e-9 mm of position takes series 8.95 us to 14.3 us, mujoco 37 us")
    assert quickest.endswith("; not reached by scipy-root, printed.")
    assert "11 digits" in digits
    assert "series 3.5" in digits
    assert "Of 30 races" in won
    assert "other ways than pointcoord's win 0" in won
    # Where another way is quicker it is named.
    assert "win 3 (relative)" in sentences(frame(raced(2e-5, 1e-5)))[-1]
