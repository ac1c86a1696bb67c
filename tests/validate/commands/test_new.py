"""What `pointcoord new` writes is read as the scene that it is a copy of, wherever it stands."""

import shlex
from pathlib import Path

import pytest

from pointcoord import Scene, built_in_scenes
from validate.cli import main


def copied(scene: str, target: Path) -> tuple[Scene, Scene]:
    """A scene, and the copy that the command made of it."""
    assert main(["new", str(target), "--from", scene]) == 0
    return Scene.load(scene), Scene.load(target.with_suffix(".toml"))


def same(one: Scene, other: Scene) -> bool:
    """Whether two scenes are the same mechanism, drawn and driven alike."""
    plain = [{**s.mechanism.plain(tuple(s.inputs)), "name": ""} for s in (one, other)]
    return plain[0] == plain[1] and one.inputs == other.inputs and one.time == other.time


@pytest.mark.parametrize("scene", built_in_scenes())
def test_a_copy_of_a_built_in_scene_is_that_scene_and_says_of_which(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A name is no kind of suspension: `new five_link` alone is no five-link."""
    source, copy = copied(scene, tmp_path / "mine")
    assert same(source, copy)
    # What the scene names by its type is a file of its own now.
    assert (source.mechanism.type is not None) == (tmp_path / "mine-mechanism.toml").exists()
    assert copy.mechanism.type is None
    said = capsys.readouterr().out
    assert f"copied from {scene}" in said
    assert "--from SCENE" in said


@pytest.mark.parametrize("name", ['my "car"', "back\\1slash", "#5", "it's"])
def test_a_copy_may_have_any_name_and_the_hint_can_be_typed(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, copy = copied("five-link", tmp_path / name)
    assert same(source, copy)
    typed = capsys.readouterr().out.rpartition("try: ")[2]
    assert shlex.split(typed, comments=True) == ["pointcoord", "plan", str(tmp_path / f"{name}.toml")]
