"""The plugin's mark and fixtures, in runs of pytest of their own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pointcoord import built_in_scenes
from validate.testing.scenes import scenes_to_try

ROOT = Path(__file__).parents[3]
OURS = ("-p", "validate.pytest_plugin", "-p", "no:cacheprovider", "-p", "no:xdist", "--strict-markers")


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


def test_fixtures_hold_solve_once_and_skip_what_is_not_tested(tmp_path: Path) -> None:
    text = """
import pytest

def test_the_reference_is_proven_and_solved_once(reference):
    solution = reference("steer")
    assert solution.accuracy.proven
    assert reference("steer") is solution

@pytest.mark.suspension_scenes("steer")
def test_the_reference_agrees(scene, reference, assert_agrees):
    assert assert_agrees(reference(scene).numbers, scene, accuracy=1e-6).passed

def test_not_tested(reference, assert_agrees):
    assert_agrees(reference("steer").numbers, "steer", accuracy=1e3)

def test_wrong(reference, assert_agrees):
    turned = {n: -a for n, a in reference("steer").numbers["velocity"].items()}
    assert_agrees({"velocity": turned}, "steer", against=reference("steer"))
"""
    done = run(tmp_path, text, "-rs")
    assert "1 failed, 2 passed, 1 skipped" in done.stdout, done.stdout + done.stderr
    assert "an accuracy of 1000 mm says nothing of them" in done.stdout
    assert "disagree with reference in" in done.stdout
    assert "what would explain it: velocity: the other sign" in done.stdout


def test_every_built_in_scene_and_named_hard_case_is_one_test(tmp_path: Path) -> None:
    text = """
import pytest

@pytest.mark.suspension_scenes()
@pytest.mark.suspension_scenes("arm-highest-held", near=1e-6)
def test_one(scene):
    assert len(scene.instants)
"""
    done = run(tmp_path, text, "-v")
    assert done.returncode == 0, done.stdout + done.stderr
    tests = [line for line in done.stdout.splitlines() if "PASSED" in line]
    assert len(tests) == len(built_in_scenes()) + 1
    for name in (*built_in_scenes(), "arm-highest-held at 1e-06"):
        assert any(f"test_one[{name}]" in line for line in tests), name


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("@pytest.mark.suspension_scenes('bunce')\ndef test_one(scene): ...", ("bunce", "bounce")),
        ("@pytest.mark.suspension_scenes()\ndef test_one(): ...", ("takes no argument 'scene'; add it",)),
        ("@pytest.mark.suspension_scenes(hrad=True)\ndef test_one(scene): ...", ("hrad",)),
        (
            "@pytest.mark.suspension_scenes(suspension='wishbone')\ndef test_one(scene): ...",
            ("'wishbone'", "double_wishbone"),
        ),
        ("@pytest.mark.suspension_scenes(near=0.0)\ndef test_one(scene): ...", ("near=0.0", "above 0")),
        (
            "@pytest.mark.suspension_scenes('steer', suspension='double_wishbone')\ndef test_one(scene): ...",
            ("leave `suspension` out",),
        ),
    ],
)
def test_a_mark_that_cannot_be_followed_is_told_where_it_stands(
    tmp_path: Path, line: str, words: tuple[str, ...]
) -> None:
    done = run(tmp_path, f"import pytest\n{line}\n")
    said = done.stdout + done.stderr
    assert done.returncode not in (0, 1, 5), said
    assert [word for word in ("test_one", *words) if word not in said] == []
    assert "Traceback" not in said


def test_hard_scenes_are_many_of_every_suspension_and_nearer_where_asked_for() -> None:
    every = scenes_to_try(hard=True)
    assert set(built_in_scenes()) < set(every)
    kinds = {scene.mechanism.type for name, scene in every.items() if name not in built_in_scenes()}
    assert kinds == {scene.mechanism.type for scene in scenes_to_try().values()}
    some = [scenes_to_try(["arm-highest-held"], near=near) for near in (1e-1, 1e-9)]
    assert [list(one) for one in some] == [["arm-highest-held at 0.1"], ["arm-highest-held at 1e-09"]]
    (far,), (near,) = (one.values() for one in some)
    assert far.inputs["arm_angle"] != near.inputs["arm_angle"]
