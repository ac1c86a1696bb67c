"""What an engineer reads of a car: columns, units, rows, endings, and what is said where there is none."""

import csv
from pathlib import Path

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.cli import main


def test_a_table_has_the_motions_numbers_in_degrees_and_mm(tmp_path: Path) -> None:
    target = tmp_path / "t.csv"
    assert main(["table", "wheel-travel", "--rows", "5", "-o", str(target), "-q"]) == 0
    with target.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    scene = Scene.load("wheel-travel")
    # A chain of series is cut for the highest rate that is asked for, so that last digits may differ.
    asking = scene.model_copy(update={"effects": scene.mechanism.effects})
    motion = simulate(asking).at(np.linspace(0.0, 1.0, 5))
    assert [float(row["wheel_travel [mm]"]) for row in rows] == [-50.0, -25.0, 0.0, 25.0, 50.0]
    assert [float(row["camber [deg]"]) for row in rows] == pytest.approx(
        np.degrees(motion.wheel["camber"]).tolist(), rel=1e-11
    )
    gradient = np.degrees(motion.angle_gradient["toe_by_travel"])
    assert [float(row["toe_by_travel [deg/mm]"]) for row in rows] == pytest.approx(gradient, rel=1e-11)
    ratio = motion.dimension_gradient["damper_length_by_travel"].tolist()
    assert [float(row["damper_length_by_travel [mm/mm]"]) for row in rows] == pytest.approx(ratio, rel=1e-11)


def test_a_table_in_text_says_each_sign_and_in_markdown_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["table", "semi-trailing-arm", "--number", "camber", "--number", "recession"]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "camber [deg]" in said
    assert "camber: positive where the wheel leans out at the top" in said
    assert main([*words, "-o", str(tmp_path / "t.md")]) == 0
    assert "- recession: positive where the contact point goes rearward" in (tmp_path / "t.md").read_text(
        "utf-8"
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["bricard"], "there is no number of a wheel"),
        (["wheel-travel", "--number", "tow"], "did you mean 'toe'?"),
        (["five-link", "--number", "caster"], "needs the role steering_axis"),
        (["bmw-e90-strut", "--number", "scrub_radius"], "wheel_radius = 300.0"),
        (["wheel-travel", "-o", "t.pdf"], "allowed: .csv, .md"),
    ],
)
def test_what_there_is_not_is_one_line(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["table", *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
