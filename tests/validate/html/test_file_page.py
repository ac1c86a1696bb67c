"""The page of a file of results: what it says is what the comparison of the file says."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from lotus_front import BUMP, ROLLING_RADIUS
from page_read import Read
from program import document as checked

from validate.cli import main

CAR = "double-wishbone"
HEAD = "bump [mm],camber [deg],toe [deg],<script>alert(1)</script>\n"
MAP = f"""
rolling_radius = {ROLLING_RADIUS}
columns.bump = {{ is = "travel.contact", printed = 0 }}
columns.camber.is = "wheel.camber"
"""
WRONG = 0.01  # degrees


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Printed camber that is wrong in one row, and toe that is right, with all that a run writes."""
    place = tmp_path_factory.mktemp("page")
    rows = [[bump, camber, toe] for bump, camber, toe, *_ in reversed(BUMP)]
    rows[2][1] += WRONG
    text = "".join(f"{bump:.1f},{camber:.4f},{toe:.4f},7\n" for bump, camber, toe in rows)
    (place / "<b>bump.csv").write_text(HEAD + text)
    (place / "map.toml").write_text(MAP)
    words = ["--data", str(place / "<b>bump.csv"), "--map", str(place / "map.toml"), CAR]
    words += ["--report", str(place / "page"), "--json", str(place / "json")]
    assert main(["validate", *words, "-q"]) == 1
    return place


def test_the_verdicts_of_the_page_are_those_of_the_json(folder: Path) -> None:
    document = checked(folder / "json")
    assert json.loads((folder / "page" / "results.json").read_text()) == document
    read = Read((folder / "page" / "index.html").read_text(encoding="utf-8"))
    assert read.verdict[1].endswith(
        "<b>bump.csv and the car of double-wishbone: 1 of 2 agree; disagrees: camber."
    )
    (comparison,) = document["scenes"][0]["comparisons"]
    shown = {row[0]: row for row in read.words if len(row) == 6}
    for row in comparison["rows"]:
        assert shown[row["name"]][1].startswith(row["verdict"])
        assert shown[row["name"]][4] == row["place"]
    assert shown["camber"][2] == f"{WRONG:.1e} deg"
    assert comparison["rows"][0]["place"] == "line 4"
    assert {"velocity", "position"} <= {row[0] for row in read.words if row[1:2] == ["not given"]}
    # Names of a file show as text.
    assert "b" not in {tag for tag, _ in read.tags}
    assert not [script for script in read.scripts if "alert(1)" in script]
    assert "0 of 1 scenes are drawn" not in read.text


def test_what_is_drawn_is_the_file_and_the_car_at_the_files_own_travel(folder: Path) -> None:
    read = Read((folder / "page" / "index.html").read_text(encoding="utf-8"))
    plots = [plot for _, plot in read.plots]
    assert len(plots) == 4  # of each angle its curve and its difference
    ours, file = plots[0]["data"]
    bumps = sorted(bump for bump, *_ in BUMP)
    assert ours["x"] == file["x"] == bumps
    apart = np.subtract(file["y"], ours["y"])
    wrong = bumps.index(sorted(bumps)[len(bumps) - 3])
    assert apart[wrong] == pytest.approx(WRONG, abs=1e-4)
    assert np.abs(np.delete(apart, wrong)).max() < 0.51e-4
    held, difference = plots[1]["data"]
    assert held["y"] == pytest.approx([0.5e-4] * len(bumps), rel=1e-3)
    assert difference["y"][wrong] == pytest.approx(apart[wrong], rel=1e-3)


def test_the_numbers_beside_the_page_are_the_files_and_those_it_was_held_to(folder: Path) -> None:
    with (folder / "page" / "numbers.csv").open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert len(lines) == 2 * len(BUMP)
    off = [line for line in lines if float(line["difference"]) > float(line["held_to"])]
    assert [(line["row"], line["is"]) for line in off] == [("line 4", "wheel.camber")]
    assert np.degrees(float(off[0]["difference"])) == pytest.approx(WRONG, abs=1e-4)
