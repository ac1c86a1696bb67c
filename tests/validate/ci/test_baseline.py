"""Baselines: what moved beyond what both claims allow, and what cannot be held to one."""

import html
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from junit_schema import checked
from program import PAST_ITS_END, short_scene

from pointcoord import Scene
from validate import Outcome, Solution, compare
from validate.ci.baseline import VERSION, Baseline, Kept, Move, Since, read_baseline, written
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.verdict import sentence
from validate.cli import main
from validate.comparison.compare import compare_solutions
from validate.comparison.examined import Examined
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.absolute_coordinates import AbsoluteCoordinates

SCENE = Scene.load("steer")
OUTCOME = compare(SCENE, "pointcoord", "absolute", "steer")
ONE, TWO = OUTCOME.solutions
WHEEL = TWO.numbers["position"]["wheel_centre"]


def saved(folder: Path, *outcomes: Outcome) -> Baseline:
    target = folder / "b.npz"
    target.write_bytes(written({"steer": Kept.of(SCENE, outcomes or [OUTCOME])}))
    return read_baseline(str(target))


def by_number(since: Since) -> dict[tuple[str, str, str], Move]:
    return {(move.formulation, move.row.quantity, move.row.name): move for move in since.moves}


def record_of(since: Since, baseline: Baseline) -> Record:
    return Record(["steer"], 1.0, baseline, [Examined(name="steer", outcomes=(OUTCOME,))], [since])


def test_a_baseline_of_the_same_run_finds_every_number_and_no_difference(tmp_path: Path) -> None:
    since = saved(tmp_path).since("steer", SCENE, [OUTCOME])
    assert (since.standing, since.status) == ("compared", ExitStatus.AGREE)
    assert {(move.row.difference, move.verdict) for move in since.moves} == {(0.0, "agrees")}
    assert len(since.moves) == 2 * len(OUTCOME.rows)


@pytest.mark.parametrize(
    ("part", "factor", "verdict"), [(0.9, 1.0, "agrees"), (1.1, 1.0, "moved"), (3.0, 4.0, "agrees")]
)
def test_a_number_has_moved_beyond_twice_its_claim_and_not_below(
    part: float, factor: float, verdict: str, tmp_path: Path
) -> None:
    """Twice: the same claim is made then and now."""
    claim = TWO.accuracy.claims["position"]["wheel_centre"][17, 1]
    places = WHEEL.copy()
    places[17, 1] += part * 2.0 * claim
    changed = TWO.with_numbers({"position": {**TWO.numbers["position"], "wheel_centre": places}})
    outcome = compare_solutions(SCENE, ONE, changed, "steer")
    since = saved(tmp_path).since("steer", SCENE, [outcome], factor)
    found = by_number(since)
    move = found.pop(("absolute", "position", "wheel_centre"))
    # What was really added to a coordinate of some 400 mm, after its rounding.
    added = abs(places - WHEEL).max()
    assert (move.verdict, move.row.difference, move.row.instant) == (verdict, added, SCENE.instants[17])
    assert move.row.share == pytest.approx(added / (2.0 * claim) / factor, rel=1e-9)
    assert {other.verdict for other in found.values()} == {"agrees"}
    assert since.status is (ExitStatus.DISAGREE if verdict == "moved" else ExitStatus.AGREE)


def test_another_car_or_motion_under_the_name_is_told_and_not_compared(tmp_path: Path) -> None:
    moved = {"points": {"tie_rod_outer": (560.0, -300.0, 60.001)}}
    for scene, standing, words in (
        (scene_with("steer", moved), "another car", "tie_rod_outer"),
        (scene_with("steer", samples=SCENE.time.samples + 1), "another motion", "another time"),
    ):
        baseline = saved(tmp_path)
        since = baseline.since("steer", scene, [OUTCOME])
        assert (since.standing, since.moves, since.status) == (standing, (), ExitStatus.NO_VERDICT)
        assert words in since.words
        assert sentence(record_of(since, baseline)).endswith(f"; no verdict: {since.words}")


def test_numbers_that_are_new_or_gone_are_named(tmp_path: Path) -> None:
    baseline = saved(tmp_path)
    less = {q: part for q, part in ONE.numbers.items() if q != "velocity"}
    grown = TWO.with_numbers({"position": {**TWO.numbers["position"], "brake": WHEEL}})
    since = baseline.since("steer", SCENE, [replace(OUTCOME, solutions=(replace(ONE, numbers=less), grown))])
    odd = {key: move.verdict for key, move in by_number(since).items() if move.verdict != "agrees"}
    assert odd.pop(("absolute", "position", "brake")) == "new"
    assert {(who, what) for who, what, _ in odd} == {("pointcoord", "velocity")}
    assert set(odd.values()) == {"gone"}
    assert since.status is ExitStatus.DISAGREE
    record = record_of(since, baseline)
    assert "; given in the baseline and not now: steer: velocity of " in sentence(record)
    (suite,) = (s for s in checked(junit(record)) if s.get("name") == "steer: since the baseline")
    assert {failure.get("type") for failure in suite.iter("failure")} == {"gone"}
    # More than then is no loss.
    more = baseline.since("steer", SCENE, [replace(OUTCOME, solutions=(ONE, grown))])
    assert more.status is ExitStatus.AGREE


def test_a_formulation_in_the_place_of_another_is_no_verdict_and_one_that_is_not_asked_is_no_loss(
    tmp_path: Path,
) -> None:
    other, third = (
        replace(OUTCOME, solutions=(ONE, replace(TWO, formulation=name))) for name in ("another", "third")
    )
    baseline = saved(tmp_path)
    since = baseline.since("steer", SCENE, [other])
    assert (since.lost, since.status) == ((), ExitStatus.NO_VERDICT)
    assert "another formulation than in the baseline, another instead of absolute" in since.words
    errors = checked(junit(record_of(since, baseline))).iter("error")
    assert [case.get("type") for case in errors] == ["another formulation"]
    fewer = saved(tmp_path, OUTCOME, third).since("steer", SCENE, [OUTCOME])
    assert {m.formulation for m in fewer.moves if m.verdict == "gone"} == {"third"}
    assert (fewer.status, fewer.words) == (ExitStatus.AGREE, "")


DAMAGES: dict[str, tuple[Any, str]] = {
    "newer": (
        lambda found: found | {"version": np.array(VERSION + 1)},
        "has version 2; allowed: version",
    ),
    "lost array": (
        lambda found: {k: v for k, v in found.items() if k != "a3"},
        "contains no complete baseline",
    ),
    "another shape": (
        lambda found: found | {name: array[:1] for name, array in found.items() if array.ndim > 1},
        "contains no complete baseline",
    ),
}


@pytest.mark.parametrize("how", ["cut", "turned", *DAMAGES])
def test_a_file_that_is_no_whole_baseline_is_refused_in_one_line(
    how: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    saved(tmp_path)
    path, words = tmp_path / "b.npz", "not an npz file, or a damaged one"
    data = path.read_bytes()
    if how == "cut":
        path.write_bytes(data[: len(data) // 2])
    elif how == "turned":
        path.write_bytes(data[:20000] + bytes([data[20000] ^ 255]) + data[20001:])
    else:
        damage, words = DAMAGES[how]
        with np.load(path) as file:
            found = {name: file[name] for name in file.files}
        np.savez(path, **damage(found))
    with pytest.raises(UsageError) as caught:
        read_baseline(str(path))
    assert words in str(caught.value)
    assert main(["validate", "steer", "--baseline", str(path)]) == 2
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1)


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
    (row,) = (line for line in out.splitlines() if "MOVED" in line)
    assert row.startswith("  MOVED, solved by absolute: position of wheel_centre: difference 1e-09 mm")
    assert f"moved since the baseline {kept}: {one}; gone, in the baseline and not in this run: {two}." in out
    assert out.splitlines()[-1] == "Next: if the new numbers are right, save them with --save-baseline FILE."
    document = json.loads(data.read_text())
    held = document["baseline"]
    assert [scene["exit_status"] for scene in document["scenes"]] == [0, 0]
    assert [scene["standing"] for scene in held["scenes"]] == ["compared", "new"]
    assert held["gone"] == [two]
    (move,) = (m for m in held["scenes"][0]["moves"] if m["verdict"] == "moved")
    assert move["moved"] == pytest.approx(1e-9, rel=1e-3)
    assert move["share"] > 1.0
    text = html.unescape((tmp_path / "x.md").read_text())
    assert "moved since the baseline" in text
    assert sum("MOVED, solved by absolute" in line for line in text.splitlines()) == 1
    assert f"{two} is gone" in text
    suites = {suite.get("name"): suite for suite in checked((tmp_path / "x.xml").read_bytes())}
    for scene, kind in ((one, "failures"), (three, "skipped"), (two, "skipped")):
        assert suites[f"{scene}: since the baseline"].get(kind) == "1"


def test_a_scene_that_is_refused_now_is_not_called_gone_and_a_baseline_replaces_the_old_one_if_it_has_a_scene(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept, data, pair = str(tmp_path / "b.npz"), tmp_path / "x.json", ["--second", "absolute", "-q"]
    good, past = (short_scene(tmp_path, name, samples="27") for name in ("good.toml", "past.toml"))
    replaced = ["--save-baseline", kept, "--baseline", kept]
    assert main(["validate", good, past, *pair, "--save-baseline", kept]) == 0
    before = (tmp_path / "b.npz").read_bytes()
    assert main(["validate", good, past, *pair, *replaced]) == 0
    for change, status, standings in (
        ({"samples": "0"}, 2, ["compared"]),
        ({"samples": "27", **PAST_ITS_END}, 3, ["compared", "another motion"]),
    ):
        short_scene(tmp_path, "past.toml", **change)
        assert main(["validate", good, past, *pair, "--baseline", kept, "--json", str(data)]) == status
        held = json.loads(data.read_text())["baseline"]
        assert held["gone"] == []
        assert [scene["standing"] for scene in held["scenes"]] == standings
    capsys.readouterr()
    assert main(["validate", past, *pair, *replaced]) == 3
    assert "not written, because no scene was compared" in capsys.readouterr().err
    assert (tmp_path / "b.npz").read_bytes() == before
