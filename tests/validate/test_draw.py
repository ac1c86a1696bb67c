"""The command `draw` writes a picture, or says why not in one line."""

from pathlib import Path

import pytest

from validate.cli import main


def test_a_picture_is_written_where_it_was_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "car.svg"
    assert main(["draw", "off-axis-strut", "-o", str(target)]) == 0
    assert main(["draw", "off-axis-strut"]) == 0
    shown = capsys.readouterr()
    assert shown.out == target.read_text()
    assert shown.out.startswith("<svg ")
    assert shown.err == ""


def test_the_readme_s_picture_is_the_built_in_scene_s() -> None:
    picture = Path(__file__).parents[2] / ".github" / "hardpoints.svg"
    shown = [line for line in picture.read_text().splitlines() if "<text" in line and " mm" in line]
    assert len(shown) >= 11  # every hardpoint with its coordinates
    assert any("strut_lower: 8, -640, 440 mm" in line for line in shown)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [(["draw", "no-such-scene"], "bounce"), (["draw", "steer", "-o", ""], "names no file")],
)
def test_what_cannot_be_drawn_is_said_in_a_line(
    arguments: list[str], word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert word in shown.err
    assert len(shown.err.splitlines()) == 1
