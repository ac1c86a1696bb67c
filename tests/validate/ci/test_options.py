"""The options of `validate` for services that decide: folders, a factor, a stop at the first fault, files."""

import html
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from junit_schema import checked
from program import BOUNCE, PAST_ITS_END, complaints, run, short_scene

from pointcoord import Scene
from pointcoord.mechanism.file import MECHANISMS
from validate import Solution
from validate.cli import main
from validate.formulations.absolute_coordinates import AbsoluteCoordinates
from validate.formulations.registry import formulation

PAIR = ("--second", "absolute")
SOLVE = AbsoluteCoordinates.solve
# What a run leaves, by the ending of its file.
OPTIONS = {"json": "--json", "xml": "--junit", "md": "--summary", "npz": "--save-baseline"}


def left(folder: Path, *endings: str) -> tuple[dict[str, Path], list[str]]:
    """Files for what a run leaves, and its options that name them."""
    files = {ending: folder / f"out.{ending}" for ending in endings or OPTIONS}
    return files, [word for ending, file in files.items() for word in (OPTIONS[ending], str(file))]


def off_by(patch: pytest.MonkeyPatch, times: float) -> None:
    """The absolute model's wheel centre is wrong by so many times both claims together, at one instant."""

    def solve(self: AbsoluteCoordinates, scene: Scene) -> Solution:
        one, two = formulation("pointcoord").solve(scene), SOLVE(self, scene)
        claims = (s.accuracy.claims["position"]["wheel_centre"][2, 0] for s in (one, two))
        places = two.numbers["position"]["wheel_centre"].copy()
        places[2, 0] = one.numbers["position"]["wheel_centre"][2, 0] + times * sum(claims)
        return two.with_numbers({"position": {**two.numbers["position"], "wheel_centre": places}})

    patch.setattr(AbsoluteCoordinates, "solve", solve)


def test_every_toml_file_below_a_folder_is_compared_in_order_and_a_broken_one_is_its_own_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in ("b", "a/deep", "a.b"):
        (tmp_path / folder).mkdir(parents=True)
    wanted = [
        short_scene(tmp_path / "a/deep", "z.toml"),
        short_scene(tmp_path / "a", "y.toml"),
        short_scene(tmp_path / "a.b", "x.toml"),
        short_scene(tmp_path / "b", "w.toml"),
    ]
    (tmp_path / "b" / "notes.txt").write_text("no scene")
    (tmp_path / "b" / "folder.toml").mkdir()
    # A mechanism's file stands beside the scenes that name it, and is none.
    for shipped in ("double_wishbone", "axle"):
        (tmp_path / "b" / f"{shipped}.toml").write_bytes((MECHANISMS / f"{shipped}.toml").read_bytes())
    os.symlink(tmp_path, tmp_path / "b" / "again")  # leads in no circle
    (tmp_path / "a" / "m.toml").write_text("no = [toml")
    wanted.insert(1, str(tmp_path / "a" / "m.toml"))
    data = tmp_path / "out.json"
    assert main(["validate", *PAIR, "--scenes-dir", str(tmp_path), "--json", str(data)]) == 2
    scenes = json.loads(data.read_text())["scenes"]
    assert [scene["scene"] for scene in scenes] == wanted
    assert [scene["exit_status"] for scene in scenes] == [0, 2, 0, 0, 0]
    (line,) = complaints(capsys.readouterr().err)
    assert "m.toml" in line
    assert main(["validate", wanted[0], *PAIR, "--scenes-dir", str(tmp_path / "b"), "--json", str(data)]) == 0
    both = [scene["scene"] for scene in json.loads(data.read_text())["scenes"]]
    assert both == [wanted[0], wanted[-1]]
    # A scene that is named again is compared once.
    assert main(["validate", wanted[-1], *PAIR, "--scenes-dir", str(tmp_path / "b"), "--summary", "-"]) == 0
    assert "1 of 1 scene agrees" in capsys.readouterr().out


@pytest.mark.parametrize(("factor", "status"), [(None, 1), ("2.1", 0)])
def test_a_factor_is_what_a_difference_of_twice_the_tolerance_needs_and_every_result_says_it(
    factor: str | None,
    status: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    off_by(monkeypatch, 2.0)
    files, ends = left(tmp_path, "json", "xml", "md")
    more = () if factor is None else ("--tolerance-factor", factor)
    assert main(["validate", short_scene(tmp_path), *PAIR, *ends, *more]) == status
    out = capsys.readouterr().out
    held = float(factor or 1.0)
    data, root = json.loads(files["json"].read_text()), checked(files["xml"].read_bytes())
    assert data["tolerance_factor"] == data["scenes"][0]["comparisons"][0]["tolerance_factor"] == held
    properties = {one.get("name"): one.get("value") for one in root.iter("property")}
    assert float(properties["tolerance_factor"] or "") == held
    told = f"tolerances are not as derived but {held!r} times the derived tolerances"
    assert (told in out) == (held != 1.0)
    assert (told in files["md"].read_text()) == (held != 1.0)
    rows = {(r["quantity"], r["name"]): r for r in data["scenes"][0]["comparisons"][0]["rows"]}
    row = rows["position", "wheel_centre"]
    assert row["share"] == pytest.approx(2.0 / held, rel=0.15)  # of rounding: the tolerance is some 20 bits


def test_two_runs_leave_the_same_bytes(tmp_path: Path) -> None:
    """By processes of their own, with other seeds of the hashes of names."""
    short_scene(tmp_path, "a.toml")
    short_scene(tmp_path, "b.toml", samples="27", **PAST_ITS_END)
    found = []
    for seed in ("1", "2"):
        # Of one name, for the command line stands in them.
        files, ends = left(tmp_path)
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        words = ("validate", "--second", "printed", "--scenes-dir", str(tmp_path), "steer", *ends)
        done = run(*words, env=environment)
        assert done.returncode == 1, done.stderr
        said = re.sub(r" +\d+\.\d s ", " ", done.stdout)  # how long a scene took
        found.append([said, done.stderr, *(file.read_bytes() for file in files.values())])
    assert found[0] == found[1]


def test_ctrl_c_leaves_the_test_results_of_what_was_done_and_no_baseline(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first, last = short_scene(tmp_path, "a.toml"), short_scene(tmp_path, "b.toml", stop="1.5")

    def solve(self: AbsoluteCoordinates, scene: Scene) -> Solution:
        if scene.time.stop == 1.5:
            raise KeyboardInterrupt
        return SOLVE(self, scene)

    monkeypatch.setattr(AbsoluteCoordinates, "solve", solve)
    files, ends = left(tmp_path, "xml", "md", "npz")
    assert main(["validate", first, last, *PAIR, "-q", *ends]) == 130
    root = checked(files["xml"].read_bytes())
    assert [suite.get("name") for suite in root] == [f"{first}: pointcoord and absolute", last]
    assert "**Interrupted**" in files["md"].read_text()
    assert not files["npz"].exists()
    kept, interrupted = capsys.readouterr().err.splitlines()
    assert "not written, because the run did not finish" in kept
    assert f"{files['xml']} holds 1 of 2 scenes" in interrupted


@pytest.mark.parametrize(("fault", "status"), [("disagrees", 1), ("broken", 2), ("moved", 1)])
def test_the_run_stops_at_the_first_fault_and_names_what_was_not_run(
    fault: str,
    status: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    first, last = short_scene(tmp_path, "a.toml"), short_scene(tmp_path, "c.toml")
    wrong, kept = short_scene(tmp_path, "b.toml", stop="1.5"), str(tmp_path / "kept.npz")
    more: tuple[str, ...] = ()

    def off(self: AbsoluteCoordinates, scene: Scene) -> Solution:
        solution = SOLVE(self, scene)
        shift = 1e-3 if scene.time.stop == 1.5 else 0.0
        places = {name: array + shift for name, array in solution.numbers["position"].items()}
        return solution.with_numbers({"position": places})

    if fault == "moved":  # since the fault was mended that its baseline has
        with monkeypatch.context() as patch:
            patch.setattr(AbsoluteCoordinates, "solve", off)
            assert main(["validate", wrong, *PAIR, "-q", "--save-baseline", kept]) == 1
        more = ("--baseline", kept)
    elif fault == "broken":
        Path(wrong).write_text(BOUNCE.replace("samples", "sample"))
    else:
        monkeypatch.setattr(AbsoluteCoordinates, "solve", off)
    files, ends = left(tmp_path)
    capsys.readouterr()
    assert main(["validate", first, wrong, last, *PAIR, "--fail-fast", *more, *ends]) == status
    data, root = json.loads(files["json"].read_text()), checked(files["xml"].read_bytes())
    assert [scene["scene"] for scene in data["scenes"]] == [first, wrong]
    assert data["not_run"] == [last]
    said = f"not run (--fail-fast ended the run at {wrong}): {last}"
    assert said in capsys.readouterr().out
    assert said in html.unescape(files["md"].read_text())
    (skipped,) = root[-1].iter("skipped")
    assert root[-1].get("name") == last
    assert skipped.get("message") == f"not run: --fail-fast ended the run at {wrong}"
    with np.load(files["npz"]) as file:
        names = [one["scene"] for one in json.loads(str(file["head"]))["scenes"]]
    assert names == ([first] if fault == "broken" else [first, wrong])
