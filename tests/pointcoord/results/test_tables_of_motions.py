"""A motion as a data frame is its CSV, whichever library makes it; nothing else needs one of them.

A notebook shows the numbers of a motion and the rows of an outcome, and text in it does not act.
"""

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from every_number import every_effect

from pointcoord import MissingLibrary, Scene, UnknownName, simulate
from pointcoord.results.named_columns import LIBRARIES, html_table
from validate import compare
from validate.output.columns import csv_lines, rows_of_motion


def without(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Have some libraries not installed."""
    for name in names:
        monkeypatch.setitem(sys.modules, name, None)


def library_of(frame: object) -> str:
    return type(frame).__module__.partition(".")[0]


def as_csv(scene: Scene) -> dict[str, list[float]]:
    head, *rows = "".join(csv_lines(rows_of_motion(simulate(scene)))).splitlines()
    numbers = [[float(cell) for cell in row.split(",")] for row in rows]
    return dict(zip(head.split(","), map(list, zip(*numbers, strict=True)), strict=True))


# All effects, on a chassis that heaves.
SCENE = every_effect("bounce-on-a-heaving-chassis")


def test_a_frame_has_the_columns_of_the_csv_with_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = as_csv(SCENE)
    # Camber, kingpin, toe, caster and the steer angle, two of them by arcsine too, and the change of toe.
    assert sum(name.endswith("[deg]") for name in expected) == 8
    motion = simulate(SCENE)
    for there in LIBRARIES:
        frame = motion.to_dataframe(there)
        assert library_of(frame) == there
        assert list(frame.columns) == list(expected)
        for name, column in expected.items():
            assert frame[name].to_numpy().dtype == np.float64
            assert frame[name].to_list() == column, (there, name)
        assert not np.shares_memory(frame["time [s]"].to_numpy(), motion.times)
    for place, there in enumerate(LIBRARIES):
        without(monkeypatch, *LIBRARIES[:place])
        assert library_of(motion.to_dataframe()) == there


def test_a_library_that_is_not_there_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, "polars")
    motion = simulate(Scene.load("steer"))
    with pytest.raises(MissingLibrary, match=r"'polars', which is not .* 'pointcoord\[polars\]'$"):
        motion.to_dataframe("polars")
    without(monkeypatch, "pandas")
    with pytest.raises(ImportError, match="'pandas' or 'polars'"):
        motion.to_dataframe()
    with pytest.raises(UnknownName, match="did you mean 'pandas'"):
        motion.to_dataframe("panda")


def test_a_library_that_does_not_load_is_said_not_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "pandas", raising=False)
    (tmp_path / "pandas.py").write_text("import a_library_of_pandas_that_is_gone")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(MissingLibrary, match="does not load: No module named 'a_library_of_pandas"):
        simulate(Scene.load("steer")).to_dataframe()


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
