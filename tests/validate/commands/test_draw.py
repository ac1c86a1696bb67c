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


def test_the_readme_s_picture_is_what_its_command_makes(capsys: pytest.CaptureFixture[str]) -> None:
    picture = Path(__file__).parents[3] / ".github" / "hardpoints.svg"
    assert main(["draw", "off-axis-strut"]) == 0
    made, kept = capsys.readouterr().out.splitlines(), picture.read_text().splitlines()
    # How far closing moves the points is rounding, which another machine rounds otherwise.
    assert [line for line in made if "moves by" not in line] == [
        line for line in kept if "moves by" not in line
    ]


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
