"""Baselines: what moved beyond what both claims allow, and what cannot be compared with one."""

import html
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from junit_schema import checked
from program import PAST_ITS_END, document, short_scene

from pointcoord import Scene
from validate import Outcome, Solution, compare
from validate.ci.baseline import VERSION, Baseline, Kept, Move, Since, read_baseline, written
from validate.ci.junit import junit
from validate.ci.record import Record
from validate.ci.verdict import sentence
from validate.cli import main
from validate.comparison.compare import compare_solutions
from validate.comparison.examined import Examined
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


@pytest.fixture
def baseline(tmp_path: Path) -> Baseline:
    return saved(tmp_path)


def with_places(solution: Solution, **places: np.ndarray) -> Solution:
    return solution.with_numbers({"position": {**solution.numbers["position"], **places}})


def by_number(since: Since) -> dict[tuple[str, str, str], Move]:
    return {(move.formulation, move.row.quantity, move.row.name): move for move in since.moves}


def record_of(since: Since, baseline: Baseline) -> Record:
    return Record(["steer"], 1.0, baseline, [Examined(name="steer", outcomes=(OUTCOME,))], [since])


@pytest.mark.parametrize(
    ("part", "factor", "verdict"), [(0.9, 1.0, "agrees"), (1.1, 1.0, "moved"), (3.0, 4.0, "agrees")]
)
def test_a_number_has_moved_beyond_twice_its_claim_and_no_other_has(
    part: float, factor: float, verdict: str, baseline: Baseline
) -> None:
    """Twice: the same claim is made then and now."""
    claim = TWO.accuracy.claims["position"]["wheel_centre"][17, 1]
    places = WHEEL.copy()
    places[17, 1] += part * 2.0 * claim
    outcome = compare_solutions(SCENE, ONE, with_places(TWO, wheel_centre=places), "steer")
    since = baseline.since("steer", SCENE, [outcome], factor)
    found = by_number(since)
    assert len(found) == 2 * len(OUTCOME.rows)
    move = found.pop(("absolute", "position", "wheel_centre"))
    # What was really added to a coordinate of some 400 mm, after its rounding.
    added = abs(places - WHEEL).max()
    assert (move.verdict, move.row.difference, move.row.instant) == (verdict, added, SCENE.instants[17])
    assert move.row.share == pytest.approx(added / (2.0 * claim) / factor, rel=1e-9)
    assert {(other.verdict, other.row.difference) for other in found.values()} == {("agrees", 0.0)}
    assert since.standing == "compared"
    assert since.status is (ExitStatus.DISAGREE if verdict == "moved" else ExitStatus.AGREE)


@pytest.mark.parametrize(
    ("changes", "standing", "words"),
    [
        (
            {"mechanism": {"points": {"tie_rod_outer": (560.0, -300.0, 60.001)}}},
            "another car",
            "tie_rod_outer",
        ),
        ({"samples": SCENE.time.samples + 1}, "another motion", "another time"),
    ],
)
def test_another_car_or_motion_under_the_name_is_said_and_not_compared(
    changes: dict[str, Any], standing: str, words: str, baseline: Baseline
) -> None:
    since = baseline.since("steer", scene_with("steer", **changes), [OUTCOME])
    assert (since.standing, since.moves, since.status) == (standing, (), ExitStatus.NO_VERDICT)
    assert words in since.words
    assert sentence(record_of(since, baseline)).endswith(f"; no verdict: {since.words}")


def test_numbers_that_are_new_or_gone_are_named(baseline: Baseline) -> None:
    less = {q: part for q, part in ONE.numbers.items() if q != "velocity"}
    grown = with_places(TWO, brake=WHEEL)
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
    tmp_path: Path, baseline: Baseline
) -> None:
    other, third = (
        replace(OUTCOME, solutions=(ONE, replace(TWO, formulation=name))) for name in ("another", "third")
    )
    since = baseline.since("steer", SCENE, [other])
    assert (since.lost, since.status) == ((), ExitStatus.NO_VERDICT)
    assert "another formulation than in the baseline, another instead of absolute" in since.words
    errors = checked(junit(record_of(since, baseline))).iter("error")
    assert [case.get("type") for case in errors] == ["another formulation"]
    fewer = saved(tmp_path, OUTCOME, third).since("steer", SCENE, [OUTCOME])
    assert {m.formulation for m in fewer.moves if m.verdict == "gone"} == {"third"}
    assert (fewer.status, fewer.words) == (ExitStatus.AGREE, "")


def test_a_file_that_is_no_whole_baseline_is_refused_in_one_line(
    tmp_path: Path, baseline: Baseline, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "b.npz"
    data = path.read_bytes()
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    for content, words in (
        (data[: len(data) // 2], "BadZipFile"),
        (data[:20000] + bytes([data[20000] ^ 255]) + data[20001:], "Bad CRC"),
        (arrays | {"version": np.array(VERSION + 1)}, "it is a pointcoord baseline 2"),
        ({name: a for name, a in arrays.items() if name != "a3"}, "KeyError: 'a3'"),
        ({n: a[:1] if a.ndim > 1 else a for n, a in arrays.items()}, "shape"),
    ):
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            np.savez(path, **content)
        assert main(["validate", "steer", "--baseline", str(path)]) == 2
        out, err = capsys.readouterr()
        (line,) = err.splitlines()
        assert "no baseline, or a damaged one (" in line
        assert words in line
        assert out == ""


def test_the_program_says_what_moved_what_is_new_and_what_is_gone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    one, two, three = (short_scene(tmp_path, f"{name}.toml") for name in ("one", "two", "three"))
    kept, data = str(tmp_path / "b.npz"), tmp_path / "x.json"
    plain = AbsoluteCoordinates.solve

    def off(self: AbsoluteCoordinates, scene: Scene) -> Solution:
        solution = plain(self, scene)
        return with_places(solution, wheel_centre=solution.numbers["position"]["wheel_centre"] + 1e-9)

    with monkeypatch.context() as patch:
        patch.setattr(AbsoluteCoordinates, "solve", off)
        assert main(["validate", one, two, "--second", "absolute", "--save-baseline", kept]) == 1
    capsys.readouterr()
    # The fault is mended: everything agrees, and what the baseline has wrong has moved.
    ends = ["--junit", str(tmp_path / "x.xml"), "--summary", str(tmp_path / "x.md"), "--json", str(data)]
    assert main(["validate", one, three, "--second", "absolute", "--baseline", kept, *ends]) == 1
    lines = capsys.readouterr().out.splitlines()
    text = html.unescape((tmp_path / "x.md").read_text())
    said = "MOVED, solved by absolute: position of wheel_centre: difference 1e-09 mm"
    assert [said in line for line in lines if "MOVED" in line] == [True]
    assert [said in line for line in text.splitlines() if "MOVED" in line] == [True]
    both = f"moved since the baseline {kept}: {one}; gone, in the baseline and not in this run: {two}."
    assert any(both in line for line in lines)
    assert "moved since the baseline" in text
    assert f"{two} is gone" in text
    assert lines[-1] == "Next: if the new numbers are right, save them with --save-baseline FILE."
    found = document(data)
    assert [scene["exit_status"] for scene in found["scenes"]] == [0, 0]
    held = found["baseline"]
    assert [scene["standing"] for scene in held["scenes"]] == ["compared", "new"]
    assert held["gone"] == [two]
    (move,) = (m for m in held["scenes"][0]["moves"] if m["verdict"] == "moved")
    assert move["moved"] == pytest.approx(1e-9, rel=1e-3)
    assert move["share"] > 1.0
    suites = {suite.get("name"): suite for suite in checked((tmp_path / "x.xml").read_bytes())}
    for scene, kind in ((one, "failures"), (three, "skipped"), (two, "skipped")):
        assert suites[f"{scene}: since the baseline"].get(kind) == "1"


def test_a_scene_that_is_refused_now_is_not_called_gone_and_a_baseline_replaces_the_old_one_if_it_has_a_scene(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept, data, pair = tmp_path / "b.npz", tmp_path / "x.json", ["--second", "absolute", "-q"]
    good, past = (short_scene(tmp_path, name, samples="27") for name in ("good.toml", "past.toml"))
    save, replaced = ["--save-baseline", str(kept)], ["--save-baseline", str(kept), "--baseline", str(kept)]
    assert main(["validate", good, past, *pair, *save]) == 0
    before = kept.read_bytes()
    assert main(["validate", good, past, *pair, *replaced]) == 0
    for change, status, standings in (
        ({"samples": "0"}, 2, ["compared"]),
        ({"samples": "27", **PAST_ITS_END}, 3, ["compared", "another motion"]),
    ):
        short_scene(tmp_path, "past.toml", **change)
        words = ["validate", good, past, *pair, "--baseline", str(kept), "--json", str(data)]
        assert main(words) == status
        held = document(data)["baseline"]
        assert held["gone"] == []
        assert [scene["standing"] for scene in held["scenes"]] == standings
    capsys.readouterr()
    assert main(["validate", past, *pair, *replaced]) == 3
    assert "not written, because no scene was compared" in capsys.readouterr().err
    assert kept.read_bytes() == before
