"""The program as its users meet it: help, start, the main job, the picture of a car."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from pointcoord import built_in_scenes
from validate import cli
from validate.cli import main
from validate.commands.pages import summary
from validate.exit_status import MEANINGS, ORDER, ExitStatus
from validate.paper.scenes import DEFAULT_SCENES


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_every_command_has_its_help_and_the_overview_names_it(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([name, "--help"]) == 0
    page = capsys.readouterr().out
    assert page.startswith(f"usage: pointcoord {name} ")
    assert main(["--help"]) == 0
    overview = capsys.readouterr().out
    assert re.search(rf"^  {name} +{re.escape(summary(name))}$", overview, flags=re.M)
    # Every status is explained where a user looks.
    for status in ExitStatus:
        line = rf"^ +{status.value}  {re.escape(MEANINGS[status])}$"
        assert re.search(line, page, flags=re.M)
        assert re.search(line, overview, flags=re.M)
    assert {*ORDER, ExitStatus.INTERRUPTED, ExitStatus.TERMINATED} == set(ExitStatus)


def test_a_command_brings_nothing_with_it_that_it_does_not_need() -> None:
    """So that solving needs no extra."""
    program = (
        "import sys\n"
        "from validate.cli import main\n"
        "for words in ('--help', 'simulate steer -q', 'table steer', 'sweep steer --vary strut_top.z=0,1'):\n"
        "    main(words.split())\n"
        "print(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    others = {"pinocchio", "mpmath", "flint", "pandas", "pyarrow", "scipy", "dask", "matplotlib"}
    others |= {"threadpoolctl", "validate.cost", "validate.html", "validate.reference"}
    assert not others & {*done.stderr.split()}


def test_the_main_job_prints_every_scene_and_ends_with_0(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert {*DEFAULT_SCENES} == {*built_in_scenes()}
    # One of them has the longest name.
    few = ("bounce", "steer", "bounce-on-a-heaving-chassis", "five-link")
    monkeypatch.setattr("validate.commands.comparison.DEFAULT_SCENES", few)
    assert main(["validate", "--json", str(tmp_path / "all.json")]) == 0
    out, err = capsys.readouterr()
    # A warning is said once, with the scenes that it is about.
    (warning,) = err.splitlines()
    assert warning.startswith(f"pointcoord: warning: {', '.join(few[:3])}: closing the drawing moves ")
    head, _, titles, *lines = out.splitlines()
    assert head == "pointcoord and absolute; pointcoord-newton and absolute: 4 scenes"
    assert titles.split()[:3] == ["scene", "verdict", "time"]
    line = re.compile(r"(\S+) +agrees +\d+\.\d s +\d+%  .* at .* s(, .*)?")
    assert [found[1] for one in lines if (found := line.fullmatch(one))] == [*few]
    assert lines[-1] == "4 of 4 scenes agree."
    assert max(map(len, lines)) <= 120  # names of scenes and of points are as long as they are
    data = json.loads((tmp_path / "all.json").read_text())
    assert [scene["scene"] for scene in data["scenes"]] == [*few]
    assert len(data["printed_tables"]["rows"]) == 18
    monkeypatch.setattr("validate.commands.comparison.DEFAULT_SCENES", few[:1])
    assert main(["validate", "-v"]) == 0
    out = capsys.readouterr().out
    paper = (
        "bounce: pointcoord and absolute",
        "10.3 mm r.m.s.",
        "cannot be matched to better than about 10 mm",
    )
    assert [words for words in paper if words not in out] == []


def test_the_readme_s_picture_is_what_its_command_makes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture, target = Path(__file__).parents[3] / ".github" / "hardpoints.svg", tmp_path / "car.svg"
    assert main(["draw", "off-axis-strut"]) == 0
    assert main(["draw", "off-axis-strut", "-o", str(target)]) == 0
    out, err = capsys.readouterr()
    assert (out, err) == (target.read_text(), "")
    # How far closing moves the points is rounding, which another machine rounds otherwise.
    made, kept = (
        [line for line in text.splitlines() if "moves by" not in line] for text in (out, picture.read_text())
    )
    assert made == kept
