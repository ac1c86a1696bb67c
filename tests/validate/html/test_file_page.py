"""The page of a file of results says what the comparison of the file says."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from lotus_front import BUMP, ROLLING_RADIUS
from page_read import Read
from program import document as checked

from validate.cli import main

MAP = f"""
rolling_radius = {ROLLING_RADIUS}
columns.bump = {{ is = "travel.contact", printed = 0 }}
columns.camber.is = "wheel.camber"
"""
WRONG, ROW = 0.01, 2  # degrees, in the third row


def test_page_plots_and_numbers_beside_it_are_those_of_the_json_and_of_the_file(tmp_path: Path) -> None:
    """Printed camber that is wrong in one row, and toe that is right."""
    file, text = tmp_path / "<b>bump.csv", "bump [mm],camber [deg],toe [deg],<script>alert(1)</script>\n"
    for row, (bump, camber, toe, *_) in enumerate(reversed(BUMP)):
        text += f"{bump:.1f},{camber + WRONG * (row == ROW):.4f},{toe:.4f},7\n"
    file.write_text(text)
    (tmp_path / "map.toml").write_text(MAP)
    words = ["--data", str(file), "--map", str(tmp_path / "map.toml"), "double-wishbone", "-q"]
    words += ["--report", str(tmp_path / "page"), "--json", str(tmp_path / "json")]
    assert main(["validate", *words]) == 1
    document = checked(tmp_path / "json")
    assert json.loads((tmp_path / "page" / "results.json").read_text()) == document
    read = Read((tmp_path / "page" / "index.html").read_text(encoding="utf-8"))
    assert read.verdict[1].endswith(
        "<b>bump.csv and the car of double-wishbone: 1 of 2 agree; disagrees: camber."
    )
    rows = document["scenes"][0]["comparisons"][0]["rows"]
    shown = {row[0]: row for row in read.words if len(row) == 6}
    for row in rows:
        assert shown[row["name"]][1].startswith(row["verdict"])
        assert shown[row["name"]][4] == row["place"]
    assert shown["camber"][2] == f"{WRONG:.1e} deg"
    assert rows[0]["place"] == "line 4"
    assert {"velocity", "position"} <= {row[0] for row in read.words if row[1:2] == ["not given"]}
    # Names of a file show as text.
    assert "b" not in {tag for tag, _ in read.tags}
    assert not [script for script in read.scripts if "alert(1)" in script]
    assert "0 of 1 scenes are drawn" not in read.text

    # Drawn are the file and the car at the travel of the file.
    plots = [plot for _, plot in read.plots]
    assert len(plots) == 4  # of each angle its curve and its difference
    ours, theirs = plots[0]["data"]
    bumps = sorted(bump for bump, *_ in BUMP)
    assert ours["x"] == theirs["x"] == bumps
    apart, wrong = np.subtract(theirs["y"], ours["y"]), len(bumps) - 1 - ROW
    assert apart[wrong] == pytest.approx(WRONG, abs=1e-4)
    assert np.abs(np.delete(apart, wrong)).max() < 0.51e-4
    held, difference = plots[1]["data"]
    assert held["y"] == pytest.approx([0.5e-4] * len(bumps), rel=1e-3)
    assert difference["y"][wrong] == pytest.approx(apart[wrong], rel=1e-3)

    with (tmp_path / "page" / "numbers.csv").open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert len(lines) == 2 * len(BUMP)
    (off,) = (line for line in lines if float(line["difference"]) > float(line["held_to"]))
    assert (off["row"], off["is"]) == ("line 4", "wheel.camber")
    assert np.degrees(float(off["difference"])) == pytest.approx(WRONG, abs=1e-4)
