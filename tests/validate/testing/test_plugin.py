"""The plugin's mark and fixtures, in runs of pytest of their own."""

import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from pointcoord import built_in_scenes, pytest_plugin
from validate import assert_refuses
from validate.hard.case import HARD
from validate.hard.catalogue import CASES
from validate.hard.subjects import SUBJECTS
from validate.solvers.plain import given_to_solver
from validate.testing.scenes import NOT_ASKED, impossible_scenes

ROOT = Path(__file__).parents[3]
# Where pointcoord is installed, pytest finds the plugin by itself, and takes it once only.
FOUND = any(one.value == "pointcoord.pytest_plugin" for one in entry_points(group="pytest11"))
OURS = (
    *(() if FOUND else ("-p", "pointcoord.pytest_plugin")),
    "-p",
    "no:cacheprovider",
    "-p",
    "no:xdist",
    "--strict-markers",
)


def run(folder: Path, text: str, *options: str) -> "subprocess.CompletedProcess[str]":
    """Run pytest on one file of tests."""
    (folder / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    (folder / "test_it.py").write_text(text, encoding="utf-8")
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    return subprocess.run(
        [sys.executable, "-m", "pytest", *OURS, *options, "test_it.py"],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env=kept | {"PYTHONPATH": str(ROOT)},
    )


def test_every_scene_is_one_test_and_fixtures_hold_solve_once_and_skip_what_is_not_tested(
    tmp_path: Path,
) -> None:
    text = """
import pytest
pytestmark = pytest.mark.suspension_scenes("arm-highest-held", near=1e-4)

@pytest.mark.suspension_scenes()
def test_one(scene):
    assert len(scene.instants)

def test_the_reference_is_proven_and_solved_once_and_agrees(reference, assert_agrees):
    solution = reference("steer")
    assert solution.accuracy.proven
    assert reference("steer") is solution
    assert assert_agrees(solution.numbers, "steer", accuracy=1e-6).passed

def test_not_tested(reference, assert_agrees):
    assert_agrees(reference("steer").numbers, "steer", accuracy=1e3)
"""
    done = run(tmp_path, text, "-v", "-rs")
    assert done.returncode == 0, done.stdout + done.stderr
    scenes = (*built_in_scenes(), "arm-highest-held at 0.0001")
    for name in scenes:
        assert f"test_one[{name}]" in done.stdout
    assert f"{len(scenes) + 1} passed, 1 skipped" in done.stdout
    assert "an accuracy of 1000 mm gives no tolerance" in done.stdout


@pytest.mark.parametrize(
    ("name", "of", "options", "words"),
    [
        ("suspension_scenes", ["bunce"], {}, "did you mean 'bounce'?"),
        ("suspension_scenes", ["link-twice"], {}, "it is not a scene, or a solver may refuse it"),
        ("suspension_scenes", ["branches-met"], {}, "without a pose; mark with impossible_scenes"),
        (
            "suspension_scenes",
            [],
            {"suspension": "wishbone"},
            "'wishbone' does not exist; there are: andrews_",
        ),
        ("suspension_scenes", ["arm-highest-held"], {"near": 0.0}, "near=0.0 is not a number above 0"),
        (
            "suspension_scenes",
            ["steer"],
            {"suspension": "axle"},
            "no scene fits the mark; leave `suspension` out",
        ),
        ("impossible_scenes", ["steer"], {}, "'steer' is not a case without a pose; there are: reach-arm-"),
    ],
)
def test_a_mark_that_cannot_be_followed_is_told_in_a_line(
    name: str, of: list[str], options: dict[str, object], words: str
) -> None:
    # As pytest hands it over; the plugin need not be loaded here.
    marked = SimpleNamespace(name=name, args=of, kwargs=options)
    with pytest.raises(pytest.Collector.CollectError) as caught:
        pytest_plugin.scenes_of("test_it.py::test_one", [marked])
    said = str(caught.value)
    assert said.startswith("test_it.py::test_one: ")
    assert words in said
    assert "\n" not in said


def test_a_marked_test_without_the_argument_is_refused(tmp_path: Path) -> None:
    done = run(tmp_path, "import pytest\n@pytest.mark.suspension_scenes()\ndef test_one(): ...\n")
    said = done.stdout + done.stderr
    assert "test_one: suspension_scenes: the test takes no argument 'scene'; add it" in said
    assert done.returncode not in (0, 1, 5), said
    assert "Traceback" not in said


def test_every_hard_case_is_asked_or_cannot_be() -> None:
    asked = {case.name for case in CASES if case.answered}
    refused = {case.name for case in CASES if case.without_pose}
    assert not asked & refused
    assert {case.name for case in CASES} - asked - refused == NOT_ASKED
    # What is no scene is refused when it is read, or is tried without one.
    for case in CASES:
        assert case.content is not None or case.name in NOT_ASKED, case.name
    for subject in SUBJECTS:
        assert (f"turned-at-random{subject.suffix}" in asked) == (subject.name not in HARD)


def test_a_case_without_a_pose_is_answered_by_none_that_is_right() -> None:
    (scene,) = impossible_scenes(["start-beyond-upper-arm-locks"]).values()
    plain = given_to_solver(scene)
    answer = {"position": {"wheel_centre": np.zeros((len(plain["instants"]), 3))}}
    with pytest.raises(AssertionError, match="where there is no pose: ") as caught:
        assert_refuses(lambda _: answer, scene)
    assert f"answers {scene.title!r} at t = " in str(caught.value)
    answer["position"]["wheel_centre"] += np.nan
    assert_refuses(lambda _: answer, scene)
    with pytest.raises(AssertionError, match="has the shape"):
        assert_refuses(lambda _: {"camber": [1.0, 2.0, 3.0, 4.0]}, scene)
    with pytest.raises(AssertionError, match="it returns None; needed: a mapping"):
        assert_refuses(lambda _: None, scene)


def test_a_refusal_is_an_error_and_only_the_one_that_is_named() -> None:
    (scene,) = impossible_scenes(["start-beyond-upper-arm-locks"]).values()

    def solve(given: object) -> None:
        raise ZeroDivisionError("the arm")

    assert_refuses(solve, scene)
    with pytest.raises(ZeroDivisionError):
        assert_refuses(solve, scene, raises=ValueError)
    with pytest.raises(AssertionError, match="every instant of 'double-wishbone' has a pose"):
        assert_refuses(solve, "double-wishbone")
