"""Baselines: what moved beyond what both claims allow, and what cannot be held to one."""

import json
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from junit_schema import checked
from program import PAST_ITS_END, short_scene

from pointcoord import Scene
from validate import Outcome, Solution, compare
from validate.ci import baseline as module
from validate.ci.baseline import Baseline, Move, Recorder, Since, read_baseline
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.cli import main
from validate.comparison.compare import compare_solutions
from validate.comparison.examined import Examined
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.absolute_coordinates import AbsoluteCoordinates

SCENE = Scene.load("steer")
OUTCOME = compare(SCENE, "pointcoord", "absolute", "steer")


def saved(folder: Path) -> Baseline:
    target, recorder = folder / "b.npz", Recorder()
    recorder.add("steer", SCENE, [OUTCOME])
    target.write_bytes(recorder.content())
    return read_baseline(str(target))


def moved(error: float) -> Outcome:
    """The same run, the absolute model's wheel centre off by an error at the instant number 17."""
    one, two = OUTCOME.solutions
    numbers = {name: array.copy() for name, array in two.numbers["position"].items()}
    numbers["wheel_centre"][17, 1] += error
    return compare_solutions(SCENE, one, two.with_numbers({"position": numbers}), "steer")


def by_number(since: Since) -> dict[tuple[str, str, str], Move]:
    return {(move.formulation, move.row.quantity, move.row.name): move for move in since.moves}


def test_a_baseline_gives_back_every_number_and_claim_bit_by_bit(tmp_path: Path) -> None:
    (steer,) = saved(tmp_path).scenes.values()
    for then, now in zip(steer.solutions, OUTCOME.solutions, strict=True):
        assert then.formulation == now.formulation
        assert np.array_equal(then.times, now.times)
        assert np.array_equal(then.accuracy.condition, now.accuracy.condition)
        for quantity, numbers in now.numbers.items():
            for name, array in numbers.items():
                assert np.array_equal(then.numbers[quantity][name], array)
        for quantity, claims in now.accuracy.claims.items():
            for name, array in claims.items():
                assert np.array_equal(then.accuracy.claims[quantity][name], array)


def test_a_run_that_is_the_same_has_moved_by_nothing(tmp_path: Path) -> None:
    since = saved(tmp_path).since("steer", SCENE, [OUTCOME])
    assert (since.standing, since.status) == ("compared", ExitStatus.AGREE)
    assert {move.row.difference for move in since.moves} == {0.0}
    assert {move.verdict for move in since.moves} == {"agrees"}
    assert len(since.moves) == 2 * len(OUTCOME.rows)


@pytest.mark.parametrize(("part", "verdict"), [(0.9, "agrees"), (1.1, "moved")])
def test_a_number_has_moved_beyond_twice_its_claim_and_not_below(
    part: float, verdict: str, tmp_path: Path
) -> None:
    """Twice: the same claim is made then and now."""
    claim = OUTCOME.solutions[1].accuracy.claims["position"]["wheel_centre"][17, 1]
    outcome = moved(part * 2.0 * claim)
    # What was really added to a coordinate of some 400 mm, after its rounding.
    added = abs(
        outcome.solutions[1].numbers["position"]["wheel_centre"]
        - OUTCOME.solutions[1].numbers["position"]["wheel_centre"]
    ).max()
    since = saved(tmp_path).since("steer", SCENE, [outcome])
    found = by_number(since)
    move = found.pop(("absolute", "position", "wheel_centre"))
    assert move.verdict == verdict
    assert move.row.difference == added
    assert move.row.share == pytest.approx(added / (2.0 * claim), rel=1e-9)
    assert move.row.instant == SCENE.instants[17]
    assert {other.verdict for other in found.values()} == {"agrees"}
    assert since.status is (ExitStatus.DISAGREE if verdict == "moved" else ExitStatus.AGREE)


def test_a_factor_widens_what_may_move(tmp_path: Path) -> None:
    claim = OUTCOME.solutions[1].accuracy.claims["position"]["wheel_centre"][17, 1]
    baseline, outcome = saved(tmp_path), moved(6.0 * claim)
    assert len(baseline.since("steer", SCENE, [outcome]).moved) == 1
    assert not baseline.since("steer", SCENE, [outcome], 4.0).moved


def test_another_car_under_the_name_is_told_by_the_points_that_differ_and_is_not_compared(
    tmp_path: Path,
) -> None:
    points = {**SCENE.mechanism.points, "tie_rod_outer": (560.0, -300.0, 60.001)}
    part = SCENE.mechanism.model_copy(update={"points": points})
    since = saved(tmp_path).since("steer", SCENE.model_copy(update={"mechanism": part}), [OUTCOME])
    assert (since.standing, since.moves) == ("another car", ())
    assert since.words == "steer is another car than in the baseline: tie_rod_outer"
    assert since.status is ExitStatus.NO_VERDICT


def test_another_motion_of_the_car_is_not_compared(tmp_path: Path) -> None:
    content = SCENE.model_dump(exclude_none=True)
    content["time"]["samples"] += 1
    since = saved(tmp_path).since("steer", Scene.from_mapping(content, "steer"), [OUTCOME])
    assert since.standing == "another motion"
    assert since.status is ExitStatus.NO_VERDICT


def test_numbers_that_are_new_or_gone_are_named(tmp_path: Path) -> None:
    one, two = OUTCOME.solutions
    less = {q: part for q, part in one.numbers.items() if q != "velocity"}
    more = {"position": {**two.numbers["position"], "brake": two.numbers["position"]["wheel_centre"]}}
    changed = replace(OUTCOME, solutions=(replace(one, numbers=less), two.with_numbers(more)))
    since = saved(tmp_path).since("steer", SCENE, [changed])
    odd = {
        (m.formulation, m.row.quantity, m.row.name): m.verdict for m in since.moves if m.verdict != "agrees"
    }
    assert odd.pop(("absolute", "position", "brake")) == "new"
    assert {(who, what) for who, what, _ in odd} == {("pointcoord", "velocity")}
    assert set(odd.values()) == {"gone"}
    assert since.lost
    assert since.status is ExitStatus.DISAGREE
    # More than then is no loss.
    grown = replace(OUTCOME, solutions=(one, two.with_numbers(more)))
    assert saved(tmp_path).since("steer", SCENE, [grown]).status is ExitStatus.AGREE
    renamed = replace(
        OUTCOME, solutions=tuple(replace(s, formulation=s.formulation + "x") for s in (one, two))
    )
    assert saved(tmp_path).since("steer", SCENE, [renamed]).status is ExitStatus.NO_VERDICT


def test_a_formulation_in_the_place_of_another_is_no_verdict_and_one_that_is_not_asked_is_no_loss(
    tmp_path: Path,
) -> None:
    one, two = OUTCOME.solutions
    other = replace(OUTCOME, solutions=(one, replace(two, formulation="another")))
    told = saved(tmp_path).since("steer", SCENE, [other])
    assert not told.lost
    assert told.status is ExitStatus.NO_VERDICT
    assert "another formulation than in the baseline: another in the place of absolute" in told.words
    root = checked(
        junit(Record(["steer"], since=[told], examined=[Examined(name="steer", outcomes=(other,))]))
    )
    assert [case.get("type") for case in root.iter("error")] == ["another formulation"]
    third, recorder = replace(OUTCOME, solutions=(one, replace(two, formulation="third"))), Recorder()
    recorder.add("steer", SCENE, [OUTCOME, third])
    (tmp_path / "three.npz").write_bytes(recorder.content())
    fewer = read_baseline(str(tmp_path / "three.npz")).since("steer", SCENE, [OUTCOME])
    assert {m.formulation for m in fewer.moves if m.verdict == "gone"} == {"third"}
    assert (fewer.status, fewer.words) == (ExitStatus.AGREE, "")


def test_the_file_is_the_same_bytes_and_holds_nothing_that_runs(tmp_path: Path) -> None:
    saved(tmp_path)
    first = (tmp_path / "b.npz").read_bytes()
    saved(tmp_path)
    assert (tmp_path / "b.npz").read_bytes() == first
    with np.load(tmp_path / "b.npz", allow_pickle=False) as file:
        assert str(file["format"]) == module.FORMAT
        assert int(file["version"]) == module.VERSION
        head = json.loads(str(file["head"]))
        (steer,) = head["scenes"]
        place = steer["solutions"][0]["numbers"]["position"]["wheel_centre"]
        assert np.array_equal(file[f"a{place}"], OUTCOME.solutions[0].numbers["position"]["wheel_centre"])
    with zipfile.ZipFile(tmp_path / "b.npz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def damaged(path: Path, how: str) -> None:
    data = path.read_bytes()
    if how == "cut":
        path.write_bytes(data[: len(data) // 2])
    elif how == "turned":
        path.write_bytes(data[:20000] + bytes([data[20000] ^ 255]) + data[20001:])
    elif how == "text":
        path.write_text("no archive")
    else:
        with np.load(path) as file:
            found = {name: file[name] for name in file.files}
        if how == "another format":
            found["format"] = np.array("pointcoord kinematic map")
        elif how == "newer":
            found["version"] = np.array(module.VERSION + 1)
        elif how == "lost array":
            del found["a3"]
        elif how == "no head":
            del found["head"]
        else:
            text = str(found["head"])
            head = json.loads(text)
            if how == "another quantity":
                head["scenes"][0]["solutions"][0]["numbers"]["speed"] = {}
            elif how == "another shape":
                head["scenes"][0]["solutions"][0]["claims"]["position"]["wheel_centre"] = 0
            elif how == "another car":
                head["scenes"][0]["mechanism"]["points"]["strut_top"][0] += 1.0
            else:
                head = ["nothing"]
            found["head"] = np.array(json.dumps(head))
        np.savez(path, **found)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ("cut", "no npz file, or a damaged one"),
        ("turned", "no npz file, or a damaged one"),
        ("text", "no npz file, or a damaged one"),
        ("another format", "holds no baseline"),
        ("newer", "is of version 2; allowed: version 1"),
        ("lost array", "does not hold a whole baseline"),
        ("no head", "does not hold a whole baseline"),
        ("another quantity", "does not hold a whole baseline (speed is no quantity)"),
        ("another shape", "does not hold a whole baseline"),
        ("another car", "the car of steer is not the one that was saved"),
        ("another head", "does not hold a whole baseline"),
    ],
)
def test_a_file_that_is_no_whole_baseline_is_refused_in_one_line(
    how: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    saved(tmp_path)
    damaged(tmp_path / "b.npz", how)
    with pytest.raises(UsageError) as caught:
        read_baseline(str(tmp_path / "b.npz"))
    assert words in str(caught.value)
    assert main(["validate", "steer", "--baseline", str(tmp_path / "b.npz")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1


def test_the_program_says_what_moved_what_is_new_and_what_is_gone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    one, two, three = (short_scene(tmp_path, f"{name}.toml") for name in ("one", "two", "three"))
    kept, data = str(tmp_path / "b.npz"), tmp_path / "x.json"
    pair = ["--second", "absolute"]
    plain = AbsoluteCoordinates.solve

    def off(self: AbsoluteCoordinates, scene: Scene) -> Solution:
        solution = plain(self, scene)
        places = solution.numbers["position"]["wheel_centre"] + 1e-9
        return solution.with_numbers({"position": {**solution.numbers["position"], "wheel_centre": places}})

    with monkeypatch.context() as patch:
        patch.setattr(AbsoluteCoordinates, "solve", off)
        assert main(["validate", one, two, *pair, "--save-baseline", kept]) == 1
    capsys.readouterr()
    # The fault is mended: everything agrees, and what the baseline has wrong has moved.
    ends = ["--junit", str(tmp_path / "x.xml"), "--summary", str(tmp_path / "x.md"), "--json", str(data)]
    assert main(["validate", one, three, *pair, "--baseline", kept, *ends]) == 1
    out = capsys.readouterr().out
    (row,) = (line for line in out.splitlines() if line.endswith("MOVED"))
    assert row.split()[1:4] == ["absolute", "position", "wheel_centre"]
    assert f"moved since the baseline {kept}: {one}; gone, in the baseline and not in this run: {two}." in out
    assert out.splitlines()[-1] == "Next: if the new numbers are right, keep them by --save-baseline FILE."
    document = json.loads(data.read_text())
    assert [scene["exit_status"] for scene in document["scenes"]] == [0, 0]
    held = document["baseline"]
    assert [scene["standing"] for scene in held["scenes"]] == ["compared", "new"]
    assert held["gone"] == [two]
    (move,) = (m for m in held["scenes"][0]["moves"] if m["verdict"] == "moved")
    assert move["moved"] == pytest.approx(1e-9, rel=1e-3)
    assert move["share"] > 1.0
    text = (tmp_path / "x.md").read_text()
    assert "moved since the baseline" in text
    assert sum("**MOVED**" in line for line in text.splitlines()) == 1
    assert f"scene {two} is gone" in text
    root = checked((tmp_path / "x.xml").read_bytes())
    suites = {suite.get("name"): suite for suite in root}
    assert suites[f"{one}: since the baseline"].get("failures") == "1"
    assert suites[f"{three}: since the baseline"].get("skipped") == "1"
    assert suites[f"{two}: since the baseline"].get("skipped") == "1"


def test_numbers_that_are_given_no_more_end_with_1_and_are_named_in_the_last_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept, scene, tests = str(tmp_path / "b.npz"), short_scene(tmp_path, "one.toml"), tmp_path / "x.xml"
    solver = "def solve(given):\n    place = given['points']['rack_centre']\n"
    solver += (
        "    import numpy as np\n    rack = np.outer(given['inputs']['rack']['position'], given['right'])\n"
    )
    solver += "    found = {'tie_rod_inner': np.array(place) - rack}\n"
    module = tmp_path / "some_of_it.py"
    monkeypatch.chdir(tmp_path)
    words = ["validate", scene, "--solver", "some_of_it:solve", "--in-process"]
    monkeypatch.setattr(sys, "path", [*sys.path])
    rack = "    return {'position': found | {'rack_centre': [place] * len(given['instants'])}}\n"
    module.write_text(solver + rack, encoding="utf-8")
    assert main([*words, "--save-baseline", kept]) == 3
    sys.modules.pop("some_of_it")
    module.write_text(solver + "    return {'position': found}\n", encoding="utf-8")
    capsys.readouterr()
    assert main([*words, "--baseline", kept, "--junit", str(tests)]) == 1
    last = capsys.readouterr().out.splitlines()[-2]
    assert f"; given then and not now: {scene}: position of rack_centre by some_of_it:solve." in last
    suite = next(s for s in checked(tests.read_bytes()) if s.get("name") == f"{scene}: since the baseline")
    (failure,) = suite.iter("failure")
    assert failure.get("type") == "gone"


def test_a_run_that_has_nothing_in_its_baseline_has_no_verdict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    saved(tmp_path)
    words = ["validate", short_scene(tmp_path), "--second", "absolute"]
    assert main([*words, "--baseline", str(tmp_path / "b.npz")]) == 3
    assert "nothing could be compared with the baseline" in capsys.readouterr().out


def test_a_scene_that_is_refused_now_is_not_called_gone(tmp_path: Path) -> None:
    kept, data, pair = str(tmp_path / "b.npz"), tmp_path / "x.json", ["--second", "absolute", "-q"]
    good = short_scene(tmp_path, "good.toml")
    past = short_scene(tmp_path, "past.toml", samples="27")
    assert main(["validate", good, past, *pair, "--save-baseline", kept]) == 0
    short_scene(tmp_path, "past.toml", samples="0")
    assert main(["validate", good, past, *pair, "--baseline", kept, "--json", str(data)]) == 2
    assert json.loads(data.read_text())["baseline"]["gone"] == []
    short_scene(tmp_path, "past.toml", samples="27", **PAST_ITS_END)
    assert main(["validate", good, past, *pair, "--baseline", kept, "--json", str(data)]) == 3
    standings = [scene["standing"] for scene in json.loads(data.read_text())["baseline"]["scenes"]]
    assert standings == ["compared", "another motion"]


def test_a_baseline_of_nothing_does_not_take_the_place_of_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    saved(tmp_path)
    before = (tmp_path / "b.npz").read_bytes()
    past = short_scene(tmp_path, samples="27", **PAST_ITS_END)
    assert main(["validate", past, "--save-baseline", str(tmp_path / "b.npz")]) == 3
    assert "not written, because no scene was compared" in capsys.readouterr().err
    assert (tmp_path / "b.npz").read_bytes() == before
