"""What is said of the findings: nothing that the rows do not hold, and first where others are quicker."""

import math
from dataclasses import replace

import pytest
from made_rows import alike, dialled, error, grown, measured, study

from validate.cost.findings import findings
from validate.cost.row import Row
from validate.cost.sentences import bytes_words, digits, duration, verdicts


def position(way: str, largest: float, solve: float, **more: float) -> Row:
    return measured("bounce", way, "", {"position": largest}, solve, output=0.0, **more)


def said(rows: list[Row]) -> list[str]:
    return verdicts(findings(rows))


def test_another_way_that_is_quicker_is_named_with_both_times_and_their_ratio() -> None:
    count, sentence = said([position("series", 1e-12, 1e-5), position("mujoco", 1e-12, 8e-6)])
    assert "another way in 3" in count
    assert sentence == (
        "bounce: mujoco is quickest for position at every accuracy: 0.8 times as long as series, the "
        "quickest of ours (8 us against 10 us a configuration)."
    )


def test_ours_that_is_quicker_is_said_after_what_is_lost() -> None:
    rows = [
        measured(
            "bounce", "series", "", {"position": 1e-12, "velocity": 1e-12}, 1e-5, rates=1e-6, output=0.0
        ),
        measured(
            "bounce", "absolute", "", {"position": 1e-12, "velocity": 1e-12}, 9e-6, rates=2.4e-5, output=0.0
        ),
    ]
    _, lost, won = said(rows)
    assert lost.startswith("bounce: absolute is quickest for position at every accuracy: 0.9 times as long")
    assert won == (
        "bounce: series is quickest for velocity at every accuracy: absolute, the quickest of the others, "
        "takes 3 times as long (33 us against 11 us a configuration)."
    )


def test_accuracies_with_the_same_outcome_are_told_together_and_others_apart() -> None:
    rows = [
        position("newton", 1e-12, 1e-5),
        position("scipy-root", 1e-8, 5e-6),
        position("mujoco", 1e-12, 2e-5),
    ]
    _, lost, won = said(rows)
    assert "scipy-root is quickest for position at 1e-3 and 1e-6: 0.5 times" in lost
    assert "newton is quickest for position at 1e-9: mujoco, the quickest of the others, takes 2 times" in won


def test_a_tie_is_called_a_tie_and_nobody_wins_it() -> None:
    _, sentence = said([position("newton", 1e-12, 1e-5), position("relative", 1e-12, 1.01e-5)])
    assert sentence == (
        "bounce: newton and relative tie for position at every accuracy (10 us and 10.1 us a configuration)."
    )


def test_a_wrong_number_is_quick_in_no_sentence() -> None:
    rows = [position("series", 1e-12, 1e-5), position("printed", 2.5, 1e-9)]
    assert all("printed" not in sentence for sentence in said(rows))
    _, alone = said(rows)
    assert alone.startswith(
        "bounce: only point coordinates reach position at every accuracy, series the quickest"
    )


def test_what_ours_does_not_reach_is_said_with_how_close_it_comes() -> None:
    rows = [position("newton", 1e-5, 1e-5), position("mujoco", 1e-12, 1e-3)]
    (sentence,) = (one for one in said(rows) if "none of ours" in one)
    assert "mujoco is quickest for position at 1e-6 and 1e-9" in sentence
    assert "newton comes to 1.0e-05 mm of position" in sentence
    failed = replace(rows[0], status="failed", reason="locked at 2 s", errors={}, times={})
    (sentence,) = (one for one in said([failed, rows[1]]) if "none of ours" in one)
    assert "newton: failed: locked at 2 s" in sentence


def test_what_nobody_reaches_is_said_with_the_closest() -> None:
    (sentence,) = (
        one
        for one in said([position("newton", 1e-8, 1e-5), position("mujoco", 1e-7, 1e-5)])
        if "nobody reaches" in one
    )
    assert sentence == "bounce: nobody reaches position at 1e-9; the closest come to position to 1.0e-08 mm."


SIZES = [100, 1000, 10000]


def crossing(fixed: float, each: float, set_up: float) -> str:
    rows = [
        *grown(
            "bounce", "series", "", "instants", SIZES, fixed, each, dense=True, largest=1e-10, set_up=set_up
        ),
        *grown("bounce", "mujoco", "", "instants", SIZES, 0.0, 1.1e-5, largest=1e-12),
    ]
    (sentence,) = (one for one in said(rows) if one.startswith("bounce, position"))
    return sentence


def test_the_number_of_instants_from_which_ours_is_quicker_is_said() -> None:
    assert crossing(1e-3, 1e-6, 4e-3) == (
        "bounce, position at 1e-9 mm: mujoco is quicker below 100 instants, series above (500 with one "
        "set-up counted); series takes 1 ms and 1 us an instant and mujoco takes 11 us an instant."
    )
    assert (
        "series is quicker than mujoco at any number of instants (with one set-up counted mujoco below 400"
        in (crossing(0.0, 1e-6, 4e-3))
    )
    assert "mujoco is quicker than series at any number of instants, one set-up counted or not" in (
        crossing(1e-3, 2e-5, 4e-3)
    )
    assert "mujoco is quicker below 1,000,000 instants, beyond what was measured, series above" in (
        crossing(10.0, 1e-6, 0.0)
    )


def test_a_dial_that_turns_and_one_that_does_not_are_told_apart() -> None:
    turning = said(dialled("bounce", "series", 4e-6, 0.05, 0.0, output=0.0))[-1]
    assert "series at 1e-13 mm takes 3.55 times as long as at 1e-02 mm, 1.122 times for each digit" in turning
    assert "to the power -0.050 +- 0.000" in turning
    flat = said(dialled("bounce", "series", 4e-6, 0.0, 0.0, output=0.0))[-1]
    assert "neither the quartiles of these two nor the slope over all settings show that accuracy" in flat


def test_a_dial_s_sentence_says_what_its_ends_and_its_slope_say_where_they_differ() -> None:
    # Every setting's quartiles are a tenth apart: more than the 10^(11 * 0.002) = 5 % between the ends.
    small = said(dialled("bounce", "series", 4e-6, 0.002, 0.0, output=0.0, spread=0.1))[-1]
    assert "quartiles of these two overlap, but the slope over all settings is beyond two standard" in small
    assert "1.005 times for each digit; time goes with the setting to the power -0.002 +- 0.000" in small
    assert "not cost" not in small
    # Every other setting takes a fifth longer, the finest one among them: ends apart, and no growth.
    slower = dialled("bounce", "series", 4.8e-6, 0.0, 0.0, output=0.0)
    quick = dialled("bounce", "series", 4e-6, 0.0, 0.0, output=0.0)
    rough = said([pair[i % 2] for i, pair in enumerate(zip(quick, slower, strict=True))])[-1]
    assert "are apart, but the slope over all settings is within two standard errors of none" in rough


def test_a_setting_that_moves_no_error_is_no_dial_of_another_way() -> None:
    """The step of a difference quotient says nothing about positions."""
    rows = dialled("bounce", "newton-differences", 4e-6, 0.05, 0.0, output=0.0)
    rows = [replace(row, errors={"position": error(1e-13)}) for row in rows]
    assert not any("times as long as at" in sentence for sentence in said(rows))


def test_rows_of_nothing_say_nothing() -> None:
    assert said([]) == []


def test_every_sentence_of_a_whole_study_is_whole() -> None:
    sentences = said(study())
    assert len(sentences) == len(set(sentences)) > 5
    for sentence in sentences:
        assert sentence.endswith(".")
        assert "None" not in sentence
        assert "nan" not in sentence.replace("instant", "")


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (2.0, "2 s"),
        (0.0, "0 ns"),
        (1.2345e-3, "1.23 ms"),
        (9.996e-4, "1 ms"),
        (3.7e-5, "37 us"),
        (5e-8, "50 ns"),
    ],
)
def test_durations_have_three_digits_and_the_unit_that_suits(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_numbers_have_three_digits() -> None:
    assert [digits(x) for x in (0.0, 12345.6, 1.2345, 1e-5, 1e7)] == [
        "0",
        "12300",
        "1.23",
        "1.00e-05",
        "1.00e+07",
    ]
    assert digits(math.nan) == "not a number"
    assert [bytes_words(x) for x in (5, 2.5e6, 1.5e9)] == ["5 B", "2.5 MB", "1.5 GB"]


def test_quantities_with_the_same_outcome_share_a_sentence() -> None:
    rows = [
        measured("bounce", "series", "", alike(1e-12), 1e-5, rates=0.0, output=0.0),
        measured("bounce", "absolute", "", alike(1e-12), 2e-5, rates=0.0, output=0.0),
    ]
    _, won = said(rows)
    assert (
        "position, velocity, acceleration, angular velocity and angular acceleration at every accuracy" in won
    )
