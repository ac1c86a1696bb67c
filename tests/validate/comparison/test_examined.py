"""What becomes of a scene that a formulation refuses or fails at, and of several scenes together."""

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from program import PAST_ITS_END, complaints, short_scene

from pointcoord import Scene, SceneError
from validate.cli import main
from validate.comparison.examined import examine
from validate.exit_status import ExitStatus, combined
from validate.formulations.absolute_coordinates import AbsoluteCoordinates
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation

SCENE = Scene.load("steer")


def with_one_that_raises(error: Exception) -> tuple[dict[str, Any], list[str]]:
    """Formulations a and c, which solve the scene, and b, which raises; and who is asked."""
    right, asked = formulation("pointcoord").solve(SCENE), list[str]()

    class Fixed:
        def __init__(self, name: str) -> None:
            self.name = name

        def solve(self, scene: Scene) -> Solution:
            asked.append(self.name)
            if self.name == "b":
                raise error
            return right

    return {name: Fixed(name) for name in "abc"}, asked


def test_hardpoints_that_make_no_mechanism_are_a_wrong_input_under_the_users_name() -> None:
    wrong = SceneError("file.toml", "points.strut_top", "lies in the ball joint", "a point apart")
    found = examine("my scene", SCENE, [("a", "b")], False, others=with_one_that_raises(wrong)[0])
    assert found.status is ExitStatus.WRONG_INPUT
    assert found.complaint == (
        "my scene: points.strut_top: lies in the ball joint; allowed: a point apart; "
        "refused by b (SceneError); solved by a"
    )


def test_a_failure_is_no_refusal_says_where_it_was_raised_and_no_other_pair_is_tried() -> None:
    others, asked = with_one_that_raises(RuntimeError("no luck"))
    found = examine("my scene", SCENE, [("a", "b"), ("c", "a")], False, others=others)
    assert asked == ["a", "b"]
    assert found.status is ExitStatus.NOT_FINISHED
    assert (found.refusals, found.outcomes, found.solved) == ((), (), ("a",))
    (failure,) = found.failures
    assert (failure.formulation, failure.error) == ("b", "RuntimeError")
    assert failure.message.startswith("no luck at test_examined.py:")


def test_a_refusal_says_who_where_which_value_and_which_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The arm turns by 0.8 rad/s from 0.8 rad; its dead point is at 152.013 degrees, 2.3165 s."""
    path = short_scene(tmp_path, samples="27", **PAST_ITS_END)
    assert main(["validate", path, "--json", "-"]) == 3
    out, err = capsys.readouterr()
    (line,) = err.splitlines()
    assert line.startswith(f"pointcoord: {path}: ")
    whom = "pointcoord (AssemblyError), absolute (PoseError) and pointcoord-newton (AssemblyError)"
    assert f"; refused by {whom}" in line
    (scene,) = json.loads(out)["scenes"]
    assert scene["solved_by"] == []
    refusals = {refusal["formulation"]: refusal for refusal in scene["refusals"]}
    assert list(refusals) == ["pointcoord", "absolute", "pointcoord-newton"]
    for refusal in refusals.values():
        assert (refusal["input"], refusal["reason"]) == ("arm_angle", "motion leaves its reach")
        assert refusal["instant"] == pytest.approx(2.3165, abs=0.11)
        # A chain of series stops within a step of a dead point, which it tells to a millionth.
        assert refusal["value"] == pytest.approx(0.8 + 0.8 * refusal["instant"], abs=1e-6)
        assert refusal["value"] > refusal["limit"]
        assert refusal["limit"] == pytest.approx(2.65313, abs=0.01)
        assert refusal["condition"] > 1.0
    assert refusals["pointcoord"]["links"]


def test_a_scene_that_one_formulation_solves_has_no_verdict_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Too many series, and no map: the other model and Newton's method take the instants alone."""
    monkeypatch.setattr("pointcoord.solve.taylor.MOST_SEGMENTS", 2)
    monkeypatch.setattr("pointcoord.patches.way_map.ENOUGH", 0)
    path = short_scene(tmp_path)
    assert main(["validate", path]) == 3
    out, err = capsys.readouterr()
    (line,) = err.splitlines()
    assert "(--first pointcoord-newton); refused by pointcoord (NotFollowed); " in line
    assert line.endswith("solved by absolute and pointcoord-newton")
    assert f"0 of 1 scene agrees; not tested (refused): {path}." in out
    assert out.splitlines()[-1].startswith(f"Next: pointcoord plan {path} shows how far each input can go")
    # The hint can be followed, here and where the scene is only solved.
    assert main(["validate", path, "--first", "pointcoord-newton"]) == 0
    assert main(["simulate", path, "-o", str(tmp_path / "x.csv")]) == 3
    said = capsys.readouterr().err
    assert "(--method newton)" in said
    assert "closing the drawing moves wheel_centre by 16.8 mm" in said
    assert "; the solved part, 2 instants up to t = 0.65 s, is in " in said
    assert main(["simulate", path, "--method", "newton", "-o", str(tmp_path / "x.csv")]) == 0


@pytest.mark.parametrize(
    ("command", "off", "status"),
    [
        ("validate", 0.09, 0),
        *((command, 4.7, 0) for command in ("validate", "simulate", "plan")),
        *((command, 5.3, 2) for command in ("validate", "simulate", "plan")),
    ],
)
def test_a_drawing_that_does_not_close_is_warned_of_and_then_refused(
    command: str, off: float, status: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The strut's rod end beside the axis: it alone moves. 1 % of the car's longest side is 5.1 mm."""
    top, lower = np.array([460.0, -180.0, 470.0]), np.array([452.0, -320.0, 20.0])
    beside = np.cross(top - lower, [1.0, 0.0, 0.0])
    place = 0.5 * (top + lower) + off * beside / np.linalg.norm(beside)
    path = Path(short_scene(tmp_path, strut_rod_end=str(place.tolist()), closure='"drawn"'))
    more = {"validate": ["--json", str(tmp_path / "x.json")], "simulate": ["-o", str(tmp_path / "x.csv")]}
    assert main([command, str(path), *more.get(command, [])]) == status
    said = capsys.readouterr().err.splitlines()
    lines = [line for line in said if not line.startswith("pointcoord: note: ")]
    assert len(lines) == (off > 0.1)
    for line in lines:
        assert line.startswith(f"pointcoord: {'' if status else 'warning: '}{path}: ")
        assert f"closing the drawing moves strut_rod_end by {off:.3g} mm" in line
        assert ("another car" in line) == (status == 2)
    if command == "validate":
        (scene,) = json.loads((tmp_path / "x.json").read_text())["scenes"]
        assert scene["closing"]["point"] == "strut_rod_end"
        assert len(scene["warnings"]) == (off > 0.1)


def test_a_failure_at_one_scene_leaves_the_others_solved_and_ends_with_4(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    solve = AbsoluteCoordinates.solve

    def failing(self: AbsoluteCoordinates, scene: Scene) -> Any:
        if scene.title == "first":
            raise MemoryError("no room")
        return solve(self, scene)

    monkeypatch.setattr(AbsoluteCoordinates, "solve", failing)
    first, second = short_scene(tmp_path, "1.toml", title='"first"'), short_scene(tmp_path, "2.toml")
    assert main(["validate", first, second, "--json", "-"]) == 4
    out, err = capsys.readouterr()
    (line,) = complaints(err)
    said = "absolute fails: MemoryError: out of memory (no room); try fewer samples"
    assert line.startswith(f"pointcoord: {first}: {said}")
    assert line.endswith("; solved by pointcoord")
    data = json.loads(out)
    assert [scene["verdict"] for scene in data["scenes"]] == ["not finished", "agree"]
    assert data["scenes"][0]["failures"][0]["error"] == "MemoryError"


def test_a_disagreement_comes_before_every_other_status() -> None:
    scenes = [ExitStatus.DISAGREE, ExitStatus.NOT_FINISHED, ExitStatus.WRONG_INPUT, ExitStatus.NO_VERDICT]
    for count in range(5):
        for chosen in itertools.permutations([*scenes, ExitStatus.AGREE], count):
            best = next((status for status in scenes if status in chosen), ExitStatus.AGREE)
            assert combined(chosen) is best
