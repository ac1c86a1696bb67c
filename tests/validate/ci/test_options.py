"""The options of `validate` for services that decide: folders, a factor, a stop at the first fault, files."""

import html
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from junit_schema import checked
from program import BOUNCE, PAST_ITS_END, complaints, document, run, short_scene

from pointcoord import Scene
from pointcoord.mechanism.file import MECHANISMS
from validate import Solution
from validate.cli import main
from validate.exit_status import ExitStatus, combined
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


def compared(*words: str, folder: Path, status: int = 0) -> list[tuple[str, int]]:
    """Scenes that a run has compared, with the exit status of each."""
    target = folder / "out.json"
    assert main(["validate", *words, *PAIR, "--json", str(target)]) == status
    return [(scene["scene"], scene["exit_status"]) for scene in document(target)["scenes"]]


def test_every_toml_file_below_a_folder_is_compared_in_order_and_a_broken_one_is_its_own_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in ("b", "a/deep", "a.b"):
        (tmp_path / folder).mkdir(parents=True)
    deep, y, x, w = (
        short_scene(tmp_path, name) for name in ("a/deep/z.toml", "a/y.toml", "a.b/x.toml", "b/w.toml")
    )
    broken = tmp_path / "a" / "m.toml"
    broken.write_text("no = [toml")
    (tmp_path / "b" / "notes.txt").write_text("no scene")
    (tmp_path / "b" / "folder.toml").mkdir()
    # A mechanism's file stands beside the scenes that name it, and is none.
    for shipped in ("double_wishbone", "axle"):
        (tmp_path / "b" / f"{shipped}.toml").write_bytes((MECHANISMS / f"{shipped}.toml").read_bytes())
    os.symlink(tmp_path, tmp_path / "b" / "again")  # leads in no circle
    found = compared("--scenes-dir", str(tmp_path), folder=tmp_path, status=2)
    assert found == [(deep, 0), (str(broken), 2), (y, 0), (x, 0), (w, 0)]
    (line,) = complaints(capsys.readouterr().err)
    assert "m.toml" in line
    # A scene that is named again is compared once.
    below = ("--scenes-dir", str(tmp_path / "b"))
    assert compared(y, *below, folder=tmp_path) == [(y, 0), (w, 0)]
    assert compared(w, *below, folder=tmp_path) == [(w, 0)]


@pytest.mark.parametrize(("factor", "status"), [(1.0, 1), (2.1, 0)])
def test_a_factor_is_what_a_difference_of_twice_the_tolerance_needs_and_every_result_says_it(
    factor: float,
    status: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The absolute model's wheel centre is wrong by twice both claims together, at one instant."""

    def solve(self: AbsoluteCoordinates, scene: Scene) -> Solution:
        one, two = formulation("pointcoord").solve(scene), SOLVE(self, scene)
        claims = (s.accuracy.claims["position"]["wheel_centre"][2, 0] for s in (one, two))
        places = two.numbers["position"]["wheel_centre"].copy()
        places[2, 0] = one.numbers["position"]["wheel_centre"][2, 0] + 2.0 * sum(claims)
        return two.with_numbers({"position": {**two.numbers["position"], "wheel_centre": places}})

    monkeypatch.setattr(AbsoluteCoordinates, "solve", solve)
    files, ends = left(tmp_path, "json", "xml", "md")
    more = () if factor == 1.0 else ("--tolerance-factor", str(factor))
    assert main(["validate", short_scene(tmp_path), *PAIR, *ends, *more]) == status
    data, root = document(files["json"]), checked(files["xml"].read_bytes())
    (comparison,) = data["scenes"][0]["comparisons"]
    assert data["tolerance_factor"] == comparison["tolerance_factor"] == factor
    assert f'name="tolerance_factor" value="{factor!r}"' in files["xml"].read_text()
    assert root.get("failures") == str(status)
    said = f"tolerances are not as derived but {factor!r} times the derived tolerances"
    for text in (capsys.readouterr().out, files["md"].read_text()):
        assert (said in text) == (factor != 1.0)
    (row,) = (r for r in comparison["rows"] if (r["quantity"], r["name"]) == ("position", "wheel_centre"))
    assert row["share"] == pytest.approx(2.0 / factor, rel=0.15)  # of rounding: the tolerance is some 20 bits


def test_two_runs_leave_the_same_bytes(tmp_path: Path) -> None:
    """By processes of their own, with other seeds of the hashes of names."""
    short_scene(tmp_path, "a.toml")
    short_scene(tmp_path, "b.toml", samples="27", **PAST_ITS_END)
    found = []
    for seed in ("1", "2"):
        # Of one name, for the command line stands in them.
        files, ends = left(tmp_path)
        words = ("validate", "--second", "printed", "--scenes-dir", str(tmp_path), "steer", *ends)
        done = run(*words, env={**os.environ, "PYTHONHASHSEED": seed})
        assert done.returncode == 1, done.stderr
        said = re.sub(r" +\d+\.\d s ", " ", done.stdout)  # how long a scene took
        found.append([said, done.stderr, *(file.read_bytes() for file in files.values())])
    assert found[0] == found[1]


def test_every_ending_keeps_to_the_schemas_and_names_each_scene_with_its_errors(tmp_path: Path) -> None:
    good, bad = short_scene(tmp_path, "good.toml"), short_scene(tmp_path, "bad.toml", samples="0")
    past = short_scene(tmp_path, "past.toml", samples="27", **PAST_ITS_END)
    files, ends = left(tmp_path, "json", "xml", "md")
    for scenes, second, status in (
        ((good,), "absolute", 0),
        ((good,), "printed", 1),
        ((bad,), "absolute", 2),
        ((past,), "absolute", 3),
        ((past, bad, good), "absolute", 2),
        ((past, bad, good), "printed", 1),
    ):
        assert main(["validate", *scenes, "--second", second, "-q", *ends]) == status, scenes
        data, root = document(files["json"]), checked(files["xml"].read_bytes())
        verdict = ExitStatus(status).verdict
        assert (data["exit_status"], data["verdict"]) == (status, verdict)
        assert f"**{verdict.capitalize()}**" in files["md"].read_text()
        assert [scene["scene"] for scene in data["scenes"]] == [*scenes]
        assert combined(ExitStatus(scene["exit_status"]) for scene in data["scenes"]) == status
        suites = {suite.get("name", "").partition(": ")[0]: [*suite.iter("error")] for suite in root}
        assert [*suites] == [*scenes]
        assert suites.get(good, []) == []
        if past in suites:
            refusals = data["scenes"][0]["refusals"]
            assert [error.get("type") for error in suites[past]] == [one["error"] for one in refusals]
            assert [error.get("message") for error in suites[past]] == [one["message"] for one in refusals]
        for error in suites.get(bad, []):
            assert error.get("type") == "SceneError"
            assert "samples" in error.get("message", "")
        assert len(suites.get(bad, [0])) == 1


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

    if fault == "broken":
        Path(wrong).write_text(BOUNCE.replace("samples", "sample"))
    else:
        monkeypatch.setattr(AbsoluteCoordinates, "solve", off)
    if fault == "moved":  # since the fault was mended that its baseline has
        assert main(["validate", wrong, *PAIR, "-q", "--save-baseline", kept]) == 1
        monkeypatch.setattr(AbsoluteCoordinates, "solve", SOLVE)
        more = ("--baseline", kept)
    files, ends = left(tmp_path)
    capsys.readouterr()
    assert main(["validate", first, wrong, last, *PAIR, "--fail-fast", *more, *ends]) == status
    data, root = document(files["json"]), checked(files["xml"].read_bytes())
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
