"""A notebook shows the numbers of a motion and the rows of an outcome, and text in it does not act."""

import re

import pytest

from pointcoord import Scene, simulate
from pointcoord.results.named_columns import html_table
from validate import compare


def cells(html: str, kind: str) -> list[str]:
    return re.findall(rf"<{kind}>(.*?)</{kind}>", html)


def test_a_motion_shows_the_numbers_of_the_car_from_its_first_instant_to_its_last() -> None:
    motion = simulate("double-wishbone")
    html = motion._repr_html_()
    head = cells(html, "th")
    assert head[0] == "time [s]"
    assert "wheel.camber [deg]" in head
    rows = [[float(cell) for cell in cells(row, "td")] for row in re.findall(r"<tr>(<td>.*?)</tr>", html)]
    assert len(rows) == 11
    assert (rows[0][0], rows[-1][0]) == (motion.times[0], motion.times[-1])
    camber = motion.to_dataframe("pandas")["wheel.camber [deg]"]
    # Seven digits are shown.
    assert rows[-1][head.index("wheel.camber [deg]")] == pytest.approx(camber.iloc[-1], rel=1e-6)


def test_one_without_numbers_of_a_car_shows_places() -> None:
    head = cells(simulate(Scene.load("bricard"))._repr_html_(), "th")
    assert len(head) > 1
    assert all(name.startswith("position.") for name in head[1:])


def test_an_outcome_shows_every_row() -> None:
    outcome = compare(Scene.load("steer"), "pointcoord", "absolute")
    assert cells(outcome._repr_html_(), "td")[4::5] == [row.verdict for row in outcome.rows]


def test_no_text_acts() -> None:
    html = html_table("<script>", ["<b>"], [["a & b"]])
    assert "<script>" not in html
    assert "<b>" not in html
    assert "a &amp; b" in html
